"""Announcements: in the order of turns, two per free slot, again when nobody heard; on SQLite and PostgreSQL."""

from __future__ import annotations

import threading
from collections import Counter, deque
from datetime import timedelta

import pytest
from sqlalchemy import update
from sqlalchemy.exc import SQLAlchemyError

from core.states import Queue
from store.accounts import Accounts
from store.announcing import Announcement, Announcements
from store.db import Database
from store.models import Task, Worker
from store.monitoring import SEEN_WITHIN, WorkerRegistry
from store.plan import Plan
from store.records import Lease
from tests.store.small_plan import GRAPH, result_for
from tests.store.test_turns import create


def slots(db: Database, count: int, name: str = "worker", queues: tuple[str, ...] = ("cpu",)) -> None:
    WorkerRegistry(db).seen(name, queues, count)


def names(chosen: list[Announcement]) -> list[tuple[str, str]]:
    return [(one.inspection_id, one.key) for one in chosen]


def take(plan: Plan, inspection_id: str, key: str, owner: str = "worker") -> Lease:
    lease = plan.lease_named(owner, inspection_id, key)
    assert lease is not None
    return lease


def age(db: Database, seconds: float) -> None:
    """Let every announcement be older."""
    with db.write() as session:
        past = db.now(session) - timedelta(seconds=seconds)
        session.execute(update(Task).where(Task.announced_at.is_not(None)).values(announced_at=past))


def test_without_workers_nothing_is_announced_and_with_one_two_per_free_slot(db: Database) -> None:
    for number in range(6):
        create(db, f"job {number}", "one")
    announcements = Announcements(db)
    assert announcements.choose() == []
    slots(db, 1)
    assert announcements.choose() == [Announcement(f"job {number}", "split", Queue.CPU) for number in range(2)]
    assert announcements.choose() == []
    slots(db, 2)
    assert names(announcements.choose()) == [("job 2", "split"), ("job 3", "split")]


def test_a_slot_in_which_something_runs_wants_no_message_until_it_ends(db: Database) -> None:
    for number in range(4):
        create(db, f"job {number}", "one")
    plan, announcements = Plan(db, GRAPH), Announcements(db)
    slots(db, 1)
    assert names(announcements.choose()) == [("job 0", "split"), ("job 1", "split")]
    lease = take(plan, "job 0", "split")
    assert announcements.choose() == []
    assert plan.complete(lease, result_for(lease))
    assert names(announcements.choose()) == [("job 0", "part/0")], "the other message of the slot is still there"


def test_who_only_asks_who_is_gone_and_who_serves_another_queue_want_none(db: Database) -> None:
    create(db, "job", "one")
    slots(db, 0, "asking")
    slots(db, 1, "gpu", ("gpu",))
    slots(db, 1, "gone")
    with db.write() as session:
        session.get_one(Worker, "gone").seen_at = db.now(session) - 2 * SEEN_WITHIN
    assert Announcements(db).choose() == []
    slots(db, 1, "both", ("cpu", "gpu"))
    assert names(Announcements(db).choose()) == [("job", "split")]


def test_accounts_take_turns_and_what_runs_or_is_announced_counts_as_had(db: Database) -> None:
    for account in ("many", "few", "idle"):
        Accounts(db).create(account)
    for number in range(5):
        create(db, f"many {number}", "many")
    create(db, "few 0", "few")
    create(db, "few urgent", "few", priority=9)
    slots(db, 2)
    found = names(Announcements(db).choose())
    assert found == [(name, "split") for name in ("few urgent", "many 0", "many 1", "few 0")]
    create(db, "idle 0", "idle")
    slots(db, 3)
    assert names(Announcements(db).choose()) == [("idle 0", "split"), ("many 2", "split")]


def test_one_after_eight_of_another_account_ends_among_the_first_three(db: Database) -> None:
    for account in ("many", "one"):
        Accounts(db).create(account)
    for number in range(8):
        create(db, f"many {number}", "many")
    create(db, "single", "one")
    plan, announcements, messages = Plan(db, GRAPH), Announcements(db), deque[tuple[str, str]]()
    slots(db, 2)
    ended = list[str]()
    while len(ended) < 9:
        messages.extend(names(announcements.choose()))
        assert messages, "something can start, and no message says so"
        leases = [take(plan, *messages.popleft()) for _ in range(min(2, len(messages)))]
        for lease in leases:
            # Facts of its own, so that no inspection takes up another's results.
            assert plan.complete(lease, result_for(lease, {"n": 2, "of": lease.inspection_id}))
            ended += [lease.inspection_id] if lease.key == "last" else []
    assert "single" in ended[:3]
    assert not messages


def test_only_what_was_announced_long_ago_is_announced_again(db: Database) -> None:
    create(db, "one", "a")
    create(db, "two", "a")
    announcements = Announcements(db)
    slots(db, 1)
    assert len(announcements.choose()) == 2
    assert announcements.choose(overdue_s=60) == []
    age(db, 61)
    assert announcements.choose() == [], "the usual look leaves the room to messages that may still wait"
    assert names(announcements.choose(overdue_s=60)) == [("one", "split"), ("two", "split")]
    assert announcements.choose(overdue_s=60) == []
    take(Plan(db, GRAPH), "one", "split")
    age(db, 61)
    assert announcements.choose(overdue_s=60) == [], "no slot is free: the message may wait for it"


def test_a_message_starts_its_own_task_once(db: Database) -> None:
    create(db, "one", "a")
    create(db, "two", "a")
    plan = Plan(db, GRAPH)
    assert plan.lease_named("worker", "two", "join") is None
    assert plan.lease_named("worker", "three", "split") is None
    lease = take(plan, "two", "split")
    assert (lease.inspection_id, lease.key) == ("two", "split")
    assert plan.lease_named("other", "two", "split") is None
    assert plan.complete(lease, result_for(lease))
    assert plan.lease_named("other", "two", "split") is None
    plan.cancel("one")
    assert plan.lease_named("worker", "one", "split") is None


def test_what_was_given_back_or_is_to_be_tried_again_is_new(db: Database) -> None:
    create(db, "one", "a")
    plan, announcements = Plan(db, GRAPH), Announcements(db)
    slots(db, 1)
    for end in (plan.release, lambda lease: plan.fail(lease, {"code": "worker_lost"}, retry=True)):
        assert names(announcements.choose()) == [("one", "split")]
        assert end(take(plan, "one", "split"))


def test_whoever_asks_by_itself_first_leaves_alone_what_was_just_announced(db: Database) -> None:
    create(db, "one", "a")
    plan = Plan(db, GRAPH)
    slots(db, 1)
    assert len(Announcements(db).choose()) == 1
    assert plan.lease("worker", overdue_s=60) is None
    age(db, 61)
    lease = plan.lease("worker", overdue_s=60)
    assert lease is not None
    assert plan.release(lease)
    assert plan.lease("worker", overdue_s=60) is not None, "it was not announced since"


def test_a_worker_may_report_itself_from_several_threads_at_once(db: Database) -> None:
    start, failures = threading.Barrier(4), list[Exception]()

    def report() -> None:
        start.wait(10)
        try:
            for _ in range(3):
                slots(db, 2)
        except SQLAlchemyError as error:
            failures.append(error)

    threads = [threading.Thread(target=report) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert failures == []
    with db.read() as session:
        assert [(row.name, row.slots) for row in session.query(Worker)] == [("worker", 2)]


@pytest.mark.parametrize("announcers", [4])
def test_several_who_announce_at_once_tell_of_each_task_once(db: Database, announcers: int) -> None:
    for number in range(12):
        create(db, f"job {number}", "one")
    slots(db, 4)
    chosen, start = list[tuple[str, str]](), threading.Barrier(announcers)

    def announce() -> None:
        start.wait(10)
        chosen.extend(names(Announcements(db).choose()))

    threads = [threading.Thread(target=announce) for _ in range(announcers)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(30)
    assert Counter(chosen) == Counter((f"job {number}", "split") for number in range(8))
