"""Rows of cases, detections, events, defects and metrics: written in the transaction that ends their task.

A result carries them as JSON lists under the table's name, made from the same files that it seals, so rows
and files cannot disagree, and a result that is used again brings its rows along.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import CursorResult, delete, insert, inspect, update
from sqlalchemy.orm import Session

from store.leasing import changed
from store.models import Base, CaseRow, DefectRow, DetectionRow, EventRow, MetricRow, TableVersion

_PER_TASK: dict[str, type[Base]] = {"cases": CaseRow, "metrics": MetricRow}
"""Tables that many tasks share: a task replaces what it wrote itself."""
_WHOLE: dict[str, type[Base]] = {"detections": DetectionRow, "events": EventRow, "defects": DefectRow}
"""Tables that one task writes whole: the last one holds."""
_TABLES = {**_PER_TASK, **_WHOLE}


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
