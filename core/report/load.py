"""Reads the tables that stages left in their result folders."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from core.json_files import read_json
from core.report.models import join_detections, join_lists
from core.report.record import RunTables
from core.task_key import key_of, piece_of, stage_of


def served_pieces(keys: Collection[str]) -> list[int]:
    """Numbers of the further models that came to their end, by the keys of the finished tasks."""
    if "timeline" not in keys:
        return []
    return sorted(piece_of(key) for key in keys if stage_of(key) == "timeline" and piece_of(key))


def load_tables(folders: Mapping[str, Path]) -> RunTables:
    """Tables of a run from the result folders of its finished tasks, by task key; missing ones stay empty."""

    def table(key: str, name: str, default: object = ()) -> Any:  # see `core.json_files.read_json`
        path = folders[key] / name if key in folders else None
        return read_json(path) if path is not None and path.is_file() else default

    further = served_pieces(folders)
    timelines = [key_of("timeline", piece) for piece in (0, *further)]
    mapped = table("timeline", "detections.json", table("map_defects", "detections.json", None))
    return RunTables(
        detections=table("annotations", "detections.json"),
        frames=table("frames", "frames.json"),
        registered=table("extend", "registered.json"),
        registered_further={piece: table(key_of("extend", piece), "registered.json") for piece in further},
        mapped_rows=mapped if not further else join_detections([table(key, "detections.json") for key in timelines]),
        timeline=join_lists([table(key, "timeline.json") for key in timelines]),
        defects=join_lists([table(key, "defects.json") for key in timelines]),
    )
