"""Every test of a plan runs on both databases."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from store.db import Database
from store.models import Base
from tests.databases import BOTH, database


@pytest.fixture(scope="session", params=BOTH)
def migrated(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Database]:
    with database(request.param, tmp_path_factory.mktemp("database")) as opened:
        yield opened


@pytest.fixture
def db(migrated: Database) -> Database:
    """An empty database with its tables."""
    with migrated.write() as session:
        for table in reversed(Base.metadata.sorted_tables):
            session.execute(table.delete())
    return migrated
