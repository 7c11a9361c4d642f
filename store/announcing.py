"""Which tasks workers are told of by message: in the order of turns, at most two for each task that could run besides.

So few messages wait that who comes later has a turn soon; the second is there when the task of the first ends. A
task is noted as announced before its message is sent, and until it is leased. A message that was lost shows where
a worker stays below its concurrency limit while the task waits: the task is then announced again.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, func, or_, select
from sqlalchemy.orm import Session

from core.states import Queue, TaskState
from store.db import Database
from store.models import LEASABLE, Inspection, Task, Worker
from store.monitoring import SEEN_WITHIN
from store.turns import tasks_in_turn

PER_FREE_TASK = 2
"""Messages for each task that workers could run besides those that they do: see above."""
_LOCK = 0x414E4E4F
"""PostgreSQL advisory lock: who announces counts what others have announced."""


@dataclass(frozen=True)
class Announcement:
    """Word that a task can start."""

    inspection_id: str
    key: str
    queue: Queue


@dataclass(frozen=True)
class Announcements:
    """What to tell workers, from the plans of one database."""

    db: Database

    def choose(self, overdue_s: float | None = None) -> list[Announcement]:
        """Tasks to announce now, in this order; they are noted as announced.

        Args:
            overdue_s: also those again that were announced longer ago than this, in seconds; None = only new ones.
        """
        with self.db.write() as session:
            self.db.lock(session, _LOCK)
            now = self.db.now(session)
            due = Task.announced_at.is_(None) if overdue_s is None else is_overdue(now, overdue_s)
            free, announced = _free_capacity(session, now), _count(session, ~due)
            chosen: list[Announcement] = []
            for queue in sorted(free):
                chosen += _take(session, now, queue, due, PER_FREE_TASK * free[queue] - announced[queue])
            return chosen


def is_overdue(now: datetime, seconds: float) -> ColumnElement[bool]:
    """True for a task that was not announced, or so long ago that it seems to be lost."""
    return or_(Task.announced_at.is_(None), Task.announced_at < now - timedelta(seconds=seconds))


def _take(session: Session, now: datetime, queue: Queue, due: ColumnElement[bool], room: int) -> list[Announcement]:
    if room <= 0:
        return []
    query = tasks_in_turn(~due, Task.queue == queue, due).limit(room)
    # Rows that another transaction holds are about to change: without waiting for them there is no deadlock.
    tasks = session.scalars(query.with_for_update(of=Task, skip_locked=True)).all()
    for task in tasks:
        task.announced_at = now
    return [Announcement(task.inspection_id, task.key, task.queue) for task in tasks]


def _count(session: Session, announced: ColumnElement[bool]) -> Counter[Queue]:
    """Announced tasks that can still start, by queue."""
    query = (
        select(Task.queue, func.count())
        .join(Inspection, Inspection.id == Task.inspection_id)
        .where(Task.state == TaskState.RUNNABLE, Inspection.state.in_(LEASABLE), announced)
        .group_by(Task.queue)
    )
    return Counter({queue: count for queue, count in session.execute(query)})  # noqa: C416 - rows are no plain tuples


def _free_capacity(session: Session, now: datetime) -> Counter[Queue]:
    """Tasks that workers could run besides those that they do, by the queues that they serve."""
    leased = Counter(session.scalars(select(Task.lease_owner).where(Task.state == TaskState.LEASED)))
    free: Counter[Queue] = Counter()
    for worker in session.scalars(select(Worker).where(Worker.seen_at > now - SEEN_WITHIN)):
        for queue in worker.queues:
            free[Queue(queue)] += max(0, worker.slots - leased[worker.name])
    return free
