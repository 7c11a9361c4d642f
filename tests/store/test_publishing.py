"""Who may publish, and that what is shown changes in one step, on both databases."""

from __future__ import annotations

from datetime import timedelta

import pytest
from sqlalchemy import select, update

from core.settings import make_settings
from store.db import Database
from store.files import Stored
from store.inspections import Inspections
from store.models import Artifact, CaseRow, Inspection
from store.plan import Plan
from store.publishing import Publishing, Ticket
from tests.store.small_plan import FILES, GRAPH

ID = "one"
FILE = Stored("sparse/cameras.bin", 12, "0" * 64)
CASE = {"name": "seg", "kind": "coarse", "start": 0, "end": 1, "status": "no_model", "frames": 1, "models": 0} | {
    "registered_images": 0,
    "points3D": 0,
    "seconds": 1.0,
}


@pytest.fixture
def publishing(db: Database) -> Publishing:
    """A plan that is over: cancelled before it began."""
    Inspections(db, GRAPH).create(ID, FILES, make_settings(), "")
    assert Plan(db, GRAPH).cancel(ID) == "cancelled"
    return Publishing(db, lease_s=30.0, retention_days=7.0)


def taken(publishing: Publishing, owner: str = "me") -> Ticket:
    ticket = publishing.take(owner)
    assert ticket is not None
    return ticket


def expire(publishing: Publishing) -> None:
    with publishing.db.write() as session:
        late = publishing.db.now(session) - timedelta(seconds=1)
        session.execute(update(Inspection).values(publish_expires_at=late))


def shown(publishing: Publishing) -> tuple[int, list[str], list[str]]:
    with publishing.db.read() as session:
        row = session.get_one(Inspection, ID)
        keys = list(session.scalars(select(Artifact.key)))
        return row.published, keys, list(session.scalars(select(CaseRow.name)))


def test_one_publishes_and_everything_is_shown_at_once(publishing: Publishing) -> None:
    ticket = taken(publishing)
    assert publishing.take("another") is None
    assert shown(publishing) == (0, [], [])
    assert publishing.finish(ticket, [FILE], {"cases": [CASE]})
    assert shown(publishing) == (1, ["inspections/one/1/sparse/cameras.bin"], ["seg"])
    assert publishing.take("another") is None
    with publishing.db.read() as session:
        row = session.get_one(Inspection, ID)
        assert row.expires_at is not None
        assert timedelta(days=6) < row.expires_at - publishing.db.now(session) < timedelta(days=8)


def test_a_plan_that_goes_on_is_not_published(db: Database) -> None:
    Inspections(db, GRAPH).create(ID, FILES, make_settings(), "")
    assert Publishing(db).take("me") is None


def test_a_publisher_that_froze_past_its_lease_is_refused(publishing: Publishing) -> None:
    frozen = taken(publishing, "frozen")
    expire(publishing)
    ticket = taken(publishing, "next")
    assert not publishing.renew(frozen)
    assert not publishing.finish(frozen, [], {})
    assert publishing.renew(ticket)
    assert publishing.finish(ticket, [FILE], {})
    assert not publishing.finish(ticket, [], {})
    assert shown(publishing)[1] == ["inspections/one/1/sparse/cameras.bin"]


def test_a_restarted_publisher_takes_its_own_lease_over(publishing: Publishing) -> None:
    taken(publishing, "server")
    publishing.take_over("another")
    assert publishing.take("server") is None
    publishing.take_over("server")
    assert taken(publishing, "server").fence == 2


def test_what_belongs_to_an_earlier_attempt_or_a_deleted_inspection_is_refused(publishing: Publishing) -> None:
    ticket = taken(publishing)
    with publishing.db.write() as session:
        session.execute(update(Inspection).values(attempt=2, publish_expires_at=None))
    assert not publishing.finish(ticket, [FILE], {})
    ticket = taken(publishing)
    assert ticket.prefix == "inspections/one/2"
    with publishing.db.write() as session:
        session.execute(update(Inspection).values(deleted_at=publishing.db.now(session)))
    assert not publishing.finish(ticket, [FILE], {})
    assert shown(publishing) == (0, [], [])
    expire(publishing)
    assert publishing.take("me") is None
