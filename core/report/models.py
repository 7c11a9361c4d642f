"""The rows of several models as one table: every detection once."""

from __future__ import annotations

from collections.abc import Sequence

from core.scene.detection import DetectionRow, Outcome

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
