"""Tables of an inspection: made from the files of a result, written with the end of its task, read in pages.

A result carries its rows as JSON lists under the table's name, made from the very files that it seals, so rows
and files cannot disagree, and a result that is used again brings its rows along.

Every page is read in a short transaction of its own. Tables count their changes (`TableVersion`), and a page that
follows another is read only while the count is the same: what a reader puts together was there at one moment.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import ColumnElement, CursorResult, Select, delete, insert, inspect, literal, select, tuple_, update
from sqlalchemy.orm import Session

from core.errors import BadInput
from core.products.contract import Facts
from core.scene.case import CASE_COLUMNS, CaseKind
from core.scene.defect import TIMELINE_COLUMNS
from core.scene.detection import DETECTION_COLUMNS
from core.scene.on_row import ROW_COLUMNS
from core.scene.size import SIZE_COLUMNS
from core.task_key import stage_of, submodel_of
from store.cursors import CursorValue, decode_cursor, encode_cursor
from store.db import Database
from store.leasing import changed
from store.models import Base, CaseRow, DefectRow, DetectionRow, EventRow, MetricRow, TableVersion

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
    *SIZE_COLUMNS,
    *ROW_COLUMNS,
)
"""Columns of a defect in CSV, where its lists are counted."""
_PER_TASK: dict[str, type[Base]] = {"cases": CaseRow, "metrics": MetricRow}
"""Tables that many tasks share: a task replaces what it wrote itself."""
_WHOLE: dict[str, type[Base]] = {"detections": DetectionRow, "events": EventRow, "defects": DefectRow}
"""Tables that one task writes whole: the last one holds."""
_TABLES = {**_PER_TASK, **_WHOLE}
_CASE_STAGES = tuple(CaseKind)
_TABLE_FILES: dict[str, dict[str, str]] = {
    "map_defects": {"detections": "detections.json"},
    "timeline": {"detections": "detections.json", "events": "timeline.json", "defects": "defects.json"},
}


@dataclass(frozen=True)
class Table:
    """One table: where its rows are, what is shown of them, in which order."""

    name: str
    """Key of its rows in a result."""
    model: type[Base]
    columns: tuple[str, ...]
    """As shown; the record alone for defects."""
    order: tuple[str, ...]
    """Columns that order the rows and tell each from the others."""

    @property
    def kinds(self) -> tuple[type, ...]:
        """Types of the columns of `order`."""
        return tuple(self.model.__table__.columns[name].type.python_type for name in self.order)


CASES = Table("cases", CaseRow, CASE_COLUMNS, ("kind", "name"))
DETECTIONS = Table("detections", DetectionRow, DETECTION_COLUMNS, ("id",))
TIMELINE = Table("events", EventRow, TIMELINE_COLUMNS, ("event_id",))
METRICS = Table("metrics", MetricRow, ("name", "value"), ("name",))
DEFECTS = Table("defects", DefectRow, ("record",), ("id",))


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


@dataclass(frozen=True)
class Position:
    """Behind which row of which version of a table a page begins."""

    version: int
    key: tuple[CursorValue, ...]
    """Of the row: its values in the columns of `Table.order`."""

    def to_cursor(self, table: Table) -> str:
        """As it is given to clients."""
        return encode_cursor(table.name, (self.version, *self.key))

    @staticmethod
    def from_cursor(table: Table, cursor: str) -> Position:
        """What a client gives back; `BadInput` for a cursor that is not of this table."""
        version, *key = decode_cursor(table.name, (int, *table.kinds), cursor)
        return Position(int(version), tuple(key))


@dataclass(frozen=True)
class Page:
    """Rows that follow each other, as JSON values."""

    version: int
    """Of the table."""
    rows: Sequence[dict[str, Any]]
    next: Position | None
    """Where the next page begins; None on the last."""


class TableChanged(BadInput):
    """The rows were replaced since the page before was read, so the next page would not belong to it."""

    code = "table_changed"


def read_page(
    db: Database, inspection_id: str, table: Table, chosen: RowFilter, limit: int, after: Position | None = None
) -> Page:
    """Up to `limit` rows behind a position; no transaction is open when they are returned.

    Raises:
        TableChanged: the table is not of the version that `after` names any more.
    """
    columns = table.model.__table__.columns
    keys = [columns[name] for name in table.order]
    query = _rows(inspection_id, table, chosen, keys).limit(limit + 1)
    if after is not None:
        query = query.where(tuple_(*keys) > tuple_(*(literal(value) for value in after.key)))
    with db.snapshot() as session:
        version = _version(session, inspection_id, table)
        if after is not None and after.version != version:
            raise TableChanged(
                "the rows were replaced while they were read; begin again without a cursor", where="cursor"
            )
        found = session.execute(query).all()
    rows = [_shown(row, table) for row in found[:limit]]
    last = tuple(found[limit - 1][-len(keys) :]) if len(found) > limit else None
    return Page(version, rows, None if last is None else Position(version, last))


def read_rows(db: Database, inspection_id: str, table: Table, chosen: RowFilter) -> list[dict[str, Any]]:
    """All chosen rows at once: for filters that leave a few."""
    with db.read() as session:
        return [_shown(row, table) for row in session.execute(_rows(inspection_id, table, chosen, []))]


def table_version(db: Database, inspection_id: str, table: Table) -> int:
    """How often the table has changed."""
    with db.read() as session:
        return _version(session, inspection_id, table)


def labels(db: Database, inspection_id: str) -> list[str]:
    """Every label of the detections, once."""
    query = select(DetectionRow.label).where(DetectionRow.inspection_id == inspection_id).distinct()
    with db.read() as session:
        return list(session.scalars(query.order_by(DetectionRow.label)))


def _version(session: Session, inspection_id: str, table: Table) -> int:
    where = (TableVersion.inspection_id == inspection_id, TableVersion.name == table.name)
    return session.scalar(select(TableVersion.version).where(*where)) or 0


def _rows(inspection_id: str, table: Table, chosen: RowFilter, keys: Sequence[ColumnElement[Any]]) -> Select[Any]:
    """The chosen rows in their order: what is shown of them, then the columns `keys`."""
    columns = table.model.__table__.columns
    query = select(*(columns[name].label(f"shown_{name}") for name in table.columns), *keys)
    query = query.where(columns["inspection_id"] == inspection_id, *_conditions(table.model, chosen))
    return query.order_by(*(columns[name] for name in table.order))


def _shown(row: Sequence[Any], table: Table) -> dict[str, Any]:
    return dict(row[0]) if table is DEFECTS else dict(zip(table.columns, row, strict=False))


def _conditions(model: type[Base], chosen: RowFilter) -> Sequence[ColumnElement[bool]]:
    columns = model.__table__.columns
    found: list[ColumnElement[bool]] = [
        _column(model, name) == value for name, value in chosen.equal.items() if value is not None
    ]
    if chosen.min_confidence is not None:
        found.append(_column(model, "confidence") >= chosen.min_confidence)
    begin, end = ("time_s", "time_s") if "time_s" in columns else ("start_s", "end_s")
    if chosen.from_s is not None:
        found.append(columns[end] >= chosen.from_s)
    if chosen.to_s is not None:
        found.append(columns[begin] <= chosen.to_s)
    return found


def _column(model: type[Base], name: str) -> ColumnElement[Any]:
    """A column to choose by; of a defect what no column says is looked for in its record."""
    columns = model.__table__.columns
    if model is not DefectRow or name in columns:
        return columns[name]
    record: Any = columns["record"]
    found: ColumnElement[Any] = (
        record[("confidence", "value")].as_float() if name == "confidence" else record[name].as_string()
    )
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
        **{name: record.get(name) for name in (*SIZE_COLUMNS, *ROW_COLUMNS)},
    }


def write_rows(session: Session, inspection_id: str, task_key: str, rows: Mapping[str, Any]) -> None:
    """Replace the rows of one task; keys that a table does not know are left to the files."""
    for name in _PER_TASK:
        _replace(session, name, inspection_id, task_key, rows.get(name, ()), only_of_task=True)
    for name in _WHOLE:
        if name in rows:
            _replace(session, name, inspection_id, task_key, rows[name])


def replace_rows(session: Session, inspection_id: str, rows: Mapping[str, Any]) -> None:
    """Replace whole tables of an inspection: those that `rows` names."""
    for name, values in rows.items():
        _replace(session, name, inspection_id, "", values)


def clear_rows(session: Session, inspection_id: str) -> None:
    """Remove every row of an inspection."""
    for name in _TABLES:
        _replace(session, name, inspection_id, "", ())


def _replace(
    session: Session, name: str, inspection_id: str, task_key: str, rows: Any, *, only_of_task: bool = False
) -> None:
    """Replace rows of one table; the caller has locked the inspection, so versions are counted one by one."""
    table = _TABLES[name]
    columns = table.__table__.columns
    statement = delete(table).where(columns["inspection_id"] == inspection_id)
    if only_of_task:
        statement = statement.where(columns["task_key"] == task_key)
    removed = session.execute(statement)
    assert isinstance(removed, CursorResult)  # what every DELETE gives
    values = _values(table, inspection_id, task_key, rows)
    if values:
        session.execute(insert(table), values)
    if values or removed.rowcount:
        _count_change(session, name, inspection_id)


def _values(table: type[Base], inspection_id: str, task_key: str, rows: Any) -> list[dict[str, Any]]:
    names = {column.key for column in inspect(table).column_attrs}
    owner = {"inspection_id": inspection_id, "task_key": task_key}
    return [{**{key: value for key, value in row.items() if key in names}, **owner} for row in rows]


def _count_change(session: Session, name: str, inspection_id: str) -> None:
    where = (TableVersion.inspection_id == inspection_id, TableVersion.name == name)
    if not changed(session, update(TableVersion).where(*where).values(version=TableVersion.version + 1)):
        session.execute(insert(TableVersion).values(inspection_id=inspection_id, name=name, version=1))


def rows_of(key: str, facts: Facts, folder: Path) -> dict[str, Any]:
    """Rows by table: metrics of every task, cases of the search, tables of the mapping stages.

    Tables of further models are joined with the first one's when the run is published.
    """
    stage = stage_of(key)
    rows: dict[str, Any] = {"metrics": _metrics(facts)}
    if stage in _CASE_STAGES and "name" in facts:
        rows["cases"] = [facts]
    files = {} if submodel_of(key) else _TABLE_FILES.get(stage, {})
    for table, name in files.items():
        path = folder / name
        if path.is_file():
            rows[table] = json.loads(path.read_text(encoding="utf-8"))
    if "defects" in rows:
        rows["defects"] = defect_rows(rows["defects"])
    return rows


def defect_rows(records: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Rows of the table of defects: the whole record, and what is asked for most as columns."""
    rows = []
    for record in records:
        x, y, z = record.get("centroid") or (None, None, None)
        rows.append({"id": record["id"], "label": record["label"], "x": x, "y": y, "z": z, "record": record})
    return rows


def _metrics(facts: Facts) -> list[dict[str, Any]]:
    numbers = {
        name: value for name, value in facts.items() if isinstance(value, int | float) and not isinstance(value, bool)
    }
    return [{"name": name, "value": float(value)} for name, value in numbers.items() if math.isfinite(value)]
