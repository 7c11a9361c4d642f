"""Tables. `migrations/` is what creates them; a test compares both."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from sqlalchemy import BigInteger, ForeignKey, Index, String, UniqueConstraint
from sqlalchemy.orm import Mapped, mapped_column, relationship

from core.scene import case as declared_cases
from core.scene import defect as declared_events
from core.scene import detection as declared_detections
from core.states import AttemptOutcome, InspectionState, Queue, TaskState

# Whoever takes the base class from here has all tables in its metadata, those of accounts included.
from store.account_models import DEFAULT_ACCOUNT
from store.columns import Base as Base
from store.columns import Choice, with_columns_of
from store.integration_models import MetadataEntry
from store.review_models import ReviewEntry as ReviewEntry

LEASABLE = (InspectionState.QUEUED, InspectionState.RUNNING)
"""States of an inspection whose tasks may start."""
ACTIVE_INSPECTION = (*LEASABLE, InspectionState.CANCELLING)
"""States of an inspection that is not over."""
OVER_TASK = (TaskState.SUCCEEDED, TaskState.FAILED, TaskState.SKIPPED, TaskState.CANCELLED)
"""States of a task that will not change by itself."""


class ReservationKind(StrEnum):
    """What a reservation holds."""

    INSPECTION = "inspection"
    """A place among the active inspections."""
    UPLOAD = "upload"
    """The bytes of a form that comes in, which counts as an open upload."""


def _inspection_key(primary: bool = True) -> Mapped[str]:
    """Whose the row is; first in the primary key, because every question is asked for one inspection."""
    key = ForeignKey("inspections.id", ondelete="CASCADE")
    return mapped_column(String(64), key, primary_key=primary, sort_order=-1 if primary else 0)


class FurtherVideo(Base):
    """A video of an inspection after the first, which is in the inspection's own row."""

    __tablename__ = "further_videos"

    inspection_id: Mapped[str] = _inspection_key()
    number: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    """From 1, in the order given."""
    video_path: Mapped[str]
    video_sha256: Mapped[str] = mapped_column(String(64))
    annotations_path: Mapped[str | None]
    annotations_sha256: Mapped[str | None] = mapped_column(String(64))


class Inspection(Base):
    """Videos, their annotations, parameters, the result."""

    __tablename__ = "inspections"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    state: Mapped[InspectionState] = mapped_column(Choice(InspectionState), index=True)
    video_path: Mapped[str]
    video_sha256: Mapped[str] = mapped_column(String(64))
    annotations_path: Mapped[str | None]
    annotations_sha256: Mapped[str | None] = mapped_column(String(64))
    further_videos: Mapped[list[FurtherVideo]] = relationship(
        order_by=FurtherVideo.number, cascade="all, delete-orphan", passive_deletes=True, lazy="selectin"
    )
    """`store.leasing.input_files` gives the first and these together."""
    input_digest: Mapped[str] = mapped_column(String(64))
    settings: Mapped[dict[str, Any]]
    out: Mapped[str]
    """Folder of a local run; empty in a server, whose files are in the artifact store."""
    failed_stage: Mapped[str | None] = mapped_column(String(64))
    error: Mapped[dict[str, Any] | None]
    owner: Mapped[str] = mapped_column(String(64), default=DEFAULT_ACCOUNT, index=True)
    """Id of the account that it belongs to. Who asks with a key of another account does not find it."""
    label: Mapped[str] = mapped_column(String(256), default="")
    external_id: Mapped[str] = mapped_column(String(256), default="", index=True)
    metadata_entries: Mapped[list[MetadataEntry]] = relationship(
        order_by=MetadataEntry.name, cascade="all, delete-orphan", passive_deletes=True, lazy="selectin"
    )
    """`store.leasing.metadata_of` gives them as names and texts."""
    parameters: Mapped[dict[str, Any] | None]
    """As they were asked for; `settings` is what they meant."""
    attempt: Mapped[int] = mapped_column(default=1)
    """Grows with every retry."""
    priority: Mapped[int] = mapped_column(default=0)
    """0 to 9; higher ones of an account go first. See `store.turns`."""
    input_bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    """Size of the files that it was made from; 0 for those from before it was written down."""
    published_bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    """Size of its published files."""
    reuse_account: Mapped[str] = mapped_column(String(64), default="")
    """The account whose finished results it may take up, and no other's; empty: those that all share."""
    progress: Mapped[float] = mapped_column(default=0.0)
    """Highest share shown in this attempt."""
    published: Mapped[int] = mapped_column(default=0)
    """The attempt whose files are in the artifact store. A plan that is over is shown as running until then."""
    publisher: Mapped[str | None] = mapped_column(String(128))
    publish_fence: Mapped[int] = mapped_column(default=0)
    publish_expires_at: Mapped[datetime | None]
    """The lease on publishing, as on a task."""
    expires_at: Mapped[datetime | None] = mapped_column(index=True)
    """When retention removes it."""
    deleted_at: Mapped[datetime | None]
    """The row outlives its files, so that its id answers 410."""
    purged_at: Mapped[datetime | None]
    """When the files of a deleted inspection were removed."""
    told: Mapped[str] = mapped_column(String(96), default="")
    """Attempt, state and stage that the last event of a change told of; see `store.events`."""
    previous: Mapped[list[str]]
    """Fingerprints of the plan before the last change of parameters: going back to it costs nothing."""
    created_at: Mapped[datetime]
    started_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    updated_at: Mapped[datetime]


class Task(Base):
    """One task of a plan, with its lease."""

    __tablename__ = "tasks"
    __table_args__ = (
        UniqueConstraint("inspection_id", "key"),
        Index("ix_tasks_state_lease_expires_at", "state", "lease_expires_at"),
        # A deleted row's id must never come back: a late result of the old row would be taken for the new one's.
        {"sqlite_autoincrement": True},
    )

    id: Mapped[int] = mapped_column(primary_key=True)
    inspection_id: Mapped[str] = _inspection_key(primary=False)
    key: Mapped[str] = mapped_column(String(128))
    stage: Mapped[str] = mapped_column(String(64))
    queue: Mapped[Queue] = mapped_column(Choice(Queue))
    position: Mapped[int]
    """Order in the plan; runnable tasks are leased in this order."""
    args: Mapped[dict[str, Any]]
    depends: Mapped[list[str]]
    optional: Mapped[bool]
    state: Mapped[TaskState] = mapped_column(Choice(TaskState))
    fingerprint: Mapped[str | None] = mapped_column(String(64), index=True)
    attempt: Mapped[int] = mapped_column(default=0)
    """Attempts begun, less those that were given back unharmed."""
    fence: Mapped[int] = mapped_column(default=0)
    """Grows with every lease; only the holder of the newest may end the task."""
    lease_owner: Mapped[str | None] = mapped_column(String(128))
    lease_expires_at: Mapped[datetime | None]
    announced_at: Mapped[datetime | None]
    """When a message said last that it can start; None before, and once it was leased. See `store.announcing`."""
    started_at: Mapped[datetime | None]
    ended_at: Mapped[datetime | None]
    seconds: Mapped[float | None]
    peak_rss_bytes: Mapped[int | None] = mapped_column(BigInteger)
    progress: Mapped[float] = mapped_column(default=0.0)
    message: Mapped[str] = mapped_column(String(256), default="")
    reused: Mapped[bool] = mapped_column(default=False)
    digest: Mapped[str | None] = mapped_column(String(64))
    facts: Mapped[dict[str, Any] | None]
    error: Mapped[dict[str, Any] | None]


class Attempt(Base):
    """History: every lease ever given and how it ended."""

    __tablename__ = "attempts"
    __table_args__ = (UniqueConstraint("task_id", "fence"), {"sqlite_autoincrement": True})

    id: Mapped[int] = mapped_column(primary_key=True)
    inspection_id: Mapped[str] = mapped_column(String(64), ForeignKey("inspections.id", ondelete="CASCADE"), index=True)
    task_id: Mapped[int]
    """Not a foreign key: history outlives a rebuilt plan."""
    key: Mapped[str] = mapped_column(String(128))
    fence: Mapped[int]
    attempt: Mapped[int]
    owner: Mapped[str] = mapped_column(String(128))
    fingerprint: Mapped[str] = mapped_column(String(64))
    started_at: Mapped[datetime]
    ended_at: Mapped[datetime | None]
    outcome: Mapped[AttemptOutcome] = mapped_column(Choice(AttemptOutcome))
    seconds: Mapped[float | None]
    peak_rss_bytes: Mapped[int | None] = mapped_column(BigInteger)
    error: Mapped[dict[str, Any] | None]


class Result(Base):
    """A finished result by fingerprint; its files lie under `path`."""

    __tablename__ = "results"

    fingerprint: Mapped[str] = mapped_column(String(64), primary_key=True)
    stage: Mapped[str] = mapped_column(String(64))
    digest: Mapped[str] = mapped_column(String(64))
    facts: Mapped[dict[str, Any]]
    rows: Mapped[dict[str, Any]]
    """What the table rows of this result are made from; see `store.tables`."""
    path: Mapped[str]
    seconds: Mapped[float]
    peak_rss_bytes: Mapped[int] = mapped_column(BigInteger)
    created_at: Mapped[datetime]


class _Row:
    """Common to rows that a stage writes: whose they are and which task wrote them."""

    inspection_id: Mapped[str] = _inspection_key()
    task_key: Mapped[str] = mapped_column(String(128))


# The columns of the three published tables are those of the declarations. A class names a column only where the
# database adds something to it: a key, a length, a default, or an attribute that queries are written with.


@with_columns_of(declared_cases.CaseRow)
class CaseRow(_Row, Base):
    """A row of cases.csv."""

    __tablename__ = "cases"

    name: Mapped[str] = mapped_column(String(64), primary_key=True)
    kind: Mapped[str] = mapped_column(String(16))
    status: Mapped[str] = mapped_column(String(16))
    seconds: Mapped[float]
    """The row that a stage makes has none yet; the one that is stored always has."""
    start_mode: Mapped[str | None] = mapped_column(String(16))
    selected: Mapped[int] = mapped_column(default=0)
    vetoed: Mapped[int] = mapped_column(default=0)


@with_columns_of(declared_detections.DetectionRow, also_null=("time_s", "support_points"))
class DetectionRow(_Row, Base):
    """A row of detections.csv."""

    __tablename__ = "detections"

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    label: Mapped[str]
    outcome: Mapped[str] = mapped_column(String(16))
    reason: Mapped[str | None] = mapped_column(String(64))
    rung: Mapped[str | None] = mapped_column(String(16))
    video: Mapped[int] = mapped_column(default=0)


@with_columns_of(declared_events.EventRow, also_null=("defect_id", "x", "y", "z", "radius"))
class EventRow(_Row, Base):
    """A row of timeline.csv."""

    __tablename__ = "events"

    event_id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    video: Mapped[int] = mapped_column(default=0)


class DefectRow(_Row, Base):
    """A record of defects.json; `record` is the whole of it."""

    __tablename__ = "defects"

    id: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    label: Mapped[str]
    x: Mapped[float | None]
    y: Mapped[float | None]
    z: Mapped[float | None]
    record: Mapped[dict[str, Any]]


class MetricRow(_Row, Base):
    """One number that a task found, named ``<task key>.<fact>``."""

    __tablename__ = "metrics"

    name: Mapped[str] = mapped_column(String(192), primary_key=True)
    value: Mapped[float]


class TableVersion(Base):
    """How often the rows of one table of an inspection have changed: pages of one version belong together."""

    __tablename__ = "table_versions"

    inspection_id: Mapped[str] = _inspection_key()
    name: Mapped[str] = mapped_column(String(16), primary_key=True)
    """Name of the `store.tables.Table`, e.g. ``events``."""
    version: Mapped[int]
    """Grows with every change; without a row it is 0."""


class Upload(Base):
    """One resumable upload (tus). The bytes lie in the upload folder under the id."""

    __tablename__ = "uploads"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    owner: Mapped[str] = mapped_column(String(64), default=DEFAULT_ACCOUNT, index=True)
    length: Mapped[int] = mapped_column(BigInteger)
    offset: Mapped[int] = mapped_column(BigInteger, default=0)
    """Bytes that were on disk for certain when this was committed."""
    upload_metadata: Mapped[dict[str, Any]]
    """tus's ``Upload-Metadata``, decoded."""
    sha256: Mapped[str | None] = mapped_column(String(64))
    """Of the whole file, once it is whole."""
    created_at: Mapped[datetime]
    updated_at: Mapped[datetime]
    expires_at: Mapped[datetime | None] = mapped_column(index=True)
    removed_at: Mapped[datetime | None]


class Reservation(Base):
    """What a request that is under way holds of a limit; see `store.admission`."""

    __tablename__ = "reservations"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    owner: Mapped[str] = mapped_column(String(64), default=DEFAULT_ACCOUNT)
    kind: Mapped[ReservationKind] = mapped_column(Choice(ReservationKind))
    bytes: Mapped[int] = mapped_column(BigInteger, default=0)
    """Still to be written."""
    expires_at: Mapped[datetime] = mapped_column(index=True)
    """Counts until then: what a killed process held is given back."""


class Artifact(Base):
    """A published file of an inspection."""

    __tablename__ = "artifacts"

    inspection_id: Mapped[str] = _inspection_key()
    path: Mapped[str] = mapped_column(String(512), primary_key=True)
    """Name of the contract, e.g. ``mapping/mesh_defects.ply``."""
    key: Mapped[str] = mapped_column(String(640))
    """Where it lies in the artifact store."""
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(String(64))
    media_type: Mapped[str] = mapped_column(String(128))
    created_at: Mapped[datetime]


class IdempotencyKey(Base):
    """A request that must have one effect however often it is sent."""

    __tablename__ = "idempotency_keys"

    owner: Mapped[str] = mapped_column(String(64), primary_key=True)
    key: Mapped[str] = mapped_column(String(256), primary_key=True)
    body_sha256: Mapped[str] = mapped_column(String(64))
    inspection_id: Mapped[str | None] = mapped_column(String(64))
    """None while the first request is under way."""
    created_at: Mapped[datetime]


class Worker(Base):
    """A process that leases tasks, as `/v1/system` shows it."""

    __tablename__ = "workers"

    name: Mapped[str] = mapped_column(String(128), primary_key=True)
    host: Mapped[str] = mapped_column(String(128))
    queues: Mapped[list[str]]
    slots: Mapped[int] = mapped_column(default=0)
    """Tasks side by side that it takes by message; 0 when it only asks the database."""
    started_at: Mapped[datetime]
    seen_at: Mapped[datetime]
