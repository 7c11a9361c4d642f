"""Rows of cases, detections, events, defects and metrics: written in the transaction that ends their task.

A result carries them as JSON lists under the table's name, made from the same files that it seals, so rows
and files cannot disagree, and a result that is used again brings its rows along.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sqlalchemy import delete, insert, inspect
from sqlalchemy.orm import Session

from store.models import Base, CaseRow, DefectRow, DetectionRow, EventRow, MetricRow

_PER_TASK: dict[str, type[Base]] = {"cases": CaseRow, "metrics": MetricRow}
"""Tables that many tasks share: a task replaces what it wrote itself."""
_WHOLE: dict[str, type[Base]] = {"detections": DetectionRow, "events": EventRow, "defects": DefectRow}
"""Tables that one task writes whole: the last one holds."""
_TABLES = {**_PER_TASK, **_WHOLE}


def write_rows(session: Session, inspection_id: str, task_key: str, rows: Mapping[str, Any]) -> None:
    """Replace the rows of one task; keys that a table does not know are left to the files."""
    for name, table in _PER_TASK.items():
        _clear(session, table, inspection_id, task_key)
        _insert(session, table, inspection_id, task_key, rows.get(name, ()))
    for name, table in _WHOLE.items():
        if name in rows:
            _clear(session, table, inspection_id, None)
            _insert(session, table, inspection_id, task_key, rows[name])


def replace_rows(session: Session, inspection_id: str, rows: Mapping[str, Any]) -> None:
    """Replace whole tables of an inspection: those that `rows` names."""
    for name, values in rows.items():
        _clear(session, _TABLES[name], inspection_id, None)
        _insert(session, _TABLES[name], inspection_id, "", values)


def clear_rows(session: Session, inspection_id: str) -> None:
    """Remove every row of an inspection."""
    for table in _TABLES.values():
        _clear(session, table, inspection_id, None)


def _clear(session: Session, table: type[Base], inspection_id: str, task_key: str | None) -> None:
    columns = table.__table__.columns
    statement = delete(table).where(columns["inspection_id"] == inspection_id)
    if task_key is not None:
        statement = statement.where(columns["task_key"] == task_key)
    session.execute(statement)


def _insert(session: Session, table: type[Base], inspection_id: str, task_key: str, rows: Any) -> None:
    names = {column.key for column in inspect(table).column_attrs}
    owner = {"inspection_id": inspection_id, "task_key": task_key}
    values = [{**{key: value for key, value in row.items() if key in names}, **owner} for row in rows]
    if values:
        session.execute(insert(table), values)
