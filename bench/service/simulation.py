"""Many inspections on many workers in a few minutes: the plan's own code and database, with a clock that is set.

Leases, turns and the unfolding of plans are those of `store.plan`. The stages are replaced by the seconds that they
took when they were recorded, and the time of the database by the time of the next thing to happen.
"""

from __future__ import annotations

import hashlib
import heapq
import itertools
import random
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from functools import partial
from typing import TypeVar

from sqlalchemy import URL, select
from sqlalchemy.orm import Session

from bench.service.recording import RecordedTask, Recording
from core.errors import StageFailed
from core.settings import Settings
from core.states import InspectionState
from core.task_key import stage_of
from store.accounts import Accounts
from store.db import Database
from store.graph import Graph
from store.inspections import Inspections
from store.models import Inspection
from store.plan import Plan
from store.records import InputFiles, Lease, Result

T = TypeVar("T")
_START = datetime(2026, 1, 1, tzinfo=UTC)
_FOREVER_S = 10.0**9
"""Of a lease: nobody beats here, and nobody dies."""


class SetClock(Database):
    """A database whose time is what was set last."""

    def __init__(self, url: str | URL) -> None:
        super().__init__(url)
        self.seconds = 0.0

    def now(self, session: Session) -> datetime:
        """The time that was set."""
        return _START + timedelta(seconds=self.seconds)


@dataclass(frozen=True)
class Workload:
    """What comes in, and who does it."""

    inspections: int
    span_s: float
    """They come at random moments of this time; 0 = all at once."""
    workers: int
    accounts: int = 1
    stretch: float = 1.0
    """Stages take so many times as long as recorded."""
    seed: int = 0
    arrivals_s: Sequence[float] = ()
    """When each one comes, instead of at random."""


@dataclass
class Simulated:
    """What came of it."""

    queue_s: list[float] = field(default_factory=list)
    """From the arrival of each inspection to its first task."""
    whole_s: list[float] = field(default_factory=list)
    """From its arrival to its end."""
    end_s: float = 0.0
    """When the last one ended."""
    busy_s: float = 0.0
    """Summed over slots."""
    most_waiting: int = 0
    """Inspections that had come and not begun, at most."""
    unknown: set[str] = field(default_factory=set)
    """Stages that are newer than the recording: their tasks were leased and took no time."""
    costs_s: dict[str, list[float]] = field(default_factory=dict)
    """Real seconds of each call of the plan: `create`, `lease`, `idle` (a lease that found nothing), `complete`."""

    def database_s(self) -> float:
        """Real seconds in the plan's calls, but for those that found nothing."""
        return sum(sum(values) for name, values in self.costs_s.items() if name != "idle")


@dataclass
class _Run:
    db: SetClock
    graph: Graph
    recordings: Sequence[Recording]
    load: Workload
    found: Simulated = field(default_factory=Simulated)
    _events: list[tuple[float, int, Callable[[], None]]] = field(default_factory=list)
    _numbers: Iterator[int] = field(default_factory=itertools.count)
    _of: dict[str, Recording] = field(default_factory=dict)
    _free: int = 0
    _waiting: set[str] = field(default_factory=set)

    def __post_init__(self) -> None:
        self._plan = Plan(self.db, self.graph, lease_s=_FOREVER_S)
        self._inspections = Inspections(self.db, self.graph)
        self._free = self.load.workers

    def run(self) -> Simulated:
        load, chance = self.load, random.Random(self.load.seed)
        owners = [f"account-{number}" for number in range(load.accounts)]
        for owner in owners:
            Accounts(self.db).create(owner)
        for number in range(load.inspections):
            owner = owners[number % len(owners)]
            moment = load.arrivals_s[number] if load.arrivals_s else chance.uniform(0.0, load.span_s)
            self._at(moment, partial(self._arrive, number, owner))
        while self._events:
            self.db.seconds, _, event = heapq.heappop(self._events)
            event()
            if not self._events or self._events[0][0] > self.db.seconds:
                self._lease_all()
        self._look()
        return self.found

    def _at(self, seconds: float, event: Callable[[], None]) -> None:
        heapq.heappush(self._events, (seconds, next(self._numbers), event))

    def _timed(self, name: str, call: Callable[[], T]) -> T:
        began = time.perf_counter()
        result = call()
        took = time.perf_counter() - began
        self.found.costs_s.setdefault("idle" if name == "lease" and result is None else name, []).append(took)
        return result

    def _arrive(self, number: int, owner: str) -> None:
        recording = self.recordings[number % len(self.recordings)]
        name, content = f"inspection-{number}", hashlib.sha256(str(number).encode()).hexdigest()
        files = [InputFiles("video", content, "annotations", content)]
        settings = Settings.model_validate(recording.settings)
        self._of[name] = recording
        self._waiting.add(name)
        self.found.most_waiting = max(self.found.most_waiting, len(self._waiting) - self._free)
        self._timed("create", lambda: self._inspections.create(name, files, settings, "", owner=owner))

    def _lease_all(self) -> None:
        while self._free:
            lease = self._timed("lease", lambda: self._plan.lease("a worker"))
            if lease is None:
                return
            self._free -= 1
            self._waiting.discard(lease.inspection_id)
            task = self._task(lease)
            outside_s = max(0.0, task.slot_s - task.stage_s)
            busy_s = outside_s + task.stage_s * self.load.stretch
            self.found.busy_s += busy_s
            self._at(self.db.seconds + busy_s, partial(self._end, lease))

    def _task(self, lease: Lease) -> RecordedTask:
        """What was recorded of a task; a stage that is newer than the recording takes no time."""
        recording = self._of[lease.inspection_id]
        if lease.key in recording.tasks:
            return recording.tasks[lease.key]
        if lease.stage in {stage_of(key) for key in recording.tasks}:
            raise StageFailed(f"the recording has no task '{lease.key}'", where="simulation")
        self.found.unknown.add(lease.stage)
        return RecordedTask(0.0, 0.0, 0, {})

    def _end(self, lease: Lease) -> None:
        recording, task = self._of[lease.inspection_id], self._task(lease)
        digest = hashlib.sha256(f"{lease.inspection_id} {lease.key}".encode()).hexdigest()
        result = Result(
            lease.fingerprint, lease.stage, digest, dict(task.facts), f"r/{digest}", task.stage_s, task.peak_rss_bytes
        )
        self._timed("complete", lambda: self._plan.complete(lease, result))
        self._at(self.db.seconds + recording.handover_s, self._give_back)

    def _give_back(self) -> None:
        self._free += 1

    def _look(self) -> None:
        with self.db.read() as session:
            rows = session.scalars(select(Inspection).order_by(Inspection.created_at)).all()
        for row in rows:
            if row.state != InspectionState.SUCCEEDED or row.started_at is None or row.ended_at is None:
                raise StageFailed(f"'{row.id}' ended {row.state}: {row.error}", where="simulation")
            self.found.queue_s.append((row.started_at - row.created_at).total_seconds())
            self.found.whole_s.append((row.ended_at - row.created_at).total_seconds())
            self.found.end_s = max(self.found.end_s, (row.ended_at - _START).total_seconds())


def simulate(url: str | URL, graph: Graph, recordings: Sequence[Recording], load: Workload) -> Simulated:
    """Run a workload to its end.

    Args:
        url: of an empty database with the newest tables.
        graph: that the recordings are of.
        recordings: replayed in turn.
        load: what comes in.

    Raises:
        StageFailed: a plan asks for a task that was not recorded, of a stage that was.
    """
    db = SetClock(url)
    try:
        return _Run(db, graph, recordings, load).run()
    finally:
        db.close()
