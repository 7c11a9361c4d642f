"""The tables of several models as one: every detection once, defects and events of all."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar

from core.mapping.rows import Outcome
from core.report.record import Item

One = TypeVar("One")


_RANK: dict[str, int] = {Outcome.MAPPED: 0, Outcome.APPROXIMATE: 1}
"""Outcomes in the order in which a model's row counts; all others are behind."""


def join_detections(tables: Sequence[Sequence[Item]]) -> list[Item]:
    """One row per detection, in the order of the first table: the best placed one, of equals the first model's.

    Args:
        tables: rows by model, the first model's first; every table has a row for every detection.
    """
    if not tables:
        return []
    by_id = [{row["id"]: row for row in table} for table in tables]
    joined = []
    for row in tables[0]:
        rows = [rows_of[row["id"]] for rows_of in by_id if row["id"] in rows_of]
        joined.append(min(rows, key=lambda one: _RANK.get(str(one["outcome"]), len(_RANK))))
    return joined


def join_lists(tables: Sequence[Sequence[One]]) -> list[One]:
    """Rows of all models; their ids are told apart where they are made."""
    return [row for table in tables for row in table]
