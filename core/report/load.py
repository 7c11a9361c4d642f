"""Reads the tables that stages left in their result folders, and joins those of several models."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from core.io.annotations import read_detections, read_rows
from core.io.frames import read_frames, read_registered
from core.io.timeline import read_defects, read_events
from core.report.record import RunTables
from core.scene.detection import DetectionRow, Outcome
from core.scene.frame import RunFrames
from core.task_key import key_of, stage_of, submodel_of

_RANK = {Outcome.MAPPED: 0, Outcome.APPROXIMATE: 1, Outcome.UNPLACED: 2}
"""Outcomes in the order in which a model's row counts."""


def join_detections(tables: Sequence[Sequence[DetectionRow]]) -> list[DetectionRow]:
    """One row per detection, in the order of the first table: the best placed one, of equals the first model's.

    Args:
        tables: rows by model, the first model's first; every table has a row for every detection.
    """
    if not tables:
        return []
    by_id = [{row.id: row for row in table} for table in tables]
    joined = []
    for row in tables[0]:
        rows = [rows_of[row.id] for rows_of in by_id if row.id in rows_of]
        joined.append(min(rows, key=lambda one: _RANK[one.outcome]))
    return joined


T = TypeVar("T")


def served_submodels(keys: Collection[str]) -> list[int]:
    """Numbers of the further models that came to their end, by the keys of the finished tasks."""
    if "timeline" not in keys:
        return []
    return sorted(submodel_of(key) for key in keys if stage_of(key) == "timeline" and submodel_of(key))


def load_tables(folders: Mapping[str, Path]) -> RunTables:
    """Tables of a run from the result folders of its finished tasks, by task key; missing ones stay empty."""

    def table(key: str, read: Callable[[Path], T]) -> T | None:
        """None where the task is not finished, or left no such table."""
        try:
            return read(folders[key]) if key in folders else None
        except FileNotFoundError:
            return None

    further = served_submodels(folders)
    timelines = [key_of("timeline", submodel) for submodel in (0, *further)]
    mapped = [table(key, read_rows) for key in timelines]
    rows = table("map_defects", read_rows) if mapped[0] is None else mapped[0]
    if further:
        rows = join_detections([own or [] for own in mapped])
    return RunTables(
        detections=table("annotations", read_detections) or [],
        frames=table("frames", read_frames) or RunFrames(()),
        registered=table("extend", read_registered) or [],
        registered_further={submodel: table(key_of("extend", submodel), read_registered) or [] for submodel in further},
        mapped_rows=rows,
        timeline=[event for key in timelines for event in table(key, read_events) or ()],
        defects=[record for key in timelines for record in table(key, read_defects) or ()],
    )
