"""Every test of a plan runs on both databases."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from sqlalchemy import ColumnElement, Table

from store.account_models import DEFAULT_ACCOUNT, Account
from store.db import Database
from store.models import Base
from tests.databases import BOTH, database


@pytest.fixture(scope="session", params=BOTH)
def migrated(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    with database(request.param, tmp_path_factory.mktemp("database")) as opened:
        yield opened


def _but_default(table: Table) -> tuple[ColumnElement[bool], ...]:
    """The account that migrations make always exists."""
    return (table.columns["id"] != DEFAULT_ACCOUNT,) if table.name == Account.__tablename__ else ()


@pytest.fixture
def db(migrated: Database) -> Database:
    """An empty database with its tables."""
    with migrated.write() as session:
        for table in reversed(Base.metadata.sorted_tables):
            session.execute(table.delete().where(*_but_default(table)))
    return migrated
