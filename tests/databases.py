"""Databases for tests: a SQLite file, and a PostgreSQL database that is made and dropped around a test."""

from __future__ import annotations

import tempfile
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest
from sqlalchemy import URL, create_engine, make_url, text

from store.db import Database, make_engine, sqlite_url, upgrade
from tests.conftest import service_url

BOTH = [pytest.param("sqlite"), pytest.param("postgresql", marks=pytest.mark.service("postgresql"))]
"""Parameters of a fixture that runs its tests on both databases."""


@cache
def _new_tables() -> bytes:
    """An SQLite file with the newest tables and nothing else in it."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "plan.db"
        upgrade(sqlite_url(path))
        return path.read_bytes()


def put_new_tables(path: Path) -> None:
    """Write an SQLite file as the migrations make it, which takes them a tenth of a second each time."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(_new_tables())


@contextmanager
def database_url(kind: str, folder: Path) -> Iterator[URL]:
    """URL of an empty database."""
    if kind == "sqlite":
        yield sqlite_url(folder / "plan.db")
        return
    server = make_engine(service_url("postgresql")).url
    name = f"bladeatlas_test_{uuid.uuid4().hex[:12]}"
    admin = create_engine(server.set(database="postgres"), isolation_level="AUTOCOMMIT")
    with admin.connect() as connection:
        connection.execute(text(f'CREATE DATABASE "{name}"'))
    try:
        yield make_url(server).set(database=name)
    finally:
        with admin.connect() as connection:
            connection.execute(text(f'DROP DATABASE "{name}" WITH (FORCE)'))
        admin.dispose()


@contextmanager
def database(kind: str, folder: Path) -> Iterator[Database]:
    """A database with its tables."""
    with database_url(kind, folder) as url:
        upgrade(url)
        opened = Database(url)
        try:
            yield opened
        finally:
            opened.close()
