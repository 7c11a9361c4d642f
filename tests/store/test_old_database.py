"""A database of version 0.1.0 under today's migrations, up and down, on both kinds of database."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path

import pytest
from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Engine, text

from store.db import alembic_config, make_engine, sqlite_url, upgrade
from store.models import Base
from tests.databases import BOTH, database_url
from tests.old_release import REVISION, Rows, rows_of, unpack, write_rows

pytestmark = pytest.mark.slow

ACCOUNTS = "0006"
"""The revision that gave keys accounts."""


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


def with_default_account(rows: Rows) -> Rows:
    """The rows as they are once what was made without keys belongs to an account."""
    return {
        name: sorted(({**row, "owner": row["owner"] or "default"} if "owner" in row else row for row in found), key=str)
        for name, found in rows.items()
    }


def under_way(upload_id: str) -> Rows:
    """A transfer of an input by URL in the middle: the tables of version 0.1.0 know of none."""
    now = datetime(2040, 1, 1)
    times = {"lease_expires_at": now, "created_at": now, "asked_at": now}
    transfer = {"id": "t", "owner": "default", "state": "fetching", "holder": "one", "fence": 1, **times}
    file = {"number": 0, "url": "https://files.test/", "most_bytes": 1 << 40, "upload_id": upload_id, "tag": '"one"'}
    return {"transfers": [transfer], "transfer_files": [{"transfer_id": "t", **file}]}


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
        after, kept = rows_of(old), {name: rows for name, rows in with_default_account(before).items() if rows}
        assert shared(after, before) == shared(kept, before) == kept
        accounts = {row["id"]: row["name"] for row in after["accounts"]}
        assert accounts == {"default": "default", **{row["id"]: row["name"] for row in before["api_keys"]}}
        assert all(row["account_id"] == row["id"] for row in after["api_keys"]), "each old key is an account"
        assert {row["owner"] for row in after["inspections"]} <= set(accounts)
        command.downgrade(alembic_config(old.url), REVISION)
        assert rows_of(old) == before


def test_what_an_account_has_goes_back_to_one_of_its_keys(old: Engine) -> None:
    upgrade(old.url)
    rows = rows_of(old)
    (first, *_), count = rows["api_keys"], len(rows["inspections"])
    later = {**first, "revoked_at": None, "expires_at": None, "created_at": datetime(2040, 1, 1)}
    account = {**rows["accounts"][0], "id": "shop", "name": "shop"}
    news = [{**later, "id": f"{i}", "digest": f"{i}", "account_id": "shop"} for i in range(3)]
    news[0]["revoked_at"] = datetime(2041, 1, 1)
    news.append({**later, "id": "9", "digest": "9", "account_id": "default"})
    write_rows(old, {"accounts": [account], "api_keys": news})
    with old.begin() as connection:
        connection.execute(text("UPDATE inspections SET owner = 'shop' WHERE owner <> 'default'"))
    command.downgrade(alembic_config(old.url), "0005")
    after = rows_of(old)
    owners = Counter(row["owner"] for row in after["inspections"])
    assert set(owners) == {"1", "9"}, "the oldest key that is valid; keys see now what was made without any"
    assert owners.total() == count
    upgrade(old.url)
    assert {row["owner"] for row in rows_of(old)["inspections"]} == {"1", "9"}, "each of these keys is an account now"


def test_every_step_down_keeps_what_its_tables_still_hold(old: Engine) -> None:
    upgrade(old.url)
    write_rows(old, under_way(rows_of(old)["uploads"][0]["id"]))
    config = alembic_config(old.url)
    for step in ScriptDirectory.from_config(config).walk_revisions():
        before = rows_of(old)
        below = step.down_revision or "base"
        assert isinstance(below, str), "a step has one before it"
        command.downgrade(config, below)
        after = rows_of(old)
        kept = {name: rows for name, rows in before.items() if name in after}
        assert {name: len(rows) for name, rows in after.items()} == {name: len(rows) for name, rows in kept.items()}
        if step.revision == ACCOUNTS:
            kept, after = with_default_account(kept), with_default_account(after)
        assert shared(kept, after) == {name: rows for name, rows in after.items() if rows}, step.revision
        if old.dialect.name == "sqlite":
            with old.connect() as connection:
                assert connection.exec_driver_sql("PRAGMA foreign_key_check").all() == []
    assert after == {}
    upgrade(old.url)
    with old.connect() as connection:
        context = MigrationContext.configure(connection, opts={"compare_type": True})
        assert compare_metadata(context, Base.metadata) == []
