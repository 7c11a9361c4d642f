"""Transfers: inputs that are fetched by URL for a request, which is sent again until they are there.

The database knows what is fetched, for whom, into which uploads and by whom. Who fetches holds a lease with a fence, as
on a task; when its time is over, the process that the request comes to next takes it over and goes on with the same
uploads. An upload that another one replaces ends in the transaction that makes the other, so that nothing is counted
twice.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import ColumnElement, delete, func, or_, select, update
from sqlalchemy.orm import Session

from core.errors import BladeAtlasError, error_from_dict
from store.admission import LimitReached
from store.db import Database, insert_into
from store.integration_models import Transfer, TransferFile, TransferState
from store.leasing import changed
from store.models import Upload
from store.outbound import Unreachable

KEPT_S = 900.0
"""What nobody asked for again ends after this: at its URL there may be another file by now."""
_OWN: Mapping[str, type[BladeAtlasError]] = {kind.__name__: kind for kind in (LimitReached, Unreachable)}
"""Kinds of error that `core` does not know."""


class TransferLost(BladeAtlasError):
    """The lease ended: another process fetches now, or nobody wants the files any more."""

    code = "transfer_lost"


def transfer_lost() -> TransferLost:
    """What ends the work of a process that lost its lease."""
    return TransferLost("another process fetches this file now", where="url")


@dataclass(frozen=True)
class WantedFile:
    """A file to fetch."""

    url: str
    sha256: str | None
    """What it must hash to; None where the request does not say."""
    most_bytes: int


@dataclass(frozen=True)
class KnownFile(WantedFile):
    """A file of a transfer, and how far it is."""

    number: int
    """Its place among those of the request, from 0."""
    upload_id: str | None
    """None until its size is known."""
    tag: str
    """A strong ``ETag`` as it was when its first byte came; empty without one."""


@dataclass(frozen=True)
class TransferLease:
    """The right to fetch the files of a transfer, until it expires."""

    id: str
    fence: int
    owner: str
    files: tuple[KnownFile, ...]


@dataclass(frozen=True)
class TransferView:
    """A transfer as others may see it."""

    state: TransferState
    free: bool
    """Nobody fetches: the lease is over."""
    uploads: tuple[str, ...]
    """Those that there are, in the order of the files."""
    came: int
    """Bytes that are surely here."""
    size: int
    """Bytes of the files whose size is known."""
    failed: int
    """Number of the file that `error` is about."""
    error: BladeAtlasError | None


@dataclass(frozen=True)
class Transfers:
    """All transfers of one database."""

    db: Database
    lease_s: float = 30.0
    """A lease without a heartbeat ends after this."""

    def ask(self, transfer_id: str) -> list[str]:
        """Note that the request came again. Ends one that was over and not asked for in time; returns its uploads."""
        with self.db.write() as session:
            now = self.db.now(session)
            old = _end(session, (Transfer.id == transfer_id, *_forgotten(now)), now)
            changed(session, update(Transfer).where(Transfer.id == transfer_id).values(asked_at=now))
            return old

    def find(self, transfer_id: str) -> TransferView | None:
        """How far it is; None when there is none."""
        with self.db.read() as session:
            row = session.get(Transfer, transfer_id)
            if row is None:
                return None
            ids = tuple(file.upload_id for file in row.files if file.upload_id is not None)
            sums = select(func.sum(Upload.offset), func.sum(Upload.length)).where(Upload.id.in_(ids))
            came, size = session.execute(sums).one()
            ended = row.lease_expires_at is None or row.lease_expires_at <= self.db.now(session)
            return TransferView(
                state=row.state,
                free=row.state == TransferState.FETCHING and ended,
                uploads=ids,
                came=int(came or 0),
                size=int(size or 0),
                failed=row.failed or 0,
                error=None if row.error is None else _error(row.error),
            )

    def begin(self, transfer_id: str, owner: str, files: Sequence[WantedFile], holder: str) -> TransferLease | None:
        """Make a transfer and lease it; None when another process was faster."""
        with self.db.write() as session:
            now = self.db.now(session)
            values = {"id": transfer_id, "owner": owner, "state": TransferState.FETCHING, "holder": holder, "fence": 1}
            times = {"lease_expires_at": self._until(now), "created_at": now, "asked_at": now}
            statement = insert_into(session, Transfer).values(**values, **times).on_conflict_do_nothing()
            if session.scalar(statement.returning(Transfer.id)) is None:
                return None
            session.add_all(
                TransferFile(
                    transfer_id=transfer_id,
                    number=number,
                    url=one.url,
                    sha256=one.sha256,
                    most_bytes=one.most_bytes,
                    tag="",
                )
                for number, one in enumerate(files)
            )
            session.flush()
            return _lease(session, transfer_id)

    def take(self, transfer_id: str, holder: str) -> TransferLease | None:
        """Lease a transfer whose lease is over; None when there is none, or another process was faster."""
        with self.db.write() as session:
            now = self.db.now(session)
            where = (Transfer.id == transfer_id, Transfer.state == TransferState.FETCHING, _free(now))
            values = {"holder": holder, "fence": Transfer.fence + 1, "lease_expires_at": self._until(now)}
            if not changed(session, update(Transfer).where(*where).values(values)):
                return None
            return _lease(session, transfer_id)

    def renew(self, lease: TransferLease) -> bool:
        """Keep a lease; False when it was lost."""
        with self.db.write() as session:
            until = self._until(self.db.now(session))
            return changed(session, update(Transfer).where(*_held(lease)).values(lease_expires_at=until))

    def take_over(self, holder: str) -> None:
        """Free the leases of a holder that is known to be gone."""
        with self.db.write() as session:
            changed(session, update(Transfer).where(Transfer.holder == holder).values(lease_expires_at=None))

    def set_upload(self, session: Session, lease: TransferLease, number: int, upload_id: str, tag: str) -> int | None:
        """In the transaction that makes the upload of a file: write it down, and end the one that it replaces.

        Returns:
            Length of the upload that was replaced and still lived; None where there was none.

        Raises:
            TransferLost: another process fetches now.
        """
        now = self.db.now(session)
        if not changed(session, update(Transfer).where(*_held(lease)).values(lease_expires_at=self._until(now))):
            raise transfer_lost()
        file = session.get_one(TransferFile, (lease.id, number))
        before = None if file.upload_id is None else session.get(Upload, file.upload_id)
        file.upload_id, file.tag = upload_id, tag
        if before is None or before.removed_at is not None:
            return None
        before.removed_at = now
        session.flush()
        return before.length

    def set_tag(self, lease: TransferLease, number: int, tag: str) -> None:
        """Write down the tag of a file that begins anew in its upload.

        Raises:
            TransferLost: another process fetches now.
        """
        with self.db.write() as session:
            if session.scalar(select(Transfer.id).where(*_held(lease))) is None:
                raise transfer_lost()
            session.get_one(TransferFile, (lease.id, number)).tag = tag

    def finish(self, lease: TransferLease) -> bool:
        """All files are here; False when the lease was lost."""
        with self.db.write() as session:
            values = {"state": TransferState.FETCHED, "holder": None, "lease_expires_at": None}
            return changed(session, update(Transfer).where(*_held(lease)).values(values))

    def refuse(self, lease: TransferLease, number: int, error: BladeAtlasError) -> list[str]:
        """A file cannot be had: keep its error and end all uploads.

        Returns:
            Ids of these; none when the lease was lost.
        """
        with self.db.write() as session:
            values = {
                "state": TransferState.REFUSED,
                "holder": None,
                "lease_expires_at": None,
                "failed": number,
                "error": error.to_dict(),
            }
            if not changed(session, update(Transfer).where(*_held(lease)).values(values)):
                return []
            return _end_uploads(session, [lease.id], self.db.now(session))

    def end(self, transfer_id: str) -> list[str]:
        """What came of it is known to who asked: its uploads end, and are returned. One that is under way goes on."""
        with self.db.write() as session:
            over = (Transfer.id == transfer_id, Transfer.state != TransferState.FETCHING)
            return _end(session, over, self.db.now(session))

    def forget(self) -> int:
        """End all that nobody asked for in time and nobody fetches; returns how many uploads ended with them."""
        with self.db.write() as session:
            now = self.db.now(session)
            return len(_end(session, _forgotten(now), now))

    def _until(self, now: datetime) -> datetime:
        return now + timedelta(seconds=self.lease_s)


def _held(lease: TransferLease) -> tuple[ColumnElement[bool], ...]:
    """The condition under which a lease still counts."""
    return (Transfer.id == lease.id, Transfer.fence == lease.fence, Transfer.state == TransferState.FETCHING)


def _forgotten(now: datetime) -> tuple[ColumnElement[bool], ...]:
    return (Transfer.asked_at < now - timedelta(seconds=KEPT_S), _free(now))


def _free(now: datetime) -> ColumnElement[bool]:
    """Nobody holds a lease any more."""
    return or_(Transfer.lease_expires_at.is_(None), Transfer.lease_expires_at <= now)


def _end(session: Session, which: tuple[ColumnElement[bool], ...], now: datetime) -> list[str]:
    """Delete transfers and end their uploads, which are returned."""
    # Held from the question on: nobody takes one over while it ends.
    ids = session.scalars(select(Transfer.id).where(*which).with_for_update()).all()
    ended = _end_uploads(session, ids, now)
    session.execute(delete(Transfer).where(Transfer.id.in_(ids)), execution_options={"synchronize_session": False})
    return ended


def _end_uploads(session: Session, transfer_ids: Sequence[str], now: datetime) -> list[str]:
    query = select(TransferFile.upload_id).where(TransferFile.transfer_id.in_(transfer_ids))
    found = [one for one in session.scalars(query) if one is not None]
    living = (Upload.id.in_(found), Upload.removed_at.is_(None))
    session.execute(update(Upload).where(*living).values(removed_at=now))
    return found


def _lease(session: Session, transfer_id: str) -> TransferLease:
    row = session.get_one(Transfer, transfer_id, populate_existing=True)
    files = tuple(
        KnownFile(one.url, one.sha256, one.most_bytes, one.number, one.upload_id, one.tag) for one in row.files
    )
    return TransferLease(row.id, row.fence, row.owner, files)


def _error(data: Mapping[str, object]) -> BladeAtlasError:
    """The error that `refuse` kept."""
    kind = _OWN.get(str(data.get("kind")))
    if kind is None:
        return error_from_dict(data)
    return kind(str(data.get("message", "")), code=str(data.get("code", kind.code)), where=str(data.get("where", "")))
