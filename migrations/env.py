"""Alembic's entry: runs migrations on the URL that `store.db` hands over, or on `-x url=...`."""

from __future__ import annotations

from typing import Any

from alembic import context
from sqlalchemy import URL, Connection, event, make_url, text

from store.db import make_engine
from store.models import Base

_LOCK = 0x0B1ADE
"""PostgreSQL advisory lock: two servers that start together migrate one after the other."""


def _url() -> str | URL:
    given = context.config.attributes.get("url") or context.get_x_argument(as_dictionary=True).get("url")
    if not given:
        raise SystemExit("give the database with: alembic -x url=... <command>")
    return make_url(given)


def _migrate(connection: Connection) -> None:
    context.configure(
        connection=connection,
        target_metadata=Base.metadata,
        render_as_batch=connection.dialect.name == "sqlite",
        compare_type=True,
    )
    with context.begin_transaction():
        if connection.dialect.name == "postgresql":
            connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _LOCK})
        context.run_migrations()


def _without_foreign_keys(connection: Any, _record: object) -> None:
    """SQLite changes a table by making it anew, and dropping the old one would delete the rows that refer to it."""
    connection.execute("PRAGMA foreign_keys=OFF").close()


def _run() -> None:
    engine = make_engine(_url()).execution_options(bladeatlas_write=True)
    if engine.dialect.name == "sqlite":
        # When a connection is made, because inside a transaction the pragma does nothing.
        event.listen(engine, "connect", _without_foreign_keys)
    try:
        with engine.connect() as connection:
            _migrate(connection)
    finally:
        engine.dispose()


_run()
