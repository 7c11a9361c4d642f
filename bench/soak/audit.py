"""What the database and the store say after a soak: every task counted once, and no file that belongs to nothing."""

from __future__ import annotations

import time
from collections import Counter
from pathlib import Path

from sqlalchemy import select

from core.states import AttemptOutcome, TaskState
from store.db import Database
from store.models import Artifact, Attempt, Inspection, Result, Task
from worker.results import MANIFEST

_PATIENCE_S = 90.0


def wrong_attempts(database: Database) -> list[str]:
    """Tasks without exactly one accepted attempt, unless a finished result was taken up instead."""
    with database.read() as session:
        accepted = Counter(session.scalars(select(Attempt.task_id).where(Attempt.outcome == AttemptOutcome.SUCCEEDED)))
        tasks = session.scalars(select(Task).where(Task.state == TaskState.SUCCEEDED)).all()
    expected = {task.id: 0 if task.reused else 1 for task in tasks}
    return [f"{task.inspection_id} {task.key}" for task in tasks if accepted[task.id] != expected[task.id]]


def attempts(database: Database) -> dict[str, int]:
    """How many attempts ended in which way."""
    with database.read() as session:
        return dict(sorted(Counter(session.scalars(select(Attempt.outcome))).items()))


def orphans(database: Database, data: Path) -> list[str]:
    """Files of the store that nothing names, once the cleaner had time to remove them."""
    deadline = time.monotonic() + _PATIENCE_S
    while (found := _unknown(database, data / "artifacts")) and time.monotonic() < deadline:
        time.sleep(1.0)
    return found


def _unknown(database: Database, store: Path) -> list[str]:
    with database.read() as session:
        known = set(session.scalars(select(Artifact.key)))
        inputs = set(session.scalars(select(Inspection.video_path)))
        inputs |= {path for path in session.scalars(select(Inspection.annotations_path)) if path}
        logs = {f"logs/{name}" for name in session.scalars(select(Inspection.id))}
        results = {f"results/{path}" for path in session.scalars(select(Result.path))}
    unknown = []
    for path in sorted(path for path in store.rglob("*") if path.is_file()):
        name = path.relative_to(store).as_posix()
        parents = {parent.relative_to(store).as_posix() for parent in path.parents if parent.is_relative_to(store)}
        if name not in known | inputs and not parents & (logs | results):
            unknown.append(name)
    return unknown + [name for name in sorted(results) if not (store / name / MANIFEST).is_file()]
