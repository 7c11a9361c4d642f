"""Events of a local run: what a caller of `run_inspection` sees while it runs, and the outcome at its end."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from pathlib import Path

from core.errors import BladeAtlasError
from core.stage_specs import USUAL_CORES
from core.states import AttemptOutcome, RunState, StageState, TaskState
from core.task_key import stage_of
from store.graph import Graph
from store.models import OVER_TASK
from store.records import Lease, TaskView
from store.status import StageCount, plan_share, stage_weights


class EventKind(StrEnum):
    """What happened."""

    OPENED = "opened"
    """The plan is in order: once, at the start."""
    STARTED = "started"
    """A task begins."""
    PROGRESS = "progress"
    """A task reports."""
    RETRY = "retry"
    """A task failed and will be tried again."""
    ENDED = "ended"
    """A task is over."""
    PUBLISHED = "published"
    """The files of the contract are written: once."""
    FINISHED = "finished"
    """The run is over: once, at the end."""


@dataclass(frozen=True)
class Event:
    """One step of a run, for a progress display or as a JSON line."""

    kind: EventKind
    fraction: float
    """Share of the whole run in [0, 1]; never falls within a run."""
    eta_s: float | None = None
    """Estimated seconds left; None until something was measured."""
    stage: str = ""
    key: str = ""
    """Task key, e.g. ``coarse/seg_000_0000_0180``; empty for events of the run."""
    state: str = ""
    """Of the task (``succeeded``, ``failed``, ``skipped`` ...) or, in ``finished``, of the run."""
    done: int = 0
    """Ended tasks of this stage."""
    total: int = 0
    """Tasks of this stage known so far."""
    stage_fraction: float = 0.0
    """Share of this stage in [0, 1], running tasks included."""
    seconds: float | None = None
    """What the task took, when it ended."""
    reused: bool = False
    """The task's result was already there."""
    message: str = ""


OnEvent = Callable[[Event], None]


@dataclass(frozen=True)
class StageOutcome:
    """One stage of a run, summed over its tasks."""

    name: str
    state: StageState
    done: int
    total: int
    reused: int
    seconds: float
    """Summed over tasks, whenever they were computed."""
    peak_rss_bytes: int


@dataclass(frozen=True)
class Outcome:
    """How a run ended. Exit codes are the command line's."""

    state: RunState
    out: Path
    seconds: float
    """Wall time of this call."""
    computed: int
    """Tasks that ran in this call."""
    reused: int
    """Tasks whose result was already there."""
    failed_stage: str = ""
    error: BladeAtlasError | None = None
    """Set for ``partial``, ``failed`` and ``cancelled``; its `code` says why."""
    stages: tuple[StageOutcome, ...] = field(default_factory=tuple)


class Tracker:
    """Turns changes of the plan into events; calls come one at a time."""

    def __init__(self, graph: Graph, workers: int) -> None:
        self._graph = graph
        self._workers = workers
        self._tasks: dict[str, TaskView] = {}
        self._stages: dict[str, list[TaskView]] = {}
        self._running: dict[str, float] = {}
        self._fraction = 0.0

    def refresh(self, tasks: Sequence[TaskView]) -> list[Event]:
        """Take in the plan as it stands; events of the tasks that ended since the last time."""
        before, self._tasks = self._tasks, {task.key: task for task in tasks}
        self._stages = {}
        for task in tasks:
            self._stages.setdefault(task.stage, []).append(task)
        ended = [t for t in tasks if t.state in OVER_TASK and (t.key not in before or before[t.key].state != t.state)]
        for task in ended:
            self._running.pop(task.key, None)
        return [self._ended(task) for task in ended]

    def _ended(self, task: TaskView) -> Event:
        message = str((task.error or {}).get("message", ""))
        event = self.event(EventKind.ENDED, task.key, message)
        return replace(event, state=task.state, seconds=task.seconds, reused=task.reused)

    def running(self, key: str, progress: float) -> None:
        """Note how far a running task is."""
        self._running[key] = progress

    def idle(self, key: str) -> None:
        """Note that a task stopped without ending."""
        self._running.pop(key, None)

    def event(self, kind: EventKind, key: str = "", message: str = "", state: str = "") -> Event:
        """An event of this moment; its fraction never falls."""
        stage = stage_of(key)
        counts = self._counts()
        own = counts.get(stage, StageCount(0, 0))
        self._fraction = max(self._fraction, plan_share(self._graph, counts))
        return Event(
            kind=kind,
            fraction=1.0 if kind == EventKind.FINISHED and state == RunState.SUCCEEDED else self._fraction,
            eta_s=self._eta(),
            stage=stage,
            key=key,
            state=state,
            done=own.over,
            total=own.total,
            stage_fraction=own.share,
            message=message,
        )

    def _counts(self) -> dict[str, StageCount]:
        return {
            stage: StageCount(
                total=len(own),
                over=sum(task.state in OVER_TASK for task in own),
                running=sum(self._running.get(task.key, 0.0) for task in own if task.state not in OVER_TASK),
            )
            for stage, own in self._stages.items()
        }

    def _eta(self) -> float | None:
        """Seconds left: known tasks at the mean of their stage, the rest by weight, at the pace so far."""
        took: dict[str, list[float]] = {}
        for task in self._tasks.values():
            if task.state == TaskState.SUCCEEDED and task.seconds is not None:
                took.setdefault(task.stage, []).append(task.seconds)
        counts = self._counts()
        weights = stage_weights(self._graph, counts)
        done_weight = sum(weights[stage] * counts[stage].share for stage in took)
        if done_weight <= 0:
            return None
        stages = self._graph.stages
        spent = sum(sum(seconds) / (USUAL_CORES if stages[stage].fan_out else 1) for stage, seconds in took.items())
        pace = spent / done_weight
        left = 0.0
        for stage, weight in weights.items():
            count = counts.get(stage, StageCount(0, 0))
            rest = count.total * (1 - count.share)
            fan_out = stages[stage].fan_out
            if stage in took:
                left += rest * sum(took[stage]) / len(took[stage]) / (self._workers if fan_out else 1)
            else:
                left += weight * (1 - count.share) * pace * (USUAL_CORES / self._workers if fan_out else 1)
        return round(left, 1)


@dataclass
class Reporter:
    """The observer of a local run."""

    tracker: Tracker
    tasks: Callable[[], Sequence[TaskView]]
    """Reads the plan as it stands."""
    on_event: OnEvent | None
    computed: int = 0
    """Tasks that ran and were accepted."""
    _mutex: threading.RLock = field(default_factory=threading.RLock)

    def opened(self) -> None:
        """The plan is in order; what is finished already is told at once."""
        with self._mutex:
            ended = self.tracker.refresh(self.tasks())
            self.tell(EventKind.OPENED)
            self._send(ended)

    def started(self, lease: Lease) -> None:
        """A runner took a task."""
        with self._mutex:
            self.tracker.running(lease.key, 0.0)
            self.tell(EventKind.STARTED, lease.key)

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        """A running task reports."""
        with self._mutex:
            self.tracker.running(lease.key, fraction)
            self.tell(EventKind.PROGRESS, lease.key, message)

    def ended(self, lease: Lease, outcome: AttemptOutcome, error: BladeAtlasError | None) -> None:
        """A runner is through with a task; others may have ended with it (reused, skipped)."""
        with self._mutex:
            self.computed += outcome == AttemptOutcome.SUCCEEDED
            self.tracker.idle(lease.key)
            ended = self.tracker.refresh(self.tasks())
            if outcome == AttemptOutcome.RETRIED:
                self.tell(EventKind.RETRY, lease.key, error.message if error else "")
            self._send(ended)

    def tell(self, kind: EventKind, key: str = "", message: str = "", state: str = "") -> None:
        """Send an event of this moment."""
        with self._mutex:
            self._send([self.tracker.event(kind, key, message, state)])

    def _send(self, events: Sequence[Event]) -> None:
        if self.on_event is not None:
            for event in events:
                self.on_event(event)
