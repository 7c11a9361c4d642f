"""Monitoring: counts over everything (what waits, what runs, who works), and workers as they report themselves."""

from __future__ import annotations

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import delete, func, select

from core.states import InspectionState, TaskState
from store.db import Database, insert_into
from store.models import ACTIVE_INSPECTION, Attempt, Inspection, Task, Upload, Worker

SEEN_WITHIN = timedelta(seconds=60)
"""A worker that was not seen for longer is taken for gone."""


@dataclass(frozen=True)
class WorkerView:
    """A process that leases tasks."""

    name: str
    host: str
    queues: Sequence[str]
    started_at: datetime
    seen_at: datetime


@dataclass(frozen=True)
class Counts:
    """One look at the whole service."""

    inspections: Mapping[str, int]
    """By state; deleted ones are not counted."""
    tasks: Mapping[tuple[str, str], int]
    """Runnable and leased tasks of active inspections by (queue, state)."""
    attempts: Mapping[str, int]
    """By outcome, ever."""
    uploads: int
    """Unfinished ones."""
    oldest_queued_s: float
    """How long the longest waiting inspection has waited; 0 when none waits."""
    workers: Sequence[WorkerView]


def count_all(db: Database) -> Counts:
    """Count in one transaction."""
    with db.read() as session:
        now = db.now(session)
        by_state = select(Inspection.state, func.count()).where(Inspection.deleted_at.is_(None))
        open_tasks = (
            select(Task.queue, Task.state, func.count())
            .join(Inspection, Inspection.id == Task.inspection_id)
            .where(Inspection.state.in_(ACTIVE_INSPECTION), Task.state.in_((TaskState.RUNNABLE, TaskState.LEASED)))
            .group_by(Task.queue, Task.state)
        )
        outcomes = select(Attempt.outcome, func.count()).group_by(Attempt.outcome)
        unfinished = select(func.count()).where(Upload.removed_at.is_(None), Upload.offset < Upload.length)
        oldest = session.scalar(
            select(func.min(Inspection.created_at)).where(Inspection.state == InspectionState.QUEUED)
        )
        workers = session.scalars(select(Worker).where(Worker.seen_at > now - SEEN_WITHIN).order_by(Worker.name))
        return Counts(
            inspections={state: n for state, n in session.execute(by_state.group_by(Inspection.state))},  # noqa: C416
            tasks={(queue, state): n for queue, state, n in session.execute(open_tasks)},
            attempts={outcome: n for outcome, n in session.execute(outcomes)},  # noqa: C416 - rows are no plain tuples
            uploads=int(session.scalar(unfinished) or 0),
            oldest_queued_s=max(0.0, (now - oldest).total_seconds()) if oldest is not None else 0.0,
            workers=[WorkerView(w.name, w.host, tuple(w.queues), w.started_at, w.seen_at) for w in workers],
        )


@dataclass(frozen=True)
class WorkerRegistry:
    """The table of workers. It says how many messages are wanted; leases alone say who does what."""

    db: Database

    def seen(self, name: str, queues: Sequence[str], concurrency: int = 0) -> None:
        """A worker is alive, and takes so many tasks side by side by message."""
        with self.db.write() as session:
            now = self.db.now(session)
            known = {"queues": list(queues), "slots": concurrency, "seen_at": now}
            statement = insert_into(session, Worker).values(
                name=name, host=platform.node()[:128], started_at=now, **known
            )
            # Threads of a worker that starts report it at the same moment.
            session.execute(statement.on_conflict_do_update(index_elements=[Worker.name], set_=known))

    def alive(self, within_s: float) -> list[str]:
        """Names of this host's workers that were seen so lately."""
        with self.db.read() as session:
            since = self.db.now(session) - timedelta(seconds=within_s)
            query = select(Worker.name).where(Worker.host == platform.node()[:128], Worker.seen_at >= since)
            return list(session.scalars(query.order_by(Worker.name)))

    def gone(self, name: str) -> None:
        """A worker stops."""
        with self.db.write() as session:
            session.execute(delete(Worker).where(Worker.name == name))
