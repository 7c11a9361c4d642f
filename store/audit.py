"""The audit log: who asked for which change, when, and what came of it. Nothing in it is secret.

Requests write into it through `api.auditing`, commands on the server's machine through `audited`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from datetime import datetime
from http import HTTPStatus

from sqlalchemy import select

from core.errors import BladeAtlasError
from store.account_models import AuditEntry
from store.cursors import decode_cursor, encode_cursor
from store.db import Database

_NAME = "audit"


@dataclass(frozen=True)
class Deed:
    """What was asked for, and the answer; texts are cut to what the table holds."""

    account_id: str
    """Empty when nobody proved who asks, and for commands on the server's machine."""
    key_id: str
    action: str
    target: str
    status: int
    code: str
    request_id: str
    times: int = 1


@dataclass(frozen=True)
class AuditView(Deed):
    """An entry of the log."""

    id: int = 0
    at: datetime = datetime.min


@dataclass(frozen=True)
class AuditFilter:
    """Which entries; empty fields do not choose."""

    account_id: str | None = None
    key_id: str | None = None
    since: datetime | None = None
    until: datetime | None = None


@dataclass(frozen=True)
class AuditPage:
    """Some entries and how to get the next."""

    entries: Sequence[AuditView]
    cursor: str | None


@dataclass(frozen=True)
class AuditLog:
    """The log of one database."""

    db: Database

    def write(self, deed: Deed) -> None:
        """Add an entry."""
        with self.db.write() as session:
            session.add(
                AuditEntry(
                    at=self.db.now(session),
                    account_id=deed.account_id[:64],
                    key_id=deed.key_id[:64],
                    action=deed.action[:128],
                    target=_printable(deed.target)[:256],
                    status=deed.status,
                    code=deed.code[:64],
                    request_id=deed.request_id[:64],
                    times=deed.times,
                )
            )

    def page(self, chosen: AuditFilter, limit: int, cursor: str | None = None) -> AuditPage:
        """Entries, newest first; `BadInput` for a cursor that is none of ours."""
        query = select(AuditEntry).order_by(AuditEntry.id.desc()).limit(limit + 1)
        if chosen.account_id is not None:
            query = query.where(AuditEntry.account_id == chosen.account_id)
        if chosen.key_id is not None:
            query = query.where(AuditEntry.key_id == chosen.key_id)
        if chosen.since is not None:
            query = query.where(AuditEntry.at >= chosen.since)
        if chosen.until is not None:
            query = query.where(AuditEntry.at < chosen.until)
        if cursor is not None:
            query = query.where(AuditEntry.id < decode_cursor(_NAME, (int,), cursor)[0])
        with self.db.read() as session:
            rows = [_view(row) for row in session.scalars(query)]
        more = len(rows) > limit
        return AuditPage(rows[:limit], encode_cursor(_NAME, (rows[limit - 1].id,)) if more else None)


@contextmanager
def audited(db: Database, command: str, target: str) -> Iterator[None]:
    """Write into the log what a command on the server's machine did, or why it was refused."""
    code = ""
    try:
        yield
    except BladeAtlasError as error:
        code = error.code
        raise
    finally:
        status = HTTPStatus.UNPROCESSABLE_ENTITY if code else HTTPStatus.OK
        AuditLog(db).write(Deed("", "", f"bladeatlas {command}", target, status, code, ""))


def _view(row: AuditEntry) -> AuditView:
    return AuditView(**{one.name: getattr(row, one.name) for one in fields(AuditView)})


def _printable(text: str) -> str:
    """Without characters that no database keeps or that a terminal would take for commands."""
    return "".join(c if c.isprintable() else "?" for c in text)
