"""Publication: who publishes an inspection, the transaction that shows its files and rows, and what is shown then.

A plan that is over is published once per attempt. Whoever does it holds a lease with a fence, as on a task;
files go into the store first, under the attempt's own folder, and count from the commit on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from pathlib import PurePosixPath
from typing import Any

from sqlalchemy import ColumnElement, delete, or_, select, update
from sqlalchemy.orm import Session

from store.account_models import Account
from store.db import Database
from store.events import tell_change
from store.files import Stored
from store.graph import CORE_GRAPH
from store.leasing import changed, lock_inspection
from store.models import ACTIVE_INSPECTION, Artifact, Inspection
from store.tables import replace_rows

_BY_SUFFIX = {
    ".bin": "application/octet-stream",
    ".css": "text/css; charset=utf-8",
    ".csv": "text/csv; charset=utf-8",
    ".glb": "model/gltf-binary",
    ".html": "text/html; charset=utf-8",
    ".jpg": "image/jpeg",
    ".js": "text/javascript; charset=utf-8",
    ".json": "application/json",
    ".pdf": "application/pdf",
    ".ply": "application/ply",
    ".png": "image/png",
    ".txt": "text/plain; charset=utf-8",
}


def media_type(path: str) -> str:
    """By the name's suffix; bytes without a known one are just bytes."""
    return _BY_SUFFIX.get(PurePosixPath(path).suffix.lower(), "application/octet-stream")


_COMPRESSED = ".gz"
_COMPRESSIBLE = (".css", ".glb", ".html", ".js", ".json")


def compressed_key(key: str) -> str | None:
    """Where the store keeps the gzipped form of a file of a page; None for one that is kept as it is alone."""
    return key + _COMPRESSED if key.endswith(_COMPRESSIBLE) else None


def uncompressed_key(key: str) -> str:
    """The file that a gzipped one is the form of; any other is its own."""
    return key.removesuffix(_COMPRESSED)


def artifact_prefix(inspection_id: str, attempt: int) -> str:
    """Folder of the store with what an attempt published."""
    return f"inspections/{inspection_id}/{attempt}"


@dataclass(frozen=True)
class Ticket:
    """The right to publish one attempt of an inspection."""

    inspection_id: str
    attempt: int
    fence: int

    @property
    def prefix(self) -> str:
        """Where its files go."""
        return artifact_prefix(self.inspection_id, self.attempt)


@dataclass(frozen=True)
class Publishing:
    """Leases on publishing in one database."""

    db: Database
    lease_s: float = 30.0
    retention_days: float = 30.0

    def take(self, owner: str) -> Ticket | None:
        """The inspection that has waited longest to be published; None when there is none."""
        with self.db.read() as session:
            query = select(Inspection.id).where(*_due(self.db.now(session)))
            ids = session.scalars(query.order_by(Inspection.ended_at, Inspection.id)).all()
        taken = (self._take(inspection_id, owner) for inspection_id in ids)
        return next((ticket for ticket in taken if ticket is not None), None)

    def _take(self, inspection_id: str, owner: str) -> Ticket | None:
        with self.db.write() as session:
            inspection, now = lock_inspection(session, inspection_id), self.db.now(session)
            values = {
                "publisher": owner,
                "publish_fence": Inspection.publish_fence + 1,
                "publish_expires_at": now + timedelta(seconds=self.lease_s),
            }
            where = (Inspection.id == inspection_id, *_due(now))
            if not changed(session, update(Inspection).where(*where).values(values)):
                return None
            session.refresh(inspection)
            return Ticket(inspection_id, inspection.attempt, inspection.publish_fence)

    def renew(self, ticket: Ticket) -> bool:
        """Keep the lease; False when somebody else has it or there is nothing to publish any more."""
        with self.db.write() as session:
            until = self.db.now(session) + timedelta(seconds=self.lease_s)
            return changed(session, update(Inspection).where(*_held(ticket)).values(publish_expires_at=until))

    def take_over(self, owner: str) -> None:
        """Free the leases of an owner that is known to be gone."""
        with self.db.write() as session:
            changed(session, update(Inspection).where(Inspection.publisher == owner).values(publish_expires_at=None))

    def finish(self, ticket: Ticket, files: Sequence[Stored], rows: Mapping[str, Any]) -> bool:
        """Show what was published: artifacts, the report's rows, and that the inspection is over.

        Args:
            files: by path of the contract.
            rows: see `store.tables.replace_rows`.

        Returns:
            False when the lease was lost; nothing has changed then.
        """
        with self.db.write() as session:
            inspection, now = lock_inspection(session, ticket.inspection_id), self.db.now(session)
            values = {
                "published": ticket.attempt,
                "publisher": None,
                "publish_expires_at": None,
                "published_bytes": sum(file.size for file in files),
                "expires_at": self._until(session, inspection.owner, now),
                "updated_at": now,
            }
            if not changed(session, update(Inspection).where(*_held(ticket)).values(values)):
                return False
            _replace_artifacts(session, ticket, files, now)
            replace_rows(session, inspection.id, rows)
            session.refresh(inspection)
            tell_change(session, CORE_GRAPH, inspection, now)
            return True

    def _until(self, session: Session, owner: str, now: datetime) -> datetime | None:
        """When retention ends, by the account's own time or the deployment's; None = never."""
        account = session.get(Account, owner)
        own = None if account is None else account.retention_days
        days = self.retention_days if own is None else own
        return now + timedelta(days=days) if days else None


def _due(now: datetime) -> tuple[ColumnElement[bool], ...]:
    return (
        Inspection.state.not_in(ACTIVE_INSPECTION),
        Inspection.published < Inspection.attempt,
        Inspection.deleted_at.is_(None),
        or_(Inspection.publish_expires_at.is_(None), Inspection.publish_expires_at < now),
    )


def _held(ticket: Ticket) -> tuple[ColumnElement[bool], ...]:
    return (
        Inspection.id == ticket.inspection_id,
        Inspection.publish_fence == ticket.fence,
        Inspection.attempt == ticket.attempt,
        Inspection.published < ticket.attempt,
        Inspection.state.not_in(ACTIVE_INSPECTION),
        Inspection.deleted_at.is_(None),
    )


def _replace_artifacts(session: Session, ticket: Ticket, files: Sequence[Stored], now: datetime) -> None:
    session.execute(delete(Artifact).where(Artifact.inspection_id == ticket.inspection_id))
    session.add_all(
        Artifact(
            inspection_id=ticket.inspection_id,
            path=file.path,
            key=f"{ticket.prefix}/{file.path}",
            size=file.size,
            sha256=file.sha256,
            media_type=media_type(file.path),
            created_at=now,
        )
        for file in files
    )


@dataclass(frozen=True)
class ArtifactView:
    """One published file."""

    path: str
    key: str
    """Where it lies in the artifact store."""
    size: int
    sha256: str
    media_type: str
    created_at: datetime


@dataclass(frozen=True)
class ArtifactRows:
    """Published files of all inspections."""

    db: Database

    def all(self, inspection_id: str) -> Sequence[ArtifactView]:
        """Every published file of an inspection, by path."""
        query = select(Artifact).where(Artifact.inspection_id == inspection_id).order_by(Artifact.path)
        with self.db.read() as session:
            return [_view(row) for row in session.scalars(query)]

    def find(self, inspection_id: str, path: str) -> ArtifactView | None:
        """One published file; None when this inspection has none of that name."""
        with self.db.read() as session:
            row = session.get(Artifact, (inspection_id, path))
        return _view(row) if row is not None else None


def _view(row: Artifact) -> ArtifactView:
    return ArtifactView(row.path, row.key, row.size, row.sha256, row.media_type, row.created_at)
