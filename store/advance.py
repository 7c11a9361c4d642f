"""How a plan moves on: expand the graph with what is known, reuse finished results, free what became runnable.

Everything here runs inside one transaction that holds the inspection's row, so two tasks that end at the
same moment never start their reducer twice. Nothing is kept in memory: the same call after any crash
gives the same plan.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from core.errors import error_from_dict
from core.fingerprint import digest_of
from core.graph import TaskSpec
from core.products.contract import Facts
from core.settings import Settings
from core.states import InspectionState, TaskState
from store.graph import Graph
from store.leasing import input_files
from store.models import LEASABLE, OVER_TASK, Inspection, Result, Task
from store.tables import write_rows


def advance(session: Session, graph: Graph, inspection: Inspection, now: datetime) -> None:
    """Bring the plan of a locked inspection up to date; ends the inspection when nothing is left."""
    if inspection.state not in LEASABLE:
        return
    settings = Settings.model_validate(inspection.settings)
    tasks = {task.key: task for task in _tasks(session, inspection.id)}
    while _step(session, graph, inspection, settings, tasks, now):
        pass
    session.flush()
    _finish(graph, inspection, list(tasks.values()), now)
    inspection.updated_at = now


def _tasks(session: Session, inspection_id: str) -> Sequence[Task]:
    return session.scalars(select(Task).where(Task.inspection_id == inspection_id).order_by(Task.position)).all()


def _step(
    session: Session,
    graph: Graph,
    inspection: Inspection,
    settings: Settings,
    tasks: dict[str, Task],
    now: datetime,
) -> bool:
    """One pass over the plan; True when a reused result may have opened more of it."""
    known: dict[str, Facts] = {
        key: task.facts for key, task in tasks.items() if task.state == TaskState.SUCCEEDED and task.facts is not None
    }
    plan = graph.expand(settings, known)
    for position, spec in enumerate(plan):
        if spec.key in tasks:
            tasks[spec.key].position = position
        else:
            tasks[spec.key] = _new_task(session, graph, inspection.id, spec, position)
    broken = any(task.state == TaskState.FAILED and not _tolerated(task) for task in tasks.values())
    reused = False
    for spec in plan:
        task = tasks[spec.key]
        if broken:
            if task.state in (TaskState.WAITING, TaskState.RUNNABLE):
                task.state, task.ended_at = TaskState.SKIPPED, now
        elif task.state == TaskState.WAITING:
            reused |= _settle(session, graph, inspection, settings, spec, tasks, now)
    return reused and not broken


def _new_task(session: Session, graph: Graph, inspection_id: str, spec: TaskSpec, position: int) -> Task:
    task = Task(
        inspection_id=inspection_id,
        key=spec.key,
        stage=spec.stage,
        queue=graph.stages[spec.stage].queue,
        position=position,
        args=dict(spec.args),
        depends=list(spec.depends),
        optional=spec.optional,
        state=TaskState.WAITING,
        attempt=0,
        fence=0,
        progress=0.0,
        message="",
        reused=False,
    )
    session.add(task)
    return task


def _tolerated(task: Task) -> bool:
    """An optional task may fail, unless what stopped it would stop the others and spoil the run unseen."""
    return task.optional and not (task.error or {}).get("stops_run", False)


def _settle(
    session: Session,
    graph: Graph,
    inspection: Inspection,
    settings: Settings,
    spec: TaskSpec,
    tasks: Mapping[str, Task],
    now: datetime,
) -> bool:
    """Move one waiting task on if its dependencies have ended; True when a finished result was reused."""
    depends = [tasks[key] for key in spec.depends]
    if any(task.state not in OVER_TASK for task in depends):
        return False
    task = tasks[spec.key]
    if any(dep.state != TaskState.SUCCEEDED and not dep.optional for dep in depends):
        task.state, task.ended_at = TaskState.SKIPPED, now
        return False
    digests = {dep.key: dep.digest for dep in depends if dep.state == TaskState.SUCCEEDED and dep.digest is not None}
    named = graph.fingerprint(spec, settings, digests, input_files(inspection))
    task.fingerprint = _among(inspection.reuse_account, named)
    # Held until the commit: who cleans up waits, and then sees that this task uses it.
    result = session.get(Result, task.fingerprint, with_for_update={"read": True})
    if result is None:
        task.state = TaskState.RUNNABLE
        return False
    session.flush()
    accept(session, task, result, now, reused=True)
    return True


def _among(account: str, fingerprint: str) -> str:
    """Name of a result among those of one account, which no other account takes up; empty: among those of all."""
    return digest_of({"account": account, "fingerprint": fingerprint}) if account else fingerprint


def accept(session: Session, task: Task, result: Result, now: datetime, *, reused: bool) -> None:
    """Write a result into its task, with the rows that belong to it."""
    task.state, task.reused, task.progress = TaskState.SUCCEEDED, reused, 1.0
    task.facts, task.digest, task.error = result.facts, result.digest, None
    task.seconds, task.peak_rss_bytes = result.seconds, result.peak_rss_bytes
    task.lease_owner, task.lease_expires_at, task.ended_at = None, None, now
    rows = dict(result.rows)
    rows["metrics"] = [{**row, "name": f"{task.key}.{row['name']}"} for row in rows.get("metrics", ())]
    rows["cases"] = [{"seconds": result.seconds, "selected": 0, "vetoed": 0, **row} for row in rows.get("cases", ())]
    write_rows(session, task.inspection_id, task.key, rows)


def _finish(graph: Graph, inspection: Inspection, tasks: list[Task], now: datetime) -> None:
    """End the inspection once every task has ended."""
    if any(task.state not in OVER_TASK for task in tasks):
        return
    failed = sorted((t for t in tasks if t.state == TaskState.FAILED and not _tolerated(t)), key=lambda t: t.position)
    inspection.ended_at = now
    if not failed:
        inspection.state, inspection.error, inspection.failed_stage = InspectionState.SUCCEEDED, None, None
        return
    first = failed[0]
    error: dict[str, Any] = dict(first.error or {})
    inspection.error, inspection.failed_stage = error, first.stage
    outcome = error_from_dict(error).code == "no_reconstruction"
    served = any(task.stage in graph.serves_from and task.state == TaskState.SUCCEEDED for task in tasks)
    inspection.state = InspectionState.PARTIAL if served and not outcome else InspectionState.FAILED
