"""Admission: limits on active inspections, open uploads, promised and kept bytes; requests that have one effect.

Each limit holds in all and for one account, whose own value wins over that of the deployment. It is asked for and
used up in one transaction, and such transactions follow one another, in one process or in many. What a request needs
before it has a row of its own it holds as a reservation, which ends with the request, or by its time when the process
was killed.

An idempotency key is written in the transaction that creates the inspection, so a crash leaves either both or
neither, and of two equal requests at once the database lets one through; the other finds what it made.
"""

from __future__ import annotations

import shutil
import uuid
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import ColumnElement, delete, func, or_, select
from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import InstrumentedAttribute, Session

from core.errors import BadInput, BladeAtlasError, DiskFull
from store.accounts import owner_limit
from store.db import Database
from store.models import ACTIVE_INSPECTION, IdempotencyKey, Inspection, Reservation, ReservationKind, Upload
from store.settings import DeploymentSettings

_LOCK = 0x41444D49
_PLACE_S = 900.0
_FORM_S = 180.0
"""A form's reservation is renewed more often than this while its client is heard of."""


class LimitReached(BladeAtlasError):
    """As much is under way, or kept, as the service takes, in all or of one owner; `where` names the setting."""

    code = "limit_reached"
    retryable = True
    retry_after_s: int | None = None
    """When it is known to be over."""


@dataclass(frozen=True)
class Admission:
    """The limits of a deployment over one database."""

    db: Database
    settings: DeploymentSettings

    def look(self, owner: str) -> None:
        """`LimitReached` when no inspection could begin now. Promises nothing: saves work that would be refused."""
        with self.db.read() as session:
            self._require_place(session, owner, 0, self.db.now(session))

    @contextmanager
    def place(self, owner: str, input_bytes: int = 0) -> Iterator[Place]:
        """A place among the active inspections, given back unless it is used.

        Args:
            owner: id of the account.
            input_bytes: size of the files that the inspection will keep, beside those that it has.

        Raises:
            LimitReached: there is no place, or more would be kept than may be.
        """
        with self.db.write() as session:
            self._require_place(session, owner, input_bytes, self._begin(session))
            held = self._reserve(session, owner, ReservationKind.INSPECTION, input_bytes, _PLACE_S)
        try:
            yield Place(self, owner, held, input_bytes)
        finally:
            self._end(held)

    def admit_upload(self, session: Session, owner: str, size: int) -> None:
        """Let an upload of `size` bytes begin in this transaction.

        Raises:
            LimitReached: too many uploads are open, or too many bytes are promised or kept.
            DiskFull: with what was promised before, the bytes would eat into the reserve.
        """
        now = self._begin(session)
        self._require(session, owner, ReservationKind.UPLOAD, now)
        self.require_bytes(session, owner, size, now)

    def look_upload(self, owner: str) -> None:
        """`LimitReached` when no upload could begin now. Promises nothing: saves the turn to write of a refusal."""
        with self.db.read() as session:
            self._require(session, owner, ReservationKind.UPLOAD, self.db.now(session))

    def promise_form(self, owner: str, size: int) -> FormPromise:
        """Promise a form of `size` bytes that is about to come in; it counts as an open upload until its end.

        Raises:
            LimitReached, DiskFull: as `admit_upload`.
        """
        self.look_upload(owner)
        with self.db.write() as session:
            self.admit_upload(session, owner, size)
            held = self._reserve(session, owner, ReservationKind.UPLOAD, size, _FORM_S)
        return FormPromise(self, owner, held)

    def require_bytes(self, session: Session, owner: str, size: int, now: datetime) -> None:
        """Let `size` more bytes be promised to an owner.

        Raises:
            LimitReached: with what is promised, or kept, it is more than may be.
            DiskFull: with all that is promised and not yet written it would reach the reserve.
        """
        promised, own = _promised(session, owner, now)
        self._require_sum(session, owner, "max_promised_bytes", "promised", (promised, own), size)
        self._require_kept(session, owner, size, now)
        free = shutil.disk_usage(self.settings.folder("")).free
        if free - promised - size < self.settings.reserve_bytes:
            message = (
                "the disk has no room for this beside its reserve (reserve_bytes) and what other uploads will need"
            )
            raise DiskFull(message, where="disk")

    def _begin(self, session: Session) -> datetime:
        """One such transaction after the other; returns the time."""
        self.db.lock(session, _LOCK)
        return self.db.now(session)

    def _require_place(self, session: Session, owner: str, input_bytes: int, now: datetime) -> None:
        """`LimitReached` unless one more inspection may be active and so many bytes may be kept for it."""
        self._require(session, owner, ReservationKind.INSPECTION, now)
        self._require_kept(session, owner, input_bytes, now)

    def _require_kept(self, session: Session, owner: str, size: int, now: datetime) -> None:
        """`LimitReached` when `size` more bytes, with those that are promised, are more than may be kept."""
        if any(self._allowed(session, owner, "max_kept_bytes")):  # else nobody need add up what is kept
            kept, promised = _kept(session, owner, now), _promised(session, owner, now)
            used = (kept[0] + promised[0], kept[1] + promised[1])
            self._require_sum(session, owner, "max_kept_bytes", "kept", used, size)

    def _require_sum(
        self, session: Session, owner: str, setting: str, what: str, used: tuple[int, int], size: int
    ) -> None:
        """`LimitReached` when `size` bytes are more than a limit leaves, in all or of this owner; 0 = no limit."""
        of_all, of_owner = self._allowed(session, owner, setting)
        for had, allowed, name, whose, suffix in (
            (used[0], of_all, setting, "", ""),
            (used[1], of_owner, f"{setting}_per_owner", " for you", "_of_owner"),
        ):
            if allowed and had + size > allowed:
                message = f"{had} bytes are {what}{whose} already, {size} are asked for, and {name} is {allowed}"
                raise LimitReached(message, code=f"too_many_{what}_bytes{suffix}", where=name)

    def _allowed(self, session: Session, owner: str, setting: str) -> tuple[int, int]:
        """A limit in all, and of this owner."""
        return int(getattr(self.settings, setting)), owner_limit(session, self.settings, owner, setting)

    def _require(self, session: Session, owner: str, kind: ReservationKind, now: datetime) -> None:
        """`LimitReached` unless one more fits, in all and of this owner; names the limit."""
        limit = _LIMITS[kind]
        rows = _count(session, owner, limit.owner, *limit.open_rows(now))
        held = _count(session, owner, Reservation.owner, *_reserved(kind, now))
        of_all, of_owner = self._allowed(session, owner, limit.setting)
        for used, allowed, name, whose, suffix in (
            (rows[0] + held[0], of_all, limit.setting, "", ""),
            (rows[1] + held[1], of_owner, f"{limit.setting}_per_owner", " of yours", "_of_owner"),
        ):
            if used >= allowed:
                message = f"{used} {limit.what}{whose} already, and {name} is {allowed}; try again later"
                raise LimitReached(message, code=limit.code + suffix, where=name)

    def _reserve(self, session: Session, owner: str, kind: ReservationKind, size: int, seconds: float) -> str:
        held = uuid.uuid4().hex
        expires_at = self.db.now(session) + timedelta(seconds=seconds)
        session.add(Reservation(id=held, owner=owner, kind=kind, bytes=size, expires_at=expires_at))
        return held

    def _end(self, held: str) -> None:
        """Give a reservation back; where the database is away, its time ends it."""
        with suppress(SQLAlchemyError), self.db.write() as session:
            session.execute(delete(Reservation).where(Reservation.id == held))


@dataclass(frozen=True)
class Place:
    """A place among the active inspections that is held."""

    admission: Admission
    owner: str
    held: str
    input_bytes: int

    def use(self, session: Session) -> None:
        """Give it up for the inspection that becomes active in this transaction.

        Raises:
            LimitReached: its time had ended, and no other is left.
        """
        now = self.admission._begin(session)
        kept = session.get(Reservation, self.held)
        if kept is None or kept.expires_at <= now:
            self.admission._require_place(session, self.owner, self.input_bytes, now)
        if kept is not None:
            session.delete(kept)
            session.flush()


@dataclass(frozen=True)
class FormPromise:
    """The promised bytes of a form that comes in."""

    admission: Admission
    owner: str
    held: str

    def keep(self, left: int) -> None:
        """So many bytes are still to come; the promise lives on.

        Raises:
            LimitReached, DiskFull: it is more than was promised (a form need not say its length), and may not be.
        """
        with self.admission.db.write() as session:
            now = self.admission._begin(session)
            kept = session.get(Reservation, self.held)
            before = kept.bytes if kept is not None and kept.expires_at > now else 0
            if left > before:
                self.admission.require_bytes(session, self.owner, left - before, now)
            renewed = Reservation(id=self.held, owner=self.owner, kind=ReservationKind.UPLOAD, bytes=left)
            renewed.expires_at = now + timedelta(seconds=_FORM_S)
            session.merge(renewed)

    def end(self) -> None:
        """All bytes are written, or none will come."""
        self.admission._end(self.held)


def _open_uploads(now: datetime) -> tuple[ColumnElement[bool], ...]:
    """Uploads that are not whole; an empty one is whole at once and counts as long as it is kept."""
    unfinished = or_(Upload.offset < Upload.length, Upload.length == 0)
    return (Upload.removed_at.is_(None), Upload.expires_at > now, unfinished)


def _reserved(kind: ReservationKind, now: datetime) -> tuple[ColumnElement[bool], ...]:
    return (Reservation.kind == kind, Reservation.expires_at > now)


@dataclass(frozen=True)
class _Limit:
    """How many of something may be open at once, in all and of one owner."""

    setting: str
    """Of all, and of an account; the deployment's of one owner is named ``<setting>_per_owner``."""
    code: str
    what: str
    owner: InstrumentedAttribute[str]
    open_rows: Callable[[datetime], tuple[ColumnElement[bool], ...]]


_LIMITS: Mapping[ReservationKind, _Limit] = {
    ReservationKind.INSPECTION: _Limit(
        "max_active",
        "too_many_active",
        "inspections are queued or running",
        Inspection.owner,
        lambda _now: (Inspection.state.in_(ACTIVE_INSPECTION),),
    ),
    ReservationKind.UPLOAD: _Limit(
        "max_open_uploads",
        "too_many_uploads",
        "uploads are open",
        Upload.owner,
        _open_uploads,
    ),
}


def _count(
    session: Session, owner: str, column: InstrumentedAttribute[Any], *where: ColumnElement[bool]
) -> tuple[int, int]:
    """Rows of all and of this owner."""
    row = session.execute(select(func.count(), func.count().filter(column == owner)).where(*where)).one()
    return int(row[0]), int(row[1])


def _promised(session: Session, owner: str, now: datetime) -> tuple[int, int]:
    """Bytes that open uploads and forms may still send: of all and of this owner."""
    rest = _sum(session, owner, Upload.owner, Upload.length - Upload.offset, *_open_uploads(now))
    forms = _sum(session, owner, Reservation.owner, Reservation.bytes, *_reserved(ReservationKind.UPLOAD, now))
    return rest[0] + forms[0], rest[1] + forms[1]


def _kept(session: Session, owner: str, now: datetime) -> tuple[int, int]:
    """Bytes of uploads, of inputs and of published files: of all and of this owner."""
    whole = Inspection.input_bytes + Inspection.published_bytes
    parts = (
        _sum(session, owner, Upload.owner, Upload.offset, Upload.removed_at.is_(None)),
        _sum(session, owner, Inspection.owner, whole, Inspection.deleted_at.is_(None)),
        _sum(session, owner, Reservation.owner, Reservation.bytes, *_reserved(ReservationKind.INSPECTION, now)),
    )
    return sum(part[0] for part in parts), sum(part[1] for part in parts)


def _sum(
    session: Session,
    owner: str,
    column: InstrumentedAttribute[Any],
    amount: ColumnElement[int] | InstrumentedAttribute[int],
    *where: ColumnElement[bool],
) -> tuple[int, int]:
    """The amount over rows of all and of this owner."""
    row = session.execute(select(func.sum(amount), func.sum(amount).filter(column == owner)).where(*where)).one()
    return int(row[0] or 0), int(row[1] or 0)


class OtherBody(BadInput):
    """The key was used with another body."""

    code = "idempotency_key_reused"


@dataclass(frozen=True)
class IdempotencyKeys:
    """Keys of all owners."""

    db: Database

    def find(self, owner: str, key: str, body_sha256: str) -> str | None:
        """Inspection that this request made before; None when it is new.

        Raises:
            OtherBody: the key belongs to a request with another body.
        """
        with self.db.read() as session:
            row = session.get(IdempotencyKey, (owner, key))
        if row is None:
            return None
        if row.body_sha256 != body_sha256:
            raise OtherBody("this Idempotency-Key was used with another body", where="Idempotency-Key")
        return row.inspection_id

    def add(self, session: Session, owner: str, key: str, body_sha256: str, inspection_id: str) -> None:
        """Write the key inside the transaction that creates the inspection; IntegrityError when it is there."""
        row = IdempotencyKey(owner=owner, key=key, body_sha256=body_sha256, inspection_id=inspection_id)
        row.created_at = self.db.now(session)
        session.add(row)
        session.flush()
