"""Inspections as a whole: created, found, started again, deleted, and their results left out of a new plan.

Leases on their tasks are `store.plan`'s.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import delete, select, update
from sqlalchemy.orm import Session

from core.errors import BadInput
from core.fingerprint import digest_of
from core.settings import Settings
from core.states import InspectionState, TaskState
from store.advance import advance
from store.db import Database
from store.events import EventType, tell, tell_change
from store.graph import CORE_GRAPH, Graph
from store.leasing import (
    changed,
    input_files,
    lock_inspection,
    metadata_of,
    put_result,
    set_input_files,
    set_metadata,
)
from store.models import ACTIVE_INSPECTION, Inspection, Task
from store.models import Result as ResultRow
from store.records import InputFiles, InspectionView, Result, TaskView
from store.tables import clear_rows, replace_rows


def input_digest(files: Sequence[InputFiles]) -> str:
    """Name of an input by its content, and by the order of several videos."""
    names = [{"video": one.video_sha256, "annotations": one.annotations_sha256} for one in files]
    return digest_of(names[0] if len(names) == 1 else names)


@dataclass(frozen=True)
class Inspections:
    """Everything about inspections but their leases."""

    db: Database
    graph: Graph = CORE_GRAPH

    def create(
        self, inspection_id: str, files: Sequence[InputFiles], settings: Settings, out: str, **more: Any
    ) -> None:
        """A new inspection with the first tasks of its plan; `more` are further columns, e.g. owner and label."""
        with self.db.write() as session:
            self.create_in(session, inspection_id, files, settings, out, **more)

    def create_in(
        self,
        session: Session,
        inspection_id: str,
        files: Sequence[InputFiles],
        settings: Settings,
        out: str,
        metadata: Mapping[str, str] | None = None,
        **more: Any,
    ) -> None:
        """The same inside the caller's transaction."""
        now = self.db.now(session)
        inspection = Inspection(
            id=inspection_id,
            state=InspectionState.QUEUED,
            input_digest=input_digest(files),
            settings=settings.model_dump(mode="json"),
            out=out,
            previous=[],
            created_at=now,
            updated_at=now,
            **more,
        )
        set_input_files(inspection, files)
        set_metadata(inspection, metadata or {})
        session.add(inspection)
        session.flush()
        advance(session, self.graph, inspection, now)
        tell_change(session, self.graph, inspection, now)

    def reopen(
        self,
        inspection_id: str,
        files: Sequence[InputFiles],
        settings: Settings,
        *,
        ended_only: bool = False,
        admit: Callable[[Session], None] | None = None,
        metadata: Mapping[str, str] | None = None,
        **more: Any,
    ) -> None:
        """Plan an inspection anew, with other parameters, another input, or the same after a stop.

        The plan is rebuilt from nothing; finished fingerprints are taken up again, so only what changed is
        left to do, and failed tasks get a new chance. Old leases end: their results will be refused.
        With `ended_only` an inspection that is not over is left alone; `metadata` replaces what it has, and `more`
        are further columns. `admit` is called first in the transaction and may refuse.

        Raises:
            BadInput: `conflict` when a task is leased (cancel first, or take over leases of owners that are
                gone), or when it is not over and must be.
        """
        chosen = settings.model_dump(mode="json")
        with self.db.write() as session:
            if admit is not None:
                admit(session)
            inspection, now = lock_inspection(session, inspection_id), self.db.now(session)
            tasks = session.scalars(select(Task).where(Task.inspection_id == inspection_id)).all()
            if any(task.state == TaskState.LEASED for task in tasks) or (
                ended_only and inspection.state in ACTIVE_INSPECTION
            ):
                raise BadInput("the inspection is still being worked on", code="conflict", where=inspection_id)
            if chosen != inspection.settings or input_digest(files) != inspection.input_digest:
                inspection.previous = sorted({task.fingerprint for task in tasks if task.fingerprint})
            session.execute(delete(Task).where(Task.inspection_id == inspection_id))
            clear_rows(session, inspection_id)
            session.expunge_all()
            inspection = lock_inspection(session, inspection_id)
            set_input_files(inspection, files)
            inspection.input_digest, inspection.settings = input_digest(files), chosen
            inspection.state, inspection.error, inspection.failed_stage = InspectionState.QUEUED, None, None
            inspection.started_at, inspection.ended_at = None, None
            inspection.attempt, inspection.progress, inspection.expires_at = inspection.attempt + 1, 0.0, None
            if metadata is not None:
                set_metadata(inspection, metadata)
            for column, value in more.items():
                setattr(inspection, column, value)
            advance(session, self.graph, inspection, now)
            tell_change(session, self.graph, inspection, now)

    def find(self) -> list[InspectionView]:
        """All inspections, oldest first."""
        with self.db.read() as session:
            rows = session.scalars(select(Inspection).order_by(Inspection.created_at, Inspection.id))
            return [_view(row) for row in rows]

    def get(self, inspection_id: str) -> InspectionView:
        """One inspection; `BadInput` when there is none."""
        with self.db.read() as session:
            row = session.get(Inspection, inspection_id)
            if row is None:
                raise BadInput(f"there is no inspection '{inspection_id}'", where="inspection")
            return _view(row)

    def tasks(self, inspection_id: str) -> list[TaskView]:
        """The plan as it stands, in its order."""
        with self.db.read() as session:
            query = (
                select(Task, ResultRow.path)
                .outerjoin(ResultRow, ResultRow.fingerprint == Task.fingerprint)
                .where(Task.inspection_id == inspection_id)
                .order_by(Task.position, Task.id)
            )
            return [_task_view(task, path) for task, path in session.execute(query)]

    def stages_from(self, inspection_id: str, stage: str) -> set[str]:
        """`stage` and the stages of all tasks that depend on it, directly or not, in the plan as it stands."""
        keys: set[str] = set()
        stages = {stage}
        for task in self.tasks(inspection_id):
            if task.stage == stage or keys.intersection(task.depends):
                keys.add(task.key)
                stages.add(task.stage)
        return stages

    def put_rows(self, inspection_id: str, rows: Mapping[str, Any]) -> None:
        """Replace the rows of cases, detections, events and defects by those of the final report."""
        with self.db.write() as session:
            lock_inspection(session, inspection_id)
            replace_rows(session, inspection_id, rows)

    def known_results(self) -> dict[str, str]:
        """Path of every known result by fingerprint."""
        with self.db.read() as session:
            rows = session.execute(select(ResultRow.fingerprint, ResultRow.path))
            return {fingerprint: path for fingerprint, path in rows}  # noqa: C416 - rows are not plain tuples

    def adopt(self, results: Iterable[Result]) -> None:
        """Take up results whose files were finished but whose commit a crash cut off."""
        with self.db.write() as session:
            now = self.db.now(session)
            # In one order everywhere, so that two who adopt the same do not wait for each other.
            for result in sorted(results, key=lambda one: one.fingerprint):
                put_result(session, result, now)

    def delete_results(self, fingerprints: Iterable[str]) -> None:
        """Remove results from memory; whoever calls removes their files afterwards, never before."""
        with self.db.write() as session:
            for fingerprint in fingerprints:
                session.execute(delete(ResultRow).where(ResultRow.fingerprint == fingerprint))

    def unused(self) -> list[str]:
        """Fingerprints that no plan uses, now or under its previous parameters: the ones to clean up."""
        with self.db.read() as session:
            used = set(session.scalars(select(Task.fingerprint).where(Task.fingerprint.is_not(None)).distinct()))
            for previous in session.scalars(select(Inspection.previous)):
                used.update(previous)
            return [name for name in session.scalars(select(ResultRow.fingerprint)) if name not in used]


def _view(row: Inspection) -> InspectionView:
    return InspectionView(
        id=row.id,
        state=row.state,
        files=input_files(row),
        input_digest=row.input_digest,
        settings=dict(row.settings),
        out=row.out,
        failed_stage=row.failed_stage,
        error=row.error,
        label=row.label,
        external_id=row.external_id,
        metadata=metadata_of(row),
    )


def _task_view(task: Task, path: str | None) -> TaskView:
    return TaskView(
        key=task.key,
        stage=task.stage,
        position=task.position,
        depends=tuple(task.depends),
        optional=task.optional,
        state=task.state,
        attempt=task.attempt,
        fingerprint=task.fingerprint,
        seconds=task.seconds,
        peak_rss_bytes=task.peak_rss_bytes,
        progress=task.progress,
        reused=task.reused,
        digest=task.digest,
        facts=task.facts,
        error=task.error,
        path=path if task.state == TaskState.SUCCEEDED else None,
    )


def mark_deleted(db: Database, inspection_id: str) -> bool:
    """Mark an inspection as deleted; False when it was already."""
    with db.write() as session:
        where, now = (Inspection.id == inspection_id, Inspection.deleted_at.is_(None)), db.now(session)
        if not changed(session, update(Inspection).where(*where).values(deleted_at=now)):
            return False
        tell(session, session.get_one(Inspection, inspection_id), EventType.DELETED, now)
        return True


def delete_results_from(inspections: Inspections, inspection_id: str, stage: str) -> list[str]:
    """Delete the results of `stage` and of all that follow it in this plan.

    Returns:
        Their paths in the result store; whoever calls removes the files, afterwards and never before.

    Raises:
        BadInput: `conflict` when another inspection that is not over builds on one of them.
    """
    stages = inspections.stages_from(inspection_id, stage)
    own = [task for task in inspections.tasks(inspection_id) if task.stage in stages and task.fingerprint]
    fingerprints = {task.fingerprint for task in own if task.fingerprint}
    shared = (
        select(Task.id)
        .join(Inspection, Inspection.id == Task.inspection_id)
        .where(Task.inspection_id != inspection_id, Task.fingerprint.in_(fingerprints))
        .where(Inspection.state.in_(ACTIVE_INSPECTION))
        .limit(1)
    )
    with inspections.db.read() as session:
        if session.scalar(shared) is not None:
            message = f"another inspection that is not over uses the same results of '{stage}'"
            raise BadInput(message, code="conflict", where="from_stage")
    paths = inspections.known_results()
    inspections.delete_results(fingerprints)
    return [paths[name] for name in sorted(fingerprints) if name in paths]
