"""Rows of an inspection's tables as others read them: columns of the contract, filtered, in pieces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, select
from sqlalchemy.orm import Session

from core.mapping.rows import DETECTION_COLUMNS
from core.report.rows import CASE_COLUMNS
from store.db import Database
from store.models import Base, CaseRow, DefectRow, DetectionRow, EventRow, MetricRow

_PIECE = 500
"""Rows that are in memory at a time."""

EVENT_COLUMNS = tuple(c.name for c in EventRow.__table__.columns if c.name not in ("inspection_id", "task_key"))


@dataclass(frozen=True)
class Table:
    """One table: where its rows are, what is shown of them, in which order."""

    name: str
    model: type[Base]
    columns: tuple[str, ...]
    """As shown; those of a record's CSV for defects."""
    order: tuple[str, ...]


CASES = Table("cases", CaseRow, CASE_COLUMNS, ("kind", "name"))
DETECTIONS = Table("detections", DetectionRow, DETECTION_COLUMNS, ("id",))
TIMELINE = Table("timeline", EventRow, EVENT_COLUMNS, ("event_id",))
METRICS = Table("metrics", MetricRow, ("name", "value"), ("name",))
DEFECTS = Table("defects", DefectRow, ("record",), ("id",))
DEFECT_COLUMNS = (
    "id",
    "label",
    "model",
    "x",
    "y",
    "z",
    "extent",
    "extent_unit",
    "extent_sigma",
    "confidence",
    "persistence",
    "k",
    "n",
    "n_events",
    "n_detections",
    "blade",
)
"""Columns of a defect in CSV, where its lists are counted."""


@dataclass(frozen=True)
class RowFilter:
    """Which rows; a field that is None does not choose, and one that a table lacks chooses nothing."""

    equal: Mapping[str, Any]
    """Column and the value it must have."""
    min_confidence: float | None = None
    from_s: float | None = None
    """Rows that end at or after this time."""
    to_s: float | None = None
    """Rows that begin at or before this time."""


def read_rows(db: Database, inspection_id: str, table: Table, chosen: RowFilter) -> Iterator[dict[str, Any]]:
    """Rows as JSON values, a piece of them in memory at a time; the transaction ends with the iterator."""
    columns = table.model.__table__.columns
    query = select(*(columns[name] for name in table.columns)).where(columns["inspection_id"] == inspection_id)
    query = query.where(*_conditions(table.model, chosen)).order_by(*(columns[name] for name in table.order))
    with db.read() as session:
        yield from _pieces(session, query, table)


def _pieces(session: Session, query: Any, table: Table) -> Iterator[dict[str, Any]]:
    for row in session.execute(query, execution_options={"yield_per": _PIECE}):
        yield dict(row[0]) if table is DEFECTS else dict(zip(table.columns, row, strict=True))


def _conditions(model: type[Base], chosen: RowFilter) -> Sequence[ColumnElement[bool]]:
    columns = model.__table__.columns
    found: list[ColumnElement[bool]] = [
        columns[name] == value for name, value in chosen.equal.items() if value is not None
    ]
    if chosen.min_confidence is not None:
        found.append(columns["confidence"] >= chosen.min_confidence)
    begin, end = ("time_s", "time_s") if "time_s" in columns else ("start_s", "end_s")
    if chosen.from_s is not None:
        found.append(columns[end] >= chosen.from_s)
    if chosen.to_s is not None:
        found.append(columns[begin] <= chosen.to_s)
    return found


def flat_defect(record: Mapping[str, Any]) -> dict[str, Any]:
    """A defect as one row of CSV."""
    x, y, z = record.get("centroid") or (None, None, None)
    extent, seen = record.get("extent") or {}, record.get("persistence") or {}
    confidence = record.get("confidence")
    return {
        "id": record.get("id"),
        "label": record.get("label"),
        "model": record.get("model"),
        **{"x": x, "y": y, "z": z},
        "extent": extent.get("value"),
        "extent_unit": extent.get("unit"),
        "extent_sigma": extent.get("sigma"),
        "confidence": confidence.get("value") if isinstance(confidence, Mapping) else confidence,
        "persistence": seen.get("share"),
        "k": seen.get("k"),
        "n": seen.get("n"),
        "n_events": len(record.get("events") or ()),
        "n_detections": len(record.get("detections") or ()),
        "blade": record.get("blade"),
    }
