"""What former inspections took, and from it how long the rest of a plan may take: intervals, never one number.

A stage that no former inspection had is guessed from its weight, the seconds that were measured on the sample.
"""

from __future__ import annotations

import statistics
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from sqlalchemy import select

from core.products.contract import read_product
from core.products.front import FramesProduct
from core.stage_specs import USUAL_CORES, USUAL_FRAMES, StageSpec
from core.states import InspectionState, StageState, TaskState
from store.db import Database
from store.graph import Graph
from store.models import ACTIVE_INSPECTION, Inspection, Task
from store.status import StageStatus

Interval = tuple[float, float]
"""Low and high, in seconds."""

_FORMER = 50
"""Inspections that are learnt from, the latest first."""
_ALONE = (0.5, 2.0)
"""How far the next one may lie from the only one that is known."""
_GUESSED = (0.4, 2.5)
"""How far a stage may lie from its weight: machines and videos differ."""
_OF_PLAN = (0.7, 1.4)
"""How far a plan may lie from its stages: they wait for each other, and for what else the machine does."""
_PUBLISHED_S = 5.0
"""Until the files of a plan that is over can be fetched, at most."""
_FEW_FRAMES = 24
"""A video whose frames are not counted yet has at least so many; the settings say how many at most."""
_FRAMES = "frames"
"""The task after which the number of frames is known."""


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
    query = select(Task.inspection_id, Task.stage, Task.seconds, Task.started_at, Task.ended_at, Task.reused).where(
        Task.inspection_id.in_(select(latest.c.id)), Task.state == TaskState.SUCCEEDED, Task.seconds.is_not(None)
    )
    taken: dict[tuple[str, str], list[float]] = defaultdict(list)
    with db.read() as session:
        for row in session.execute(query):
            whole = 0.0  # with the start of its process and the storing of its files, unless another run did these
            if row.started_at is not None and row.ended_at is not None and not row.reused:
                whole = (row.ended_at - row.started_at).total_seconds()
            taken[row.inspection_id, row.stage].append(max(float(row.seconds), whole))
    per_task, per_plan = defaultdict(list), defaultdict(list)
    for (_, stage), seconds in taken.items():
        per_task[stage].append(sum(seconds) / len(seconds))
        per_plan[stage].append(sum(seconds))
    return {stage: StageTiming(_interval(per_task[stage]), _interval(per_plan[stage])) for stage in per_task}


def _interval(values: Sequence[float]) -> Interval:
    """The range that four of five lie in; a single one says little, so its range is wide."""
    if len(values) == 1:
        return (values[0] * _ALONE[0], values[0] * _ALONE[1])
    tenths = statistics.quantiles(values, n=10, method="inclusive")
    return (tenths[0], tenths[-1])


@dataclass(frozen=True)
class Expectation:
    """What the time that is left is told from."""

    graph: Graph
    timings: Timings
    """Of former inspections."""
    workers: int
    """Tasks side by side."""
    frames: Interval
    """How many frames there may be."""


def stage_eta(stage: StageStatus, by: Expectation) -> Interval:
    """Seconds that are left of one stage."""
    low, high = _left(stage, by)
    return (round(low, 1), round(high, 1))


def plan_eta(stages: Sequence[StageStatus], by: Expectation) -> Interval:
    """Seconds that are left of the whole plan, until its files can be fetched."""
    left = [_left(stage, by) for stage in stages]
    low, high = sum(one for one, _ in left) * _OF_PLAN[0], sum(other for _, other in left) * _OF_PLAN[1]
    return (round(low, 1), round(high + _PUBLISHED_S, 1))


def _left(stage: StageStatus, by: Expectation) -> Interval:
    if stage.state not in (StageState.WAITING, StageState.RUNNING):
        return (0.0, 0.0)
    spec, timing = by.graph.stages[stage.name], by.timings.get(stage.name)
    if timing is None:
        low, high = _scaled(_guessed(spec, by), 1.0 - stage.count.share)
        # A plan of which former ones are known may pass a stage by that they did not have.
        return (0.0 if by.timings and not stage.count.total else low, high)
    side_by_side = max(1, by.workers) if spec.fan_out else 1
    if not stage.count.total:
        return _scaled(timing.per_plan, 1 / side_by_side)
    left = stage.count.total * (1 - stage.count.share)
    return _scaled(timing.per_task, left / min(side_by_side, stage.count.total))


def _guessed(spec: StageSpec, by: Expectation) -> Interval:
    """Seconds of the clock that a whole stage may take on these workers, from those of the sample."""
    usual = spec.weight * (USUAL_CORES / max(1, by.workers) if spec.fan_out else 1.0)
    few, many = by.frames if spec.per_frame else (USUAL_FRAMES, USUAL_FRAMES)
    return (usual * _GUESSED[0] * few / USUAL_FRAMES, usual * _GUESSED[1] * many / USUAL_FRAMES)


def _scaled(interval: Interval, factor: float) -> Interval:
    return (interval[0] * factor, interval[1] * factor)


def expected_frames(db: Database, inspection: Inspection) -> Interval:
    """How many frames an inspection has: counted, or as its settings bound it.

    For one that is over the database is not asked: no time is left that the number would tell.
    """
    if inspection.state in ACTIVE_INSPECTION:
        query = select(Task.facts).where(Task.inspection_id == inspection.id, Task.key == _FRAMES)
        with db.read() as session:
            facts = session.scalar(query)
        if facts:
            counted = float(read_product(FramesProduct, facts, _FRAMES).n_frames)
            return (counted, counted)
    most = float(inspection.settings["frames"]["max_count"])
    return (min(float(_FEW_FRAMES), most), most)
