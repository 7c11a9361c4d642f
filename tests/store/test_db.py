"""Engines and migrations: the models and what Alembic makes are the same, up and down."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from sqlalchemy import URL, event, inspect, text

from core.errors import BadInput, DiskFull
from store.db import Database, alembic_config, make_engine, open_sqlite, sqlite_url, upgrade
from store.models import Base
from tests.databases import BOTH, database_url


@pytest.fixture(params=BOTH)
def url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[URL]:
    with database_url(request.param, tmp_path) as made:
        yield made


def test_migrations_make_what_the_models_say_up_and_down(url: URL) -> None:
    engine = make_engine(url)
    for _ in range(2):
        upgrade(url)
        upgrade(url)
        with engine.connect() as connection:
            context = MigrationContext.configure(connection, opts={"compare_type": True})
            assert compare_metadata(context, Base.metadata) == []
        command.downgrade(alembic_config(url), "base")
        assert set(inspect(engine).get_table_names()) <= {"alembic_version"}
    engine.dispose()


def test_a_database_of_a_newer_version_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "plan.db"
    database = open_sqlite(path)
    with database.write() as session:
        session.execute(text("UPDATE alembic_version SET version_num = '9999'"))
    database.close()
    with pytest.raises(BadInput) as caught:
        open_sqlite(path)
    assert caught.value.code == "newer_database"


def test_a_damaged_file_is_said(tmp_path: Path) -> None:
    path = tmp_path / "plan.db"
    path.write_bytes(b"this is no database" * 500)
    with pytest.raises(BadInput) as caught:
        open_sqlite(path)
    assert caught.value.code == "damaged_plan"


def test_a_sqlite_connection_is_safe_to_crash(tmp_path: Path) -> None:
    database = open_sqlite(tmp_path / "plan.db")
    with database.read() as session:
        asked = ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
        values = [session.execute(text(f"PRAGMA {name}")).scalar_one() for name in asked]
    database.close()
    assert values == ["wal", 2, 1, 30000]


def test_writers_of_one_file_wait_for_each_other(tmp_path: Path) -> None:
    database = open_sqlite(tmp_path / "plan.db")
    with database.write() as session:
        session.execute(text("CREATE TABLE counter (n INTEGER)"))
        session.execute(text("INSERT INTO counter VALUES (0)"))

    def count(own: Database) -> None:
        for _ in range(20):
            with own.write() as session:
                seen = session.execute(text("SELECT n FROM counter")).scalar_one()
                session.execute(text("UPDATE counter SET n = :n"), {"n": seen + 1})

    others = [Database(sqlite_url(tmp_path / "plan.db")) for _ in range(3)]
    threads = [threading.Thread(target=count, args=(own,)) for own in others]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    with database.read() as session:
        assert session.execute(text("SELECT n FROM counter")).scalar_one() == 60
    for own in (*others, database):
        own.close()


def test_writers_of_one_process_do_not_ask_sqlite_in_vain(tmp_path: Path) -> None:
    db, begun = open_sqlite(tmp_path / "plan.db"), threading.Event()

    def second() -> None:
        with db.write() as session:
            session.execute(text("SELECT 1"))

    other = threading.Thread(target=second)
    with db.write() as session:
        session.execute(text("SELECT 1"))
        event.listen(db.engine, "begin", lambda _connection: begun.set())
        other.start()
        assert not begun.wait(0.2), "it would sleep there between its tries, and come late again and again"
    other.join(5)
    assert begun.is_set()
    db.close()


def test_a_database_that_takes_no_more_is_a_full_disk(tmp_path: Path) -> None:
    database = open_sqlite(tmp_path / "plan.db")
    with pytest.raises(DiskFull):
        _overfill(database)
    database.close()


def _overfill(database: Database) -> None:
    with database.write() as session:
        pages = session.execute(text("PRAGMA page_count")).scalar_one()
        session.execute(text(f"PRAGMA max_page_count={pages}"))
        session.execute(text("CREATE TABLE filler AS SELECT randomblob(100000) AS data"))
