"""Results that have vanished, by accident or by hand: the tasks that made them run again, and the plan goes on."""

from __future__ import annotations

from collections.abc import Collection

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from core.states import TaskState
from store.models import Inspection, Result, Task


def vanished(session: Session, task: Task) -> list[str]:
    """Keys of the dependencies of a task that have succeeded but whose result is unknown."""
    query = (
        select(Task.key)
        .outerjoin(Result, Result.fingerprint == Task.fingerprint)
        .where(Task.inspection_id == task.inspection_id, Task.key.in_(task.depends))
        .where(Task.state == TaskState.SUCCEEDED, Result.fingerprint.is_(None))
    )
    return list(session.scalars(query))


def remake(session: Session, inspection: Inspection, keys: Collection[str]) -> None:
    """Set tasks back to before they ran, and what is about to build on them; `advance` then goes on from there.

    What was built on them already stays: the same input gives the same result again, under the same name.
    """
    tasks = session.scalars(select(Task).where(Task.inspection_id == inspection.id)).all()
    for task in tasks:
        if task.key in keys and task.state == TaskState.SUCCEEDED:
            session.execute(delete(Result).where(Result.fingerprint == task.fingerprint))
            task.state, task.reused, task.attempt = TaskState.WAITING, False, 0
            task.facts, task.digest, task.ended_at, task.progress = None, None, None, 0.0
        elif task.state == TaskState.RUNNABLE and not set(keys).isdisjoint(task.depends):
            task.state = TaskState.WAITING
    session.flush()
