"""What former inspections took, and from it how long the rest of a plan may take: intervals, never one number."""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import func, select

from core.states import InspectionState, StageState, TaskState
from store.db import Database
from store.graph import Graph
from store.models import Inspection, Task
from store.status import StageStatus

Interval = tuple[float, float]
"""Low and high, in seconds."""

_FORMER = 50
"""Inspections that are learnt from, the latest first."""
_ALONE = (0.5, 2.0)
"""How far the next one may lie from the only one that is known."""


@dataclass(frozen=True)
class StageTiming:
    """What one stage took in former inspections."""

    per_task: Interval
    per_plan: Interval
    """Summed over its tasks."""


Timings = Mapping[str, StageTiming]


def learn_timings(db: Database) -> Timings:
    """Timings of every stage that some former inspection finished."""
    latest = (
        select(Inspection.id)
        .where(Inspection.state.in_((InspectionState.SUCCEEDED, InspectionState.PARTIAL)))
        .order_by(Inspection.ended_at.desc())
        .limit(_FORMER)
        .subquery()
    )
    query = (
        select(Task.stage, func.count(), func.sum(Task.seconds))
        .where(
            Task.inspection_id.in_(select(latest.c.id)), Task.state == TaskState.SUCCEEDED, Task.seconds.is_not(None)
        )
        .group_by(Task.inspection_id, Task.stage)
    )
    per_task, per_plan = defaultdict(list), defaultdict(list)
    with db.read() as session:
        for stage, n, seconds in session.execute(query):
            per_task[stage].append(float(seconds or 0.0) / n)
            per_plan[stage].append(float(seconds or 0.0))
    return {stage: StageTiming(_interval(per_task[stage]), _interval(per_plan[stage])) for stage in per_task}


def _interval(values: Sequence[float]) -> Interval:
    """The range that four of five lie in; a single one says little, so its range is wide."""
    if len(values) == 1:
        return (values[0] * _ALONE[0], values[0] * _ALONE[1])
    tenths = statistics.quantiles(values, n=10, method="inclusive")
    return (tenths[0], tenths[-1])


def stage_eta(stage: StageStatus, graph: Graph, timings: Timings, workers: int) -> Interval | None:
    """Seconds that are left of one stage; None when nothing is known about it."""
    left = _left(stage, graph, timings, workers)
    return None if left is None else (round(left[0], 1), round(left[1], 1))


def _left(stage: StageStatus, graph: Graph, timings: Timings, workers: int) -> Interval | None:
    if stage.state not in (StageState.WAITING, StageState.RUNNING):
        return (0.0, 0.0)
    timing = timings.get(stage.name)
    if timing is None:
        return None
    side_by_side = max(1, workers) if graph.stages[stage.name].fan_out else 1
    if not stage.count.total:
        return _scaled(timing.per_plan, 1 / side_by_side)
    left = stage.count.total * (1 - stage.count.share)
    return _scaled(timing.per_task, left / min(side_by_side, stage.count.total))


def plan_eta(stages: Sequence[StageStatus], graph: Graph, timings: Timings, workers: int) -> Interval | None:
    """Seconds that are left of the whole plan; None when some stage of it is unknown."""
    etas = [_left(stage, graph, timings, workers) for stage in stages]
    known = [eta for eta in etas if eta is not None]
    if len(known) < len(etas):
        return None
    return (round(sum(low for low, _ in known), 1), round(sum(high for _, high in known), 1))


def _scaled(interval: Interval, factor: float) -> Interval:
    return (interval[0] * factor, interval[1] * factor)
