"""Small steps on leases that `store.plan` puts together; each runs inside the caller's transaction."""

from __future__ import annotations

import os
import platform
import uuid
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import PurePosixPath
from typing import Any

from sqlalchemy import ColumnElement, CursorResult, Update, select, update
from sqlalchemy.orm import Session

from core.errors import BadInput
from core.states import AttemptOutcome, TaskState
from store.db import insert_into
from store.integration_models import MetadataEntry
from store.models import LEASABLE, Attempt, FurtherVideo, Inspection, Task
from store.models import Result as ResultRow
from store.records import InputFiles, Lease, Result


def lock_inspection(session: Session, inspection_id: str) -> Inspection:
    """The inspection, held against every other change of its plan until the transaction ends."""
    query = select(Inspection).where(Inspection.id == inspection_id).with_for_update()
    inspection = session.scalars(query.execution_options(populate_existing=True)).one_or_none()
    if inspection is None:
        raise BadInput(f"there is no inspection '{inspection_id}'", where="inspection")
    return inspection


def unique_name() -> str:
    """A name for the holder of leases that no other process has or had."""
    return f"{platform.node()[:64]}-{os.getpid()}-{uuid.uuid4().hex[:6]}"


def changed(session: Session, statement: Update) -> bool:
    """Run an update; True when it met a row. The database compares, so of two callers one succeeds."""
    done = session.execute(statement, execution_options={"synchronize_session": False})
    assert isinstance(done, CursorResult)
    return bool(done.rowcount)


def held(lease: Lease) -> tuple[ColumnElement[bool], ...]:
    """The condition under which a lease still counts."""
    return (Task.id == lease.task_id, Task.fence == lease.fence, Task.state == TaskState.LEASED)


def lease_of(session: Session, inspection: Inspection, task: Task) -> Lease:
    """The lease as a value, with the results of the task's dependencies."""
    query = select(Task).where(
        Task.inspection_id == inspection.id, Task.key.in_(task.depends), Task.state == TaskState.SUCCEEDED
    )
    done = session.scalars(query).all()
    names = [dep.fingerprint for dep in done]
    paths = {
        row.fingerprint: row.path for row in session.scalars(select(ResultRow).where(ResultRow.fingerprint.in_(names)))
    }
    return Lease(
        task_id=task.id,
        fence=task.fence,
        attempt=task.attempt,
        owner=task.lease_owner or "",
        inspection_id=inspection.id,
        key=task.key,
        stage=task.stage,
        args=dict(task.args),
        optional=task.optional,
        fingerprint=task.fingerprint or "",
        settings=dict(inspection.settings),
        files=input_files(inspection),
        inputs={dep.key: PurePosixPath(paths[dep.fingerprint or ""]) for dep in done},
        facts={dep.key: dict(dep.facts or {}) for dep in done},
    )


def input_files(inspection: Inspection) -> tuple[InputFiles, ...]:
    """The inspection's videos with their annotations as values, in the order given."""
    return tuple(
        InputFiles(row.video_path, row.video_sha256, row.annotations_path, row.annotations_sha256)
        for row in _rows(inspection)
    )


def _rows(inspection: Inspection) -> list[Inspection | FurtherVideo]:
    """The rows with the videos of an inspection."""
    return [inspection, *inspection.further_videos]


def set_input_files(inspection: Inspection, files: Sequence[InputFiles]) -> None:
    """Write an inspection's videos with their annotations; ValueError without any."""
    if not files:
        raise ValueError("an inspection has at least one video")
    known = {row.number: row for row in inspection.further_videos}
    inspection.further_videos = [known.get(number) or FurtherVideo(number=number) for number in range(1, len(files))]
    for row, one in zip(_rows(inspection), files, strict=True):
        row.video_path, row.video_sha256 = one.video, one.video_sha256
        row.annotations_path, row.annotations_sha256 = one.annotations, one.annotations_sha256


def metadata_of(row: Inspection) -> dict[str, str]:
    """The metadata of an inspection, by name."""
    return {entry.name: entry.value for entry in row.metadata_entries}


def set_metadata(row: Inspection, metadata: Mapping[str, str]) -> None:
    """Replace the metadata of an inspection; an empty text is no entry."""
    known = {entry.name: entry for entry in row.metadata_entries}
    wanted = {name: text for name, text in metadata.items() if text}
    entries = {name: known.get(name) or MetadataEntry(name=name) for name in wanted}
    for name, entry in entries.items():
        entry.value = wanted[name]
    row.metadata_entries = list(entries.values())


def begin_attempt(session: Session, task: Task, now: datetime) -> None:
    """Open the history of a lease."""
    session.add(
        Attempt(
            inspection_id=task.inspection_id,
            task_id=task.id,
            key=task.key,
            fence=task.fence,
            attempt=task.attempt,
            owner=task.lease_owner or "",
            fingerprint=task.fingerprint or "",
            started_at=now,
            outcome=AttemptOutcome.RUNNING,
        )
    )


def end_attempt(
    session: Session,
    task_id: int,
    fence: int,
    now: datetime,
    outcome: AttemptOutcome,
    values: Mapping[str, Any] | None = None,
) -> None:
    """Close the history of a lease."""
    where = (Attempt.task_id == task_id, Attempt.fence == fence)
    session.execute(update(Attempt).where(*where).values(ended_at=now, outcome=outcome, **(values or {})))


def give_back(task: Task, inspection: Inspection, now: datetime, *, counts: bool) -> None:
    """Undo a lease: the task may start again, or is cancelled with its inspection."""
    task.lease_owner, task.lease_expires_at = None, None
    task.progress, task.message = 0.0, ""
    if not counts:
        task.attempt -= 1
    if inspection.state in LEASABLE:
        task.state = TaskState.RUNNABLE
    else:
        task.state, task.ended_at = TaskState.CANCELLED, now


def put_result(session: Session, result: Result, now: datetime) -> ResultRow:
    """Remember a finished result by its fingerprint.

    Two inspections may finish the same one at the same moment; they lock their own plans, not each other's. So the
    database decides: the later one waits for the earlier and writes over it.
    """
    values = {
        "stage": result.stage,
        "digest": result.digest,
        "facts": dict(result.facts),
        "rows": dict(result.rows),
        "path": result.path,
        "seconds": result.seconds,
        "peak_rss_bytes": result.peak_rss_bytes,
        "created_at": now,
    }
    statement = insert_into(session, ResultRow).values(fingerprint=result.fingerprint, **values)
    statement = statement.on_conflict_do_update(index_elements=[ResultRow.fingerprint], set_=values)
    session.execute(statement)
    return session.get_one(ResultRow, result.fingerprint, populate_existing=True)
