"""The plan: rows that say what is to do, who does it, and what came out; it survives any crash.

Every call is one transaction. Who changes a plan holds the inspection's row first (on SQLite: the write
lock), so there is one order of locks and no deadlock. A lease carries a fence, which grows with every
lease of the task; heartbeats and results count only under the newest. Where a result has vanished, by accident
or by hand, the task that made it runs again.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, delete, select, update
from sqlalchemy.orm import Session

from core.states import AttemptOutcome, InspectionState, Queue, TaskState
from store.advance import accept, advance
from store.announcing import is_overdue
from store.db import Database
from store.events import tell_change
from store.graph import CORE_GRAPH, Graph
from store.leasing import (
    begin_attempt,
    changed,
    end_attempt,
    give_back,
    held,
    lease_of,
    lock_inspection,
    put_result,
)
from store.models import LEASABLE, Inspection, Task
from store.models import Result as ResultRow
from store.records import Lease, Result
from store.turns import begin_turn, inspections_in_turn


@dataclass(frozen=True)
class Plan:
    """Leases and results of all plans in one database."""

    db: Database
    graph: Graph = CORE_GRAPH
    lease_s: float = 30.0
    max_attempts: int = 3

    def advance(self, inspection_id: str) -> None:
        """Bring a plan up to date with the results known now; harmless at any time."""
        with self.db.write() as session:
            inspection, now = lock_inspection(session, inspection_id), self.db.now(session)
            advance(session, self.graph, inspection, now)
            tell_change(session, self.graph, inspection, now)

    def lease(
        self,
        owner: str,
        *,
        inspection_id: str | None = None,
        queues: Collection[str] = tuple(Queue),
        overdue_s: float | None = None,
    ) -> Lease | None:
        """Take the first runnable task of the inspection whose turn it is (`store.turns`); None when there is none.

        Args:
            owner: name in the lease.
            inspection_id: of this inspection only.
            queues: of these only.
            overdue_s: only what was not announced by message, or longer ago than this, in seconds.
        """
        with self.db.read() as session:
            which: list[ColumnElement[bool]] = [Task.queue.in_(queues)]
            if overdue_s is not None:
                which.append(is_overdue(self.db.now(session), overdue_s))
            query = inspections_in_turn(select(Task.id).where(*_runnable(Inspection.id), *which).exists())
            if inspection_id is not None:
                query = query.where(Inspection.id == inspection_id)
            candidates = session.scalars(query).all()
        taken = (self._lease_in(candidate, owner, *which) for candidate in candidates)
        return next((lease for lease in taken if lease is not None), None)

    def lease_named(self, owner: str, inspection_id: str, key: str) -> Lease | None:
        """Take this task; None when it cannot start, or not any more."""
        with self.db.read() as session:
            query = select(Task.id).where(*_runnable(inspection_id), Task.key == key)
            if session.scalar(query) is None:
                return None
        return self._lease_in(inspection_id, owner, Task.key == key)

    def _lease_in(self, inspection_id: str, owner: str, *which: ColumnElement[bool]) -> Lease | None:
        """Take the first runnable task of an inspection that is one of `which`."""
        with self.db.write() as session:
            inspection = lock_inspection(session, inspection_id)
            query = select(Task.id).where(*_runnable(inspection_id), *which).order_by(Task.position).limit(1)
            task_id = session.scalar(query) if inspection.state in LEASABLE else None
            if task_id is None:
                return None
            now = self.db.now(session)
            missing = vanished(session, session.get_one(Task, task_id))
            if missing:
                remake(session, inspection, missing)
                self._go_on(session, inspection, now)
                return None
            values = {
                "state": TaskState.LEASED,
                "fence": Task.fence + 1,
                "attempt": Task.attempt + 1,
                "lease_owner": owner,
                "lease_expires_at": now + timedelta(seconds=self.lease_s),
                "announced_at": None,
                "started_at": now,
            }
            if not changed(
                session, update(Task).where(Task.id == task_id, Task.state == TaskState.RUNNABLE).values(values)
            ):
                return None
            task = session.get_one(Task, task_id, populate_existing=True)
            begin_attempt(session, task, now)
            begin_turn(session, inspection.owner, now)
            inspection.state, inspection.started_at = InspectionState.RUNNING, inspection.started_at or now
            lease = lease_of(session, inspection, task)
            tell_change(session, self.graph, inspection, now)
            return lease

    def heartbeat(self, beats: Iterable[tuple[Lease, float, str]]) -> list[Lease]:
        """Renew leases with their progress; returns those that are lost, whose work must stop."""
        lost = []
        for lease, progress, message in beats:
            # One transaction each: two rows held at once could wait for a plan that waits for them.
            with self.db.write() as session:
                until = self.db.now(session) + timedelta(seconds=self.lease_s)
                values = {"lease_expires_at": until, "progress": progress, "message": message[:256]}
                if not changed(session, update(Task).where(*held(lease)).values(values)):
                    lost.append(lease)
        return lost

    def cancelling(self, inspection_ids: Collection[str]) -> set[str]:
        """Which of these inspections were asked to stop: a cheap question to ask every second."""
        with self.db.read() as session:
            stopping = Inspection.state.in_((InspectionState.CANCELLING, InspectionState.CANCELLED))
            return set(session.scalars(select(Inspection.id).where(Inspection.id.in_(inspection_ids), stopping)))

    def complete(self, lease: Lease, result: Result) -> bool:
        """Accept a result under the current fence, with its rows, and move the plan on.

        False when the lease was lost: the only trace is then the attempt marked ``refused``.
        """
        measured = {"seconds": result.seconds, "peak_rss_bytes": result.peak_rss_bytes}
        with self.db.write() as session:
            inspection, now = lock_inspection(session, lease.inspection_id), self.db.now(session)
            task = _end(session, lease, now, AttemptOutcome.SUCCEEDED, measured)
            if task is None:
                return False
            accept(session, task, put_result(session, result, now), now, reused=False)
            self._go_on(session, inspection, now)
            return True

    def fail(
        self, lease: Lease, error: Mapping[str, Any], *, retry: bool, seconds: float = 0.0, peak_rss_bytes: int = 0
    ) -> AttemptOutcome:
        """End an attempt that did not work.

        Args:
            error: `BladeAtlasError.to_dict`; a true ``stops_run`` says that an optional task must not go under quietly.
            retry: the runner's rule lets this kind of error be tried again.

        Returns:
            ``retried`` while attempts are left, ``failed``, or ``refused`` when the lease was lost.
        """
        measured = {"seconds": seconds, "peak_rss_bytes": peak_rss_bytes}
        with self.db.write() as session:
            inspection, now = lock_inspection(session, lease.inspection_id), self.db.now(session)
            again = retry and lease.attempt < self.max_attempts and inspection.state in LEASABLE
            outcome = AttemptOutcome.RETRIED if again else AttemptOutcome.FAILED
            task = _end(session, lease, now, outcome, {**measured, "error": dict(error)})
            if task is None:
                return AttemptOutcome.REFUSED
            task.lease_expires_at, task.error = None, dict(error)
            task.seconds, task.peak_rss_bytes = seconds, peak_rss_bytes
            task.state, task.ended_at = (TaskState.RUNNABLE, None) if again else (TaskState.FAILED, now)
            self._go_on(session, inspection, now)
            return outcome

    def release(self, lease: Lease) -> bool:
        """Give a task back unharmed, e.g. because the runner stops; the attempt does not count."""
        with self.db.write() as session:
            inspection, now = lock_inspection(session, lease.inspection_id), self.db.now(session)
            task = _end(session, lease, now, AttemptOutcome.RELEASED)
            if task is None:
                return False
            give_back(task, inspection, now, counts=False)
            self._go_on(session, inspection, now)
            return True

    def remake(self, lease: Lease, keys: Collection[str]) -> bool:
        """Give a task back because the files of these dependencies are gone, and have them made anew."""
        with self.db.write() as session:
            inspection, now = lock_inspection(session, lease.inspection_id), self.db.now(session)
            task = _end(session, lease, now, AttemptOutcome.RELEASED)
            if task is None:
                return False
            give_back(task, inspection, now, counts=False)
            remake(session, inspection, keys)
            self._go_on(session, inspection, now)
            return True

    def expire(self) -> int:
        """The sweeper: free every task whose lease ran out; returns how many."""
        with self.db.read() as session:
            late = Task.lease_expires_at < self.db.now(session)
            ids = session.scalars(
                select(Task.inspection_id).where(Task.state == TaskState.LEASED, late).distinct()
            ).all()
        return sum(self._free(inspection_id, None) for inspection_id in ids)

    def take_over(self, inspection_id: str, *, owner_prefix: str = "") -> int:
        """Free at once the leases of owners that are known to be gone; those attempts do not count.

        An empty prefix means all: the caller knows that nobody else works on this inspection.
        """
        return self._free(inspection_id, owner_prefix)

    def take_over_all(self, owner_prefix: str) -> int:
        """The same for every inspection: what a server does that starts again after a crash."""
        with self.db.read() as session:
            mine = Task.lease_owner.startswith(owner_prefix, autoescape=True)
            ids = session.scalars(
                select(Task.inspection_id).where(Task.state == TaskState.LEASED, mine).distinct()
            ).all()
        return sum(self._free(inspection_id, owner_prefix) for inspection_id in ids)

    def leased(self) -> set[str]:
        """Fingerprints that somebody works on now."""
        with self.db.read() as session:
            query = select(Task.fingerprint).where(Task.state == TaskState.LEASED, Task.fingerprint.is_not(None))
            return {fingerprint for fingerprint in session.scalars(query) if fingerprint}

    def _free(self, inspection_id: str, owner_prefix: str | None) -> int:
        """Free the expired leases of one inspection, or those of an owner when a prefix is given."""
        with self.db.write() as session:
            inspection, now = lock_inspection(session, inspection_id), self.db.now(session)
            leased = select(Task).where(Task.inspection_id == inspection_id, Task.state == TaskState.LEASED)
            if owner_prefix is None:
                leased = leased.where(Task.lease_expires_at < now)
            else:
                leased = leased.where(Task.lease_owner.startswith(owner_prefix, autoescape=True))
            tasks = session.scalars(leased).all()
            outcome = AttemptOutcome.EXPIRED if owner_prefix is None else AttemptOutcome.RELEASED
            for task in tasks:
                end_attempt(session, task.id, task.fence, now, outcome)
                give_back(task, inspection, now, counts=owner_prefix is None)
                if task.state == TaskState.RUNNABLE and task.attempt >= self.max_attempts:
                    _lose(task, now)
            self._go_on(session, inspection, now)
            return len(tasks)

    def cancel(self, inspection_id: str) -> InspectionState:
        """Ask to stop: nothing starts any more, running tasks are stopped by their runners. Returns the state."""
        with self.db.write() as session:
            inspection, now = lock_inspection(session, inspection_id), self.db.now(session)
            if inspection.state in LEASABLE:
                inspection.state, inspection.updated_at = InspectionState.CANCELLING, now
                waiting = (Task.inspection_id == inspection_id, Task.state.in_((TaskState.WAITING, TaskState.RUNNABLE)))
                changed(session, update(Task).where(*waiting).values(state=TaskState.CANCELLED, ended_at=now))
            self._go_on(session, inspection, now)
            return inspection.state

    def _go_on(self, session: Session, inspection: Inspection, now: datetime) -> None:
        """What follows every change: advance, or finish a cancellation once nothing runs."""
        session.flush()
        advance(session, self.graph, inspection, now)
        if inspection.state == InspectionState.CANCELLING:
            running = (
                select(Task.id).where(Task.inspection_id == inspection.id, Task.state == TaskState.LEASED).limit(1)
            )
            if session.scalar(running) is None:
                inspection.state, inspection.ended_at, inspection.updated_at = InspectionState.CANCELLED, now, now
        tell_change(session, self.graph, inspection, now)


def _runnable(inspection_id: Any) -> tuple[ColumnElement[bool], ...]:
    return (Task.inspection_id == inspection_id, Task.state == TaskState.RUNNABLE)


def _end(
    session: Session, lease: Lease, now: datetime, outcome: AttemptOutcome, values: Mapping[str, Any] | None = None
) -> Task | None:
    """Close an attempt: its task while the lease holds, None (and the attempt ``refused``) when it was lost."""
    holds = changed(session, update(Task).where(*held(lease)).values(lease_owner=None))
    end_attempt(session, lease.task_id, lease.fence, now, outcome if holds else AttemptOutcome.REFUSED, values)
    return session.get_one(Task, lease.task_id, populate_existing=True) if holds else None


def _lose(task: Task, now: datetime) -> None:
    """A task whose worker vanished as often as attempts are allowed has failed."""
    task.state, task.ended_at = TaskState.FAILED, now
    task.error = {
        "kind": "ResourceError",
        "code": "worker_lost",
        "message": f"the worker was lost {task.attempt} times while it ran {task.key}",
        "where": task.key,
        "retryable": False,
    }


def vanished(session: Session, task: Task) -> list[str]:
    """Keys of the dependencies of a task that have succeeded but whose result is unknown."""
    query = (
        select(Task.key)
        .outerjoin(ResultRow, ResultRow.fingerprint == Task.fingerprint)
        .where(Task.inspection_id == task.inspection_id, Task.key.in_(task.depends))
        .where(Task.state == TaskState.SUCCEEDED, ResultRow.fingerprint.is_(None))
    )
    return list(session.scalars(query))


def remake(session: Session, inspection: Inspection, keys: Collection[str]) -> None:
    """Set tasks back to before they ran, and what is about to build on them; `advance` then goes on from there.

    What was built on them already stays: the same input gives the same result again, under the same name.
    """
    tasks = session.scalars(select(Task).where(Task.inspection_id == inspection.id)).all()
    for task in tasks:
        if task.key in keys and task.state == TaskState.SUCCEEDED:
            session.execute(delete(ResultRow).where(ResultRow.fingerprint == task.fingerprint))
            task.state, task.reused, task.attempt = TaskState.WAITING, False, 0
            task.facts, task.digest, task.ended_at, task.progress = None, None, None, 0.0
        elif task.state == TaskState.RUNNABLE and not set(keys).isdisjoint(task.depends):
            task.state, task.announced_at = TaskState.WAITING, None
    session.flush()
