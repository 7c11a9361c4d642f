"""Housekeeping: what may be removed, as questions and small transactions. Files are removed by whoever asks.

Rows go first and files afterwards, so a crash leaves files that belong to nothing. Those are found by
comparing what there is with what is used: the same answer after any crash, however often it is asked.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from datetime import timedelta

from sqlalchemy import ColumnElement, and_, delete, or_, select
from sqlalchemy.orm import Session

from store.account_models import AuditEntry, RequestCount, WebSession
from store.db import Database
from store.events import EventType, tell
from store.integration_models import InspectionEvent, WebhookDelivery
from store.leasing import lock_inspection
from store.models import (
    ACTIVE_INSPECTION,
    Artifact,
    FurtherVideo,
    IdempotencyKey,
    Inspection,
    Reservation,
    Result,
    Task,
    Upload,
    Worker,
)
from store.publishing import artifact_prefix
from store.review_models import ReviewEntry
from store.tables import clear_rows
from store.transfers import Transfers

_IDEMPOTENCY_DAYS = 3
_WORKER_DAYS = 1
_UPLOAD_DAYS = 3
"""A removed upload's id answers 410 so long."""


@dataclass(frozen=True)
class Retention:
    """What has outlived its use, in one database."""

    db: Database
    audit_days: float = 365.0
    event_days: float = 30.0

    def expire(self) -> int:
        """Mark inspections as deleted whose time is over; returns how many."""
        with self.db.write() as session:
            now = self.db.now(session)
            over = (Inspection.expires_at < now, Inspection.deleted_at.is_(None))
            query = select(Inspection).where(*over, Inspection.state.not_in(ACTIVE_INSPECTION))
            late = session.scalars(query.with_for_update()).all()
            for inspection in late:
                inspection.deleted_at = inspection.updated_at = now
            for inspection in sorted(late, key=lambda one: one.owner):  # counters of accounts are held in one order
                tell(session, inspection, EventType.DELETED, now)
            return len(late)

    def to_purge(self) -> list[str]:
        """Deleted inspections whose rows and files are still there and that nobody works on any more."""
        with self.db.read() as session:
            gone = (Inspection.deleted_at.is_not(None), Inspection.purged_at.is_(None))
            return list(session.scalars(select(Inspection.id).where(*gone, Inspection.state.not_in(ACTIVE_INSPECTION))))

    def purge(self, inspection_id: str) -> None:
        """Delete what belongs to a deleted inspection, but not its row. What it used may be unused then."""
        with self.db.write() as session:
            inspection = lock_inspection(session, inspection_id)
            if inspection.deleted_at is None or inspection.state in ACTIVE_INSPECTION:
                return
            for table in (Task, Artifact, ReviewEntry):
                columns = table.__table__.columns
                session.execute(delete(table).where(columns["inspection_id"] == inspection_id))
            clear_rows(session, inspection_id)
            inspection.previous = []
            inspection.purged_at = self.db.now(session)

    def inputs_in_use(self) -> set[str]:
        """Hashes of the input files of inspections that are not purged."""
        with self.db.read() as session:
            return _inputs(session, Inspection.purged_at.is_(None))

    def inputs_at_work(self) -> set[str]:
        """The same of inspections that are not over."""
        with self.db.read() as session:
            return _inputs(session, Inspection.state.in_(ACTIVE_INSPECTION))

    def has_input(self, owner: str, sha256: str) -> bool:
        """True when an inspection of this account that was not deleted has a file with this hash among its inputs."""
        with self.db.read() as session:
            return sha256 in _inputs(session, and_(Inspection.owner == owner, Inspection.deleted_at.is_(None)), sha256)

    def folders_in_use(self) -> set[str]:
        """Folders of the artifact store with files that are shown, or may be any moment."""
        with self.db.read() as session:
            query = select(Inspection.id, Inspection.attempt, Inspection.published)
            rows = session.execute(query.where(Inspection.purged_at.is_(None)))
            return {artifact_prefix(name, number) for name, *numbers in rows for number in numbers}

    def logs_in_use(self) -> set[str]:
        """Inspections whose logs are kept."""
        with self.db.read() as session:
            return set(session.scalars(select(Inspection.id).where(Inspection.purged_at.is_(None))))

    def results_at_work(self) -> set[str]:
        """Paths of results that a task may read or a publisher may need."""
        with self.db.read() as session:
            unfinished = or_(Inspection.state.in_(ACTIVE_INSPECTION), Inspection.published < Inspection.attempt)
            query = (
                select(Result.path)
                .join(Task, Task.fingerprint == Result.fingerprint)
                .join(Inspection, Inspection.id == Task.inspection_id)
                .where(unfinished)
            )
            return set(session.scalars(query))

    def known_fingerprints(self) -> set[str]:
        """Fingerprints with a row or with a task that may be about to get one."""
        with self.db.read() as session:
            tasks = session.scalars(select(Task.fingerprint).where(Task.fingerprint.is_not(None)).distinct())
            return {*(name for name in tasks if name), *session.scalars(select(Result.fingerprint))}

    def delete_unused(self, fingerprints: Iterable[str]) -> list[str]:
        """Delete results that still nobody uses; returns the paths of those that were deleted."""
        deleted = []
        for fingerprint in fingerprints:
            with self.db.write() as session:
                # Locked before the question: a plan that takes this result up holds it, and we wait for it.
                held = select(Result).where(Result.fingerprint == fingerprint).with_for_update()
                result = session.scalars(held).one_or_none()
                used = session.scalar(select(Task.id).where(Task.fingerprint == fingerprint).limit(1))
                if result is not None and used is None and not _kept_for_later(session.scalars(_PREVIOUS), fingerprint):
                    session.delete(result)
                    deleted.append(result.path)
        return deleted

    def expire_uploads(self) -> int:
        """Mark uploads as removed that nobody used in time; returns how many."""
        with self.db.write() as session:
            now = self.db.now(session)
            late = (Upload.expires_at < now, Upload.removed_at.is_(None))
            rows = session.scalars(select(Upload).where(*late).with_for_update()).all()
            for upload in rows:
                upload.removed_at = now
            return len(rows)

    def expire_transfers(self) -> int:
        """End what is fetched by URL and nobody asked for in time, its uploads too; returns how many of these."""
        return Transfers(self.db).forget()

    def uploads_in_use(self) -> set[str]:
        """Ids of uploads whose file is needed."""
        with self.db.read() as session:
            return set(session.scalars(select(Upload.id).where(Upload.removed_at.is_(None))))

    def tidy(self) -> None:
        """Delete what nobody asks for any more.

        These are old requests, absent workers, removed uploads, ended reservations and sessions, counts of former
        minutes, and events, their deliveries and entries of the audit log after their time.
        """
        with self.db.write() as session:
            now = self.db.now(session)
            old, unseen = now - timedelta(days=_IDEMPOTENCY_DAYS), now - timedelta(days=_WORKER_DAYS)
            session.execute(delete(IdempotencyKey).where(IdempotencyKey.created_at < old))
            session.execute(delete(Worker).where(Worker.seen_at < unseen))
            session.execute(delete(Upload).where(Upload.removed_at < now - timedelta(days=_UPLOAD_DAYS)))
            session.execute(delete(Reservation).where(Reservation.expires_at < now))
            session.execute(delete(WebSession).where(WebSession.expires_at < now))
            session.execute(delete(RequestCount).where(RequestCount.minute < now - timedelta(minutes=2)))
            session.execute(delete(AuditEntry).where(AuditEntry.at < now - timedelta(days=self.audit_days)))
            before = now - timedelta(days=self.event_days)
            session.execute(delete(InspectionEvent).where(InspectionEvent.at < before))  # takes its deliveries along
            of_tests = (WebhookDelivery.number.is_(None), WebhookDelivery.created_at < before)
            session.execute(delete(WebhookDelivery).where(*of_tests))


_PREVIOUS = select(Inspection.previous).where(Inspection.purged_at.is_(None))


def _inputs(session: Session, which: ColumnElement[bool], sha256: str | None = None) -> set[str]:
    """Hashes of the input files of the inspections of which `which` is true, or only of those with one such file."""
    first = select(Inspection.video_sha256, Inspection.annotations_sha256).where(which)
    others = select(FurtherVideo.video_sha256, FurtherVideo.annotations_sha256)
    others = others.join(Inspection, Inspection.id == FurtherVideo.inspection_id).where(which)
    if sha256 is not None:
        first = first.where(or_(Inspection.video_sha256 == sha256, Inspection.annotations_sha256 == sha256))
        others = others.where(or_(FurtherVideo.video_sha256 == sha256, FurtherVideo.annotations_sha256 == sha256))
    return {sha256 for query in (first, others) for row in session.execute(query) for sha256 in row if sha256}


def _kept_for_later(previous: Iterable[Collection[str]], fingerprint: str) -> bool:
    """True for a result of the parameters before the last change: going back to them costs nothing."""
    return any(fingerprint in names for names in previous)
