"""Reads the tables that stages left in their result folders."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.report.record import RunTables
from core.report.tables import read_json


def load_tables(folders: Mapping[str, Path]) -> RunTables:
    """Tables of a run from the result folders of its finished tasks, by task key; missing ones stay empty."""

    def table(key: str, name: str, default: Any = ()) -> Any:
        path = folders[key] / name if key in folders else None
        return read_json(path) if path is not None and path.is_file() else default

    return RunTables(
        detections=table("annotations", "detections.json"),
        frames=table("frames", "frames.json"),
        registered=table("extend", "registered.json"),
        mapped_rows=table("timeline", "detections.json", table("map_defects", "detections.json", None)),
        timeline=table("timeline", "timeline.json"),
        defects=table("timeline", "defects.json"),
    )
