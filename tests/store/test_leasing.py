"""What one lease leaves in its task and in the history of attempts, and whose leases an owner takes over."""

from __future__ import annotations

from datetime import timedelta

import pytest
from sqlalchemy import select, update

from core.errors import ResourceError
from core.settings import make_settings
from store.db import Database
from store.inspections import Inspections
from store.models import Attempt, Task
from store.plan import Plan
from store.records import Lease
from tests.store.small_plan import FILES, GRAPH, result_for

ID = "one"


@pytest.fixture
def plan(db: Database) -> Plan:
    Inspections(db, GRAPH).create(ID, FILES, make_settings(), "/out")
    return Plan(db, GRAPH)


def take(plan: Plan, owner: str = "me") -> Lease:
    lease = plan.lease(owner)
    assert lease is not None
    return lease


def task_of(plan: Plan, key: str = "split") -> Task:
    with plan.db.read() as session:
        return session.scalars(select(Task).where(Task.inspection_id == ID, Task.key == key)).one()


def last_attempt(plan: Plan) -> Attempt:
    with plan.db.read() as session:
        return session.scalars(select(Attempt).order_by(Attempt.id.desc()).limit(1)).one()


def run_out(plan: Plan) -> None:
    """Let every lease be over."""
    with plan.db.write() as session:
        past = plan.db.now(session) - timedelta(seconds=1)
        session.execute(update(Task).where(Task.state == "leased").values(lease_expires_at=past))


def test_a_message_is_as_long_as_its_column_holds(plan: Plan) -> None:
    lease = take(plan)
    assert plan.heartbeat([(lease, 0.5, "x" * 300)]) == []
    assert task_of(plan).message == "x" * 256
    assert plan.heartbeat([(lease, 0.5, "short")]) == []
    assert task_of(plan).message == "short"


def test_a_task_that_is_given_back_has_come_to_nothing(plan: Plan) -> None:
    lease = take(plan)
    plan.heartbeat([(lease, 0.75, "nearly there")])
    assert plan.release(lease) is True
    task = task_of(plan)
    assert (task.progress, task.message, task.state, task.attempt) == (0.0, "", "runnable", 0)
    assert (task.lease_owner, task.lease_expires_at) == (None, None)
    assert plan.release(lease) is False, "it is held no more"


def test_a_task_whose_files_are_gone_is_given_back_once(plan: Plan) -> None:
    lease = take(plan)
    plan.complete(lease, result_for(lease))
    part = take(plan)
    assert plan.remake(part, ["split"]) is True
    assert plan.remake(part, ["split"]) is False
    assert (task_of(plan).state, task_of(plan).attempt, task_of(plan).digest) == ("runnable", 0, None)


def test_the_history_says_who_tried_and_what_it_took(plan: Plan) -> None:
    lease = take(plan, "host/7")
    begun = last_attempt(plan)
    assert (begun.key, begun.owner, begun.outcome, begun.ended_at) == ("split", "host/7", "running", None)
    assert (begun.fingerprint, begun.task_id) == (lease.fingerprint, lease.task_id)
    error = ResourceError("no memory", code="oom").to_dict()
    assert plan.fail(lease, error, retry=True, seconds=2.5, peak_rss_bytes=7) == "retried"
    ended = last_attempt(plan)
    assert (ended.outcome, ended.seconds, ended.peak_rss_bytes, (ended.error or {})["code"]) == (
        "retried",
        2.5,
        7,
        "oom",
    )
    assert ended.ended_at is not None
    lease = take(plan)
    plan.complete(lease, result_for(lease))
    assert (last_attempt(plan).outcome, last_attempt(plan).seconds, last_attempt(plan).attempt) == ("succeeded", 1.5, 2)


def test_a_failure_that_was_not_measured_took_no_time(plan: Plan) -> None:
    assert plan.fail(take(plan), ResourceError("lost").to_dict(), retry=False) == "failed"
    assert (last_attempt(plan).seconds, last_attempt(plan).peak_rss_bytes) == (0.0, 0)
    assert (task_of(plan).seconds, task_of(plan).peak_rss_bytes) == (0.0, 0)


@pytest.mark.parametrize(("owner", "prefix", "taken"), [("a_b/1", "a_b/", 1), ("axb/1", "a_b/", 0), ("a/1", "%", 0)])
def test_an_owner_s_name_is_taken_letter_by_letter(plan: Plan, owner: str, prefix: str, taken: int) -> None:
    """``_`` and ``%`` stand for themselves, not for any text as in a pattern of the database."""
    take(plan, owner)
    assert plan.take_over(ID, owner_prefix=prefix) == taken
    if taken:
        take(plan, owner)
    assert plan.take_over_all(prefix) == taken


def test_the_sweeper_frees_what_ran_out_and_nothing_else(plan: Plan) -> None:
    split = take(plan)
    plan.complete(split, result_for(split))
    late, slow = take(plan), take(plan)
    run_out(plan)
    assert plan.heartbeat([(slow, 0.1, "")]) == []
    assert plan.expire() == 1
    assert (task_of(plan, late.key).state, task_of(plan, slow.key).state) == ("runnable", "leased")
    assert (task_of(plan, late.key).attempt, last_attempt(plan).outcome) == (1, "running")
