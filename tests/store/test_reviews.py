"""Review records in the database: numbered without gaps, written once, and none lost when two write at a time."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from core.errors import BadInput
from core.review.record import ReviewRecord
from core.settings import make_settings
from store.account_data import AccountData
from store.db import Database
from store.events import Events, EventType
from store.housekeeping import Retention
from store.inspections import Inspections, mark_deleted
from store.models import Inspection
from store.plan import Plan
from store.records import InputFiles
from store.reviews import Author, Reviews, StaleRevision
from tests.databases import BOTH, database
from tests.store.small_plan import GRAPH

ONE = "a" * 32
ANNA = Author("anna", "key-of-anna")
TARGET = {"kind": "defect", "id": 1, "label": "dent", "centroid": [0.0, 0.0, 1.0], "sigma": 0.1}


@pytest.fixture(params=BOTH)
def db(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Database]:
    with database(request.param, tmp_path) as made:
        files = [InputFiles("video", "0" * 64, None, None)]
        Inspections(made, GRAPH).create(ONE, files, make_settings(), "")
        yield made


def record(name: str, action: str = "accept", value: Any = None, **more: Any) -> ReviewRecord:
    row = {"id": name, "revision": 9, "target": TARGET, "action": action, "value": value, "reason": None, **more}
    return ReviewRecord.parse({**row, "time": "2020-01-01T00:00:00Z", "by": "somebody else"}, "record")


def ids(db: Database) -> list[str]:
    kept = Reviews(db).since(ONE)
    assert [one.revision for one in kept] == list(range(1, len(kept) + 1))
    return [one.id for one in kept]


def test_records_are_the_authors_and_of_now(db: Database) -> None:
    reviews = Reviews(db)
    (kept,) = reviews.append(ONE, [record("a")], ANNA, seen=0)
    assert (kept.revision, kept.by, kept.origin) == (1, "anna", None)
    assert kept.time > "2026"
    assert reviews.since(ONE) == [kept]
    assert reviews.since(ONE, 1) == []
    assert (reviews.last(ONE), reviews.last("b" * 32)) == (1, 0)
    assert [one.type for one in Events(db).after("default", 0, 10)][-1] == EventType.REVIEWED


def test_a_stale_revision_is_refused_and_nothing_is_written(db: Database) -> None:
    reviews = Reviews(db)
    reviews.append(ONE, [record("a")], ANNA, seen=0)
    with pytest.raises(StaleRevision):
        reviews.append(ONE, [record("b")], ANNA, seen=0)
    with pytest.raises(StaleRevision):
        reviews.append(ONE, [record("b")], ANNA, seen=2)
    assert ids(db) == ["a"]
    assert reviews.append(ONE, [record("a")], ANNA, seen=0)[0].revision == 1, "what was sent twice is there once"
    reviews.append(ONE, [record("b")], ANNA, seen=1)
    assert ids(db) == ["a", "b"]


def test_of_many_who_write_at_a_time_nobody_loses(db: Database) -> None:
    def insist(number: int) -> None:
        reviews, seen = Reviews(db), 0
        while True:
            try:
                reviews.append(ONE, [record(f"r{number}")], ANNA, seen=seen)
            except StaleRevision:
                seen = reviews.last(ONE)
            else:
                return

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(insist, range(24)))
    assert sorted(ids(db)) == sorted(f"r{number}" for number in range(24))


def test_an_undo_names_what_it_takes_back(db: Database) -> None:
    reviews = Reviews(db)
    reviews.append(ONE, [record("a")], ANNA, seen=0)
    reviews.append(ONE, [record("b", "undo", "a")], ANNA, seen=1)
    for value in ("none", "b"):
        with pytest.raises(BadInput) as caught:
            reviews.append(ONE, [record("c", "undo", value)], ANNA, seen=2)
        assert caught.value.code == "bad_review"
    assert ids(db) == ["a", "b"]


def test_what_is_handed_over_keeps_its_origin(db: Database) -> None:
    reviews = Reviews(db)
    reviews.append(ONE, [record("a")], ANNA, seen=0)
    kept = reviews.append(ONE, [record("a"), record("x", "note", "n"), record("y", "undo", "x")], ANNA)
    assert [(one.id, one.revision) for one in kept] == [("a", 1), ("x", 2), ("y", 3)]
    assert kept[0].origin is None
    assert kept[1].origin is not None
    assert (kept[1].by, kept[1].origin.by, kept[1].origin.time) == ("anna", "somebody else", "2020-01-01T00:00:00Z")
    assert reviews.append(ONE, [record("x"), record("y", "undo", "x")], ANNA) == kept[1:]
    many = [record(f"m{number}") for number in range(700)]
    reviews.append(ONE, many, ANNA)
    assert len(reviews.append(ONE, [*many, record("last")], ANNA)) == 701
    assert len(ids(db)) == 704


def test_records_outlive_an_attempt_and_go_with_the_inspection(db: Database) -> None:
    reviews, inspections = Reviews(db), Inspections(db, GRAPH)
    reviews.append(ONE, [record("a")], ANNA, seen=0)
    inspections.reopen(ONE, [InputFiles("video", "0" * 64, None, None)], make_settings())
    assert ids(db) == ["a"]
    (told,) = AccountData(db, "default").record()["inspections"]
    assert [one["id"] for one in told["reviews"]] == ["a"]
    Plan(db, GRAPH).cancel(ONE)
    mark_deleted(db, ONE)
    Retention(db).purge(ONE)
    assert ids(db) == []
    with db.read() as session:
        assert session.get(Inspection, ONE) is not None


def test_an_accounts_records_go_with_it(db: Database) -> None:
    Reviews(db).append(ONE, [record("a")], ANNA, seen=0)
    AccountData(db, "default").delete(Plan(db, GRAPH))
    assert ids(db) == []


def test_of_an_inspection_that_is_not_there(db: Database) -> None:
    with pytest.raises(BadInput):
        Reviews(db).append("b" * 32, [record("a")], ANNA, seen=0)
