"""Turns: accounts go round, priority and age decide within one, and the queue says so; on SQLite and PostgreSQL."""

from __future__ import annotations

import hashlib
from typing import Any

from core.settings import make_settings
from core.states import InspectionState
from store.accounts import Accounts
from store.db import Database
from store.inspections import Inspections
from store.plan import Plan
from store.records import InputFiles, Lease
from store.status import Statuses
from store.turns import queued_in_turn
from tests.store.small_plan import GRAPH, result_for


def create(db: Database, name: str, owner: str, **more: Any) -> str:
    """An inspection of a video of its own, so that none takes up another's results."""
    files = InputFiles("/v.mp4", hashlib.sha256(name.encode()).hexdigest(), None, None)
    with db.write() as session:
        Inspections(db, GRAPH).create_in(session, name, [files], make_settings(), "", owner=owner, **more)
    return name


def run_all(db: Database, runners: int) -> list[str]:
    """Do all there is with so many runners that work in step; inspections in the order in which they ended."""
    plan, ended = Plan(db, GRAPH), list[str]()
    while leases := [lease for i in range(runners) if (lease := plan.lease(f"runner/{i}")) is not None]:
        for lease in leases:
            assert plan.complete(lease, result_for(lease))
            if Inspections(db, GRAPH).get(lease.inspection_id).state == InspectionState.SUCCEEDED:
                ended.append(lease.inspection_id)
    return ended


def queued(db: Database) -> list[str]:
    with db.read() as session:
        return list(queued_in_turn(session))


def take(db: Database) -> Lease:
    lease = Plan(db, GRAPH).lease("me")
    assert lease is not None
    return lease


def test_one_after_twenty_of_another_account_ends_among_the_first_three(db: Database) -> None:
    for account in ("many", "one"):
        Accounts(db).create(account)
    for number in range(20):
        create(db, f"many {number:02}", "many")
    create(db, "single", "one")
    ended = run_all(db, 2)
    assert len(ended) == 21
    assert "single" in ended[:3]
    rest = [name for name in ended if name != "single"]
    assert rest == sorted(rest), "those of one account go by age"


def test_who_comes_later_waits_for_no_more_than_what_runs(db: Database) -> None:
    for account in ("many", "one"):
        Accounts(db).create(account)
    for number in range(4):
        create(db, f"many {number}", "many")
    for _ in range(5):
        lease = take(db)
        Plan(db, GRAPH).complete(lease, result_for(lease))
    create(db, "single", "one")
    assert take(db).inspection_id == "single"
    assert take(db).inspection_id.startswith("many"), "its other tasks wait for the first, which opens them"


def test_accounts_with_as_many_running_take_turns(db: Database) -> None:
    plan = Plan(db, GRAPH)
    for account in ("a", "b", "c"):
        Accounts(db).create(account)
        for number in range(2):
            create(db, f"{account}{number}", account)
    seen = []
    for _ in range(6):
        lease = take(db)
        seen.append(lease.inspection_id[0])
        plan.complete(lease, result_for(lease))
    assert seen == ["a", "b", "c"] * 2


def test_priority_goes_before_age_within_an_account_only(db: Database) -> None:
    for account in ("a", "b"):
        Accounts(db).create(account)
    create(db, "old", "a")
    create(db, "urgent", "a", priority=9)
    create(db, "other", "b")
    assert queued(db) == ["urgent", "other", "old"]
    first = take(db)
    assert first.inspection_id == "urgent"
    assert queued(db) == ["other", "old"]
    assert take(db).inspection_id == "other", "the priority of one account pushes no other aside"
    create(db, "more urgent", "b", priority=5)
    Plan(db, GRAPH).complete(first, result_for(first))
    assert [take(db).inspection_id for _ in range(3)] == ["urgent", "more urgent", "urgent"]


def test_the_position_in_the_queue_follows_the_turns(db: Database) -> None:
    for number in range(3):
        create(db, f"many {number}", "many")
    create(db, "single", "one")
    take(db)
    statuses = Statuses(db, GRAPH)
    found = {name: statuses.read(name) for name in ("many 0", "many 1", "many 2", "single")}
    places = {name: status.queue_position for name, status in found.items() if status is not None}
    assert places == {"many 0": None, "single": 1, "many 1": 2, "many 2": 3}
    rows = [status.row for status in found.values() if status is not None]
    assert {status.row.id: status.queue_position for status in statuses.read_many(rows)} == places
