"""A database of version 0.1.0 under today's migrations, up and down, on both kinds of database."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Engine

from store.db import alembic_config, make_engine, sqlite_url, upgrade
from store.models import Base
from tests.databases import BOTH, database_url
from tests.old_release import REVISION, Rows, rows_of, unpack, write_rows


@pytest.fixture
def written(tmp_path: Path) -> Iterator[Engine]:
    """The database as version 0.1.0 left it."""
    engine = make_engine(sqlite_url(unpack("service", tmp_path) / "bladeatlas.db"))
    yield engine
    engine.dispose()


@pytest.fixture(params=BOTH)
def old(request: pytest.FixtureRequest, written: Engine, tmp_path: Path) -> Iterator[Engine]:
    """The same rows in tables of the same revision, on either kind of database."""
    if request.param == "sqlite":
        yield written
        return
    with database_url("postgresql", tmp_path) as url:
        command.upgrade(alembic_config(url), REVISION)
        engine = make_engine(url)
        write_rows(engine, rows_of(written))
        yield engine
        engine.dispose()


def shared(rows: Rows, like: Rows) -> Rows:
    """What of the tables and columns of `rows` is also in `like`."""
    return {
        name: sorted(({key: row[key] for key in row if key in like[name][0]} for row in found), key=str)
        for name, found in rows.items()
        if like.get(name)
    }


def test_the_data_has_what_a_deployment_has(written: Engine) -> None:
    rows = rows_of(written)
    states = sorted(row["state"] for row in rows["inspections"])
    assert states == ["cancelled", "failed", "failed", "succeeded", "succeeded", "succeeded"]
    assert sum(row["deleted_at"] is not None for row in rows["inspections"]) == 1
    assert {row["owner"] == "" for row in rows["inspections"]} == {True, False}
    assert sorted(row["revoked_at"] is None for row in rows["api_keys"]) == [False, True]
    assert {row["offset"] == row["length"] for row in rows["uploads"]} == {True, False}
    empty = {name for name, found in rows.items() if not found}
    assert empty == {"workers"}, "rows of processes that ended are taken away"


def test_an_upgrade_keeps_every_row_and_a_downgrade_brings_the_old_tables_back(old: Engine) -> None:
    before = rows_of(old)
    for _ in range(2):
        upgrade(old.url)
        assert shared(rows_of(old), before) == {name: rows for name, rows in before.items() if rows}
        command.downgrade(alembic_config(old.url), REVISION)
        assert rows_of(old) == before


def test_every_step_down_keeps_what_its_tables_still_hold(old: Engine) -> None:
    upgrade(old.url)
    config = alembic_config(old.url)
    for step in ScriptDirectory.from_config(config).walk_revisions():
        before = rows_of(old)
        below = step.down_revision or "base"
        assert isinstance(below, str), "a step has one before it"
        command.downgrade(config, below)
        after = rows_of(old)
        kept = {name: rows for name, rows in before.items() if name in after}
        assert {name: len(rows) for name, rows in after.items()} == {name: len(rows) for name, rows in kept.items()}
        assert shared(kept, after) == {name: rows for name, rows in after.items() if rows}, step.revision
        if old.dialect.name == "sqlite":
            with old.connect() as connection:
                assert connection.exec_driver_sql("PRAGMA foreign_key_check").all() == []
    assert after == {}
    upgrade(old.url)
    with old.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []
