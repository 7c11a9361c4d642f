"""How far a run is and how long it will take: from the plan's rows and what tasks took so far."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from core.states import RunState, TaskState
from core.task_key import stage_of
from store.graph import Graph
from store.models import OVER_TASK
from store.progress import StageCount, plan_share, stage_weights
from store.records import TaskView
from worker.outcome import Event, EventKind


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
        event = self.event("ended", task.key, message)
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
            fraction=1.0 if kind == "finished" and state == RunState.SUCCEEDED else self._fraction,
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
        """Seconds left: known tasks at the mean of their stage, the rest at what a unit of weight took so far."""
        took: dict[str, list[float]] = {}
        for task in self._tasks.values():
            if task.state == TaskState.SUCCEEDED and task.seconds is not None:
                took.setdefault(task.stage, []).append(task.seconds)
        counts = self._counts()
        weights = stage_weights(self._graph, counts)
        done_weight = sum(weights[stage] * counts[stage].share for stage in took)
        if done_weight <= 0:
            return None
        second_per_weight = sum(sum(seconds) for seconds in took.values()) / done_weight
        left = 0.0
        for stage, weight in weights.items():
            count = counts.get(stage, StageCount(0, 0))
            rest = count.total * (1 - count.share)
            side_by_side = self._workers if self._graph.stages[stage].fan_out else 1
            mean = sum(took[stage]) / len(took[stage]) if stage in took else None
            seconds = rest * mean if mean is not None else weight * (1 - count.share) * second_per_weight
            left += seconds / side_by_side
        return round(left, 1)
