"""Data that version 0.1.0 wrote, unpacked for a test; how it was made is told in tests/data/v0.1.0/README.md."""

from __future__ import annotations

import json
import tarfile
from pathlib import Path
from typing import Any

from sqlalchemy import Engine, MetaData, insert, select

DATA = Path(__file__).parent / "data" / "v0.1.0"
REVISION = "0003"
"""Of the tables of that version."""
Rows = dict[str, list[dict[str, Any]]]
"""Rows by table, in a fixed order."""


def unpack(name: str, folder: Path) -> Path:
    """A copy of ``service`` or ``result`` below `folder`."""
    with tarfile.open(DATA / f"{name}.tar.xz") as archive:
        archive.extractall(folder, filter="data")
    return folder / name


def answers(name: str) -> dict[str, Any]:
    """What that version answered about it."""
    found: dict[str, Any] = json.loads((DATA / f"{name}.json").read_text(encoding="utf-8"))
    return found


def rows_of(engine: Engine) -> Rows:
    """Everything that a database holds, Alembic's own table aside."""
    tables = MetaData()
    tables.reflect(engine)
    with engine.connect() as connection:
        found = {
            table.name: [dict(row._mapping) for row in connection.execute(select(table))]
            for table in tables.sorted_tables
            if table.name != "alembic_version"
        }
    return {name: sorted(rows, key=str) for name, rows in found.items()}


def write_rows(engine: Engine, rows: Rows) -> None:
    """Put rows into the empty tables of a database, parents first."""
    tables = MetaData()
    tables.reflect(engine)
    with engine.begin() as connection:
        for table in tables.sorted_tables:
            if rows.get(table.name):
                connection.execute(insert(table), rows[table.name])


def missing(old: Any, new: Any, where: str = "") -> list[str]:
    """Where a new answer lacks what the old one said; names that came since are no difference."""
    if isinstance(old, dict) and isinstance(new, dict):
        return [
            found
            for name, value in old.items()
            for found in (missing(value, new[name], f"{where}.{name}") if name in new else [f"{where}.{name} is gone"])
        ]
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        return [found for i, pair in enumerate(zip(old, new, strict=True)) for found in missing(*pair, f"{where}[{i}]")]
    if isinstance(old, float) and isinstance(new, float) and abs(old - new) <= 1e-6 * max(1.0, abs(old)):
        return []
    return [] if old == new else [f"{where}: {old!r} is now {new!r}"]
