"""The state of an inspection as it is shown: its stages and how far it is. One cheap read, asked again and again."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, case, func, or_, select, update
from sqlalchemy.orm import Session

from core.report.summary import stage_state
from core.states import InspectionState, StageState, TaskState
from store.db import Database
from store.graph import CORE_GRAPH, Graph
from store.leasing import changed
from store.models import ACTIVE_INSPECTION, OVER_TASK, CaseRow, Inspection, Task
from store.turns import queued_in_turn

STEP = 0.005
"""Progress is shown in steps of this, so that remembering the highest costs few writes."""
PUBLISH = "publish"
"""Name of what happens after the last stage: the files of the contract are put into the artifact store."""
_ALMOST = 0.995
"""Shown at most until the result can be fetched."""


@dataclass(frozen=True)
class StageCount:
    """The tasks of one stage as far as they are known."""

    total: int
    over: int
    """Ended, in whatever way."""
    running: float = 0.0
    """Sum of the shares of running tasks."""

    @property
    def share(self) -> float:
        """How far the stage is, in [0, 1]."""
        return min(1.0, (self.over + self.running) / self.total) if self.total else 0.0


def stage_weights(graph: Graph, present: Mapping[str, StageCount]) -> dict[str, float]:
    """Weight of every stage that this plan has or may still get; one that was passed by has none."""
    names = list(graph.stages)
    reached = max((names.index(name) for name in present), default=-1)
    return {
        name: graph.stages[name].weight for position, name in enumerate(names) if name in present or position > reached
    }


def plan_share(graph: Graph, counts: Mapping[str, StageCount]) -> float:
    """How far the plan is, in [0, 1]."""
    weights = stage_weights(graph, counts)
    total = sum(weights.values())
    if not total:
        return 0.0
    done = sum(weight * counts[name].share for name, weight in weights.items() if name in counts)
    return min(1.0, done / total)


def in_steps(share: float) -> float:
    """`share` rounded down to `STEP`."""
    return int(share / STEP + 1e-9) * STEP


@dataclass(frozen=True)
class StageStatus:
    """One stage, summed over its tasks."""

    name: str
    state: StageState
    count: StageCount
    attempts: int
    reused: int
    started_at: datetime | None
    ended_at: datetime | None
    seconds: float
    """Summed over tasks, whenever they were computed."""
    peak_rss_bytes: int | None
    """Largest of one task."""


@dataclass(frozen=True)
class InspectionStatus:
    """An inspection with everything that its resource says and the database knows."""

    row: Inspection
    """Detached; its columns are loaded."""
    state: InspectionState
    """As shown: an ended plan whose files are not published yet still runs."""
    stage: str | None
    """Where it is; None when it is over."""
    stages: tuple[StageStatus, ...]
    """Every stage of the graph, in its order."""
    progress: float
    queue_position: int | None
    """1 = next; None when it is not queued."""
    selected_case: str | None

    @property
    def active(self) -> bool:
        """True while something may still change by itself."""
        return self.state in ACTIVE_INSPECTION


def shown_state(row: Inspection) -> InspectionState:
    """State as others see it; see `shown_state_column` for the same in SQL."""
    if row.state in ACTIVE_INSPECTION or row.published >= row.attempt:
        return row.state
    return InspectionState.CANCELLING if row.state == InspectionState.CANCELLED else InspectionState.RUNNING


def shown_state_column() -> ColumnElement[str]:
    """`shown_state` as an expression."""
    settled = or_(Inspection.state.in_(ACTIVE_INSPECTION), Inspection.published >= Inspection.attempt)
    stopping = (Inspection.state == InspectionState.CANCELLED, InspectionState.CANCELLING)
    return case((settled, Inspection.state), stopping, else_=InspectionState.RUNNING)


@dataclass(frozen=True)
class Statuses:
    """Reads what inspections look like."""

    db: Database
    graph: Graph = CORE_GRAPH

    def read(self, inspection_id: str) -> InspectionStatus | None:
        """One inspection, deleted ones included; None when there is none."""
        with self.db.read() as session:
            row = session.get(Inspection, inspection_id)
            if row is None:
                return None
            positions = _positions(session, [row])
            status = self._status(session, row, _counted(session, [row.id]).get(row.id, {}), positions)
        self._remember(status)
        return status

    def read_many(self, rows: Sequence[Inspection]) -> list[InspectionStatus]:
        """The same for a page of rows, with one query for all their stages."""
        with self.db.read() as session:
            counted, positions = _counted(session, [row.id for row in rows]), _positions(session, rows)
            return [self._status(session, row, counted.get(row.id, {}), positions) for row in rows]

    def _status(
        self, session: Session, row: Inspection, groups: Mapping[str, Sequence[Any]], positions: Mapping[str, int]
    ) -> InspectionStatus:
        state = shown_state(row)
        over = row.state not in ACTIVE_INSPECTION
        stages = tuple(_stage(name, groups.get(name, ()), over) for name in self.graph.stages)
        return InspectionStatus(
            row=row,
            state=state,
            stage=_current(stages, state, over),
            stages=stages,
            progress=self._progress(row, state, stages),
            queue_position=positions.get(row.id),
            selected_case=_selected(session, row.id) if state not in ACTIVE_INSPECTION else None,
        )

    def _progress(self, row: Inspection, state: InspectionState, stages: Iterable[StageStatus]) -> float:
        if state == InspectionState.SUCCEEDED:
            return 1.0
        share = in_steps(plan_share(self.graph, {stage.name: stage.count for stage in stages if stage.count.total}))
        return max(row.progress, min(share, _ALMOST))

    def _remember(self, status: InspectionStatus) -> None:
        """Write down the highest share that was shown, so that no other process shows less."""
        if status.progress <= status.row.progress:
            return
        where = (
            Inspection.id == status.row.id,
            Inspection.attempt == status.row.attempt,
            Inspection.progress < status.progress,
        )
        with self.db.write() as session:
            changed(session, update(Inspection).where(*where).values(progress=status.progress))


def _counted(session: Session, inspection_ids: Sequence[str]) -> dict[str, dict[str, list[Any]]]:
    """Tasks by inspection and stage, one entry per state."""
    query = (
        select(
            Task.inspection_id,
            Task.stage,
            Task.state,
            func.count().label("n"),
            func.sum(Task.progress).label("progress"),
            func.sum(Task.attempt).label("attempts"),
            func.sum(case((Task.reused, 1), else_=0)).label("reused"),
            func.min(Task.started_at).label("started_at"),
            func.max(Task.ended_at).label("ended_at"),
            func.sum(Task.seconds).label("seconds"),
            func.max(Task.peak_rss_bytes).label("peak_rss_bytes"),
        )
        .where(Task.inspection_id.in_(inspection_ids))
        .group_by(Task.inspection_id, Task.stage, Task.state)
    )
    found: dict[str, dict[str, list[Any]]] = defaultdict(lambda: defaultdict(list))
    for group in session.execute(query):
        found[group.inspection_id][group.stage].append(group)
    return found


def _stage(name: str, groups: Sequence[Any], over: bool) -> StageStatus:
    by_state = {group.state: group.n for group in groups}
    started = [group.started_at for group in groups if group.started_at]
    ended = [group.ended_at for group in groups if group.ended_at]
    peaks = [group.peak_rss_bytes for group in groups if group.peak_rss_bytes is not None]
    count = StageCount(
        total=sum(by_state.values()),
        over=sum(n for state, n in by_state.items() if state in OVER_TASK),
        running=float(sum(group.progress or 0.0 for group in groups if group.state == TaskState.LEASED)),
    )
    state = _stage_state(by_state, count, over)
    return StageStatus(
        name=name,
        state=state,
        count=count,
        attempts=sum(group.attempts or 0 for group in groups),
        reused=sum(group.reused or 0 for group in groups),
        started_at=min(started, default=None),
        ended_at=max(ended, default=None) if count.total and count.over == count.total else None,
        seconds=round(float(sum(group.seconds or 0.0 for group in groups)), 3),
        peak_rss_bytes=max(peaks, default=None),
    )


def _stage_state(by_state: Mapping[TaskState, int], count: StageCount, over: bool) -> StageState:
    if count.over < count.total:
        return StageState.RUNNING if TaskState.LEASED in by_state or count.over else StageState.WAITING
    if not count.total:
        return StageState.SKIPPED if over else StageState.WAITING
    return stage_state(list(by_state))


def _current(stages: Sequence[StageStatus], state: InspectionState, over: bool) -> str | None:
    if state not in ACTIVE_INSPECTION:
        return None
    if over:
        return PUBLISH
    running = [stage.name for stage in stages if stage.state == StageState.RUNNING]
    waiting = [stage.name for stage in stages if stage.state == StageState.WAITING]
    return next(iter([*running, *waiting]), None)


def _positions(session: Session, rows: Iterable[Inspection]) -> dict[str, int]:
    """Place among the queued, from 1; asked for only when one of the rows is queued."""
    if all(row.state != InspectionState.QUEUED for row in rows):
        return {}
    return {name: place for place, name in enumerate(queued_in_turn(session), 1)}


def _selected(session: Session, inspection_id: str) -> str | None:
    query = select(CaseRow.name).where(CaseRow.inspection_id == inspection_id, CaseRow.selected == 1).limit(1)
    name: str | None = session.scalar(query)
    return name
