"""What tasks took in inspections that ended, as the simulation replays them."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from statistics import median
from typing import Any

from sqlalchemy import select

from core.errors import BadInput
from core.states import AttemptOutcome, InspectionState, TaskState
from store.db import Database
from store.models import Attempt, Inspection, Task

_SAME_TURN_S = 0.5
"""A slot that is idle for longer between two tasks waited for work, not for its turn."""


@dataclass(frozen=True)
class RecordedTask:
    """One task of an inspection."""

    slot_s: float
    """Seconds from its lease to its end: the start of its process, the stage, and the storing of its files."""
    stage_s: float
    """Of them those of the stage's process."""
    peak_rss_bytes: int
    facts: Mapping[str, Any]
    """What the plan unfolds from."""


@dataclass(frozen=True)
class Recording:
    """One inspection, and how long a slot needs between two tasks."""

    settings: Mapping[str, Any]
    tasks: Mapping[str, RecordedTask]
    """By key."""
    handover_s: float

    @property
    def slot_s(self) -> float:
        """Seconds of a slot that the whole inspection takes."""
        return sum(task.slot_s for task in self.tasks.values())

    def write(self, path: Path) -> None:
        """Write it as JSON."""
        path.write_text(json.dumps(asdict(self), indent=1, allow_nan=False) + "\n", encoding="utf-8")


def read_recording(path: Path) -> Recording:
    """A recording that `Recording.write` wrote; `BadInput` when it is none."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        tasks = {key: RecordedTask(**task) for key, task in found["tasks"].items()}
        return Recording(found["settings"], tasks, float(found["handover_s"]))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise BadInput(f"'{path}' is no recording: {error}", where="recording") from None


def record(db: Database) -> list[Recording]:
    """Every inspection of a database that succeeded, computed without taking up results of others, oldest first."""
    with db.read() as session:
        attempts = session.scalars(select(Attempt).where(Attempt.outcome == AttemptOutcome.SUCCEEDED)).all()
        tasks = session.scalars(select(Task).where(Task.state == TaskState.SUCCEEDED)).all()
        over = select(Inspection).where(Inspection.state == InspectionState.SUCCEEDED).order_by(Inspection.created_at)
        inspections = session.scalars(over).all()
    handover_s = _handover_s(attempts)
    facts = {(task.inspection_id, task.key): dict(task.facts or {}) for task in tasks}
    reused = {task.inspection_id for task in tasks if task.reused}
    found: dict[str, dict[str, RecordedTask]] = {}
    for one in attempts:
        if one.ended_at is not None and (one.inspection_id, one.key) in facts:
            slot_s = (one.ended_at - one.started_at).total_seconds()
            found.setdefault(one.inspection_id, {})[one.key] = RecordedTask(
                slot_s, one.seconds or 0.0, one.peak_rss_bytes or 0, facts[one.inspection_id, one.key]
            )
    return [
        Recording(dict(row.settings), found[row.id], handover_s)
        for row in inspections
        if row.id not in reused and row.id in found
    ]


def _handover_s(attempts: Sequence[Attempt]) -> float:
    """Median seconds from the end of a task to the next lease of the same slot."""
    gaps = []
    last: dict[str, datetime] = {}
    for one in sorted(attempts, key=lambda attempt: attempt.started_at):
        if one.owner in last:
            gap = (one.started_at - last[one.owner]).total_seconds()
            if 0.0 <= gap < _SAME_TURN_S:
                gaps.append(gap)
        if one.ended_at is not None:
            last[one.owner] = one.ended_at
    return median(gaps) if gaps else 0.0
