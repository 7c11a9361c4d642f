"""Tables of accounts: whose things are, who calls in their name, what they may use, and what they did."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum

from sqlalchemy import BigInteger, ForeignKey, Index, String
from sqlalchemy.orm import Mapped, mapped_column

from store.columns import Base

DEFAULT_ACCOUNT = "default"
"""Id of the account that always exists: it has what is made without a key."""


class Scope(StrEnum):
    """What a key is good for. None includes another."""

    READ = "read"
    """See what the account has."""
    SUBMIT = "submit"
    """Upload, start inspections, and stop, retry and delete them."""
    REVIEW = "review"
    """Write review records."""
    MANAGE = "manage"
    """Make, rotate and revoke keys of the account, and delete all that it has."""
    ADMIN = "admin"
    """See and change all accounts and their keys, and read the audit log."""


USUAL_SCOPES = (Scope.READ, Scope.SUBMIT, Scope.REVIEW)
"""Scopes of a key that was made without saying which, and of those from before there were scopes."""


class Account(Base):
    """Who inspections, uploads and keys belong to.

    A limit that is empty is that of the deployment for one owner; see `store.settings`.
    """

    __tablename__ = "accounts"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    """Also the `owner` in rows of what the account has."""
    name: Mapped[str] = mapped_column(String(128))
    created_at: Mapped[datetime]
    closed_at: Mapped[datetime | None]
    """When all that it had was deleted; it gets no new keys then."""
    retention_days: Mapped[float | None]
    """Days until an inspection is removed, counted from its publication; 0 = never."""
    max_priority: Mapped[int]
    max_active: Mapped[int | None]
    max_open_uploads: Mapped[int | None]
    max_promised_bytes: Mapped[int | None] = mapped_column(BigInteger)
    max_kept_bytes: Mapped[int | None] = mapped_column(BigInteger)
    max_requests_per_minute: Mapped[int | None]
    link_secret: Mapped[str | None] = mapped_column(String(64))
    """What its signed links are made with, 256 random bits; None before the first, and after all were ended."""
    turn_at: Mapped[datetime | None]
    """When a task of the account was leased last; see `store.turns`."""


class ApiKey(Base):
    """Who may call. The key itself is shown once and never kept."""

    __tablename__ = "api_keys"

    id: Mapped[str] = mapped_column(String(64), primary_key=True)
    account_id: Mapped[str] = mapped_column(String(64), ForeignKey("accounts.id"), index=True)
    name: Mapped[str] = mapped_column(String(128))
    digest: Mapped[str] = mapped_column(String(64), unique=True)
    """SHA-256 of a key of 256 random bits: nothing to guess, so no salt and no slow hash."""
    scopes: Mapped[list[str]]
    """Values of `Scope`."""
    created_at: Mapped[datetime]
    expires_at: Mapped[datetime | None]
    revoked_at: Mapped[datetime | None]
    last_used_at: Mapped[datetime | None]
    """Right to a minute; not written at every request."""


class WebSession(Base):
    """A browser that showed a key once. What it holds is the cookie, of which the hash is kept."""

    __tablename__ = "sessions"

    digest: Mapped[str] = mapped_column(String(64), primary_key=True)
    """SHA-256 of 256 random bits."""
    key_id: Mapped[str] = mapped_column(String(64), ForeignKey("api_keys.id"), index=True)
    """Its session is good for what the key is good for, and as long as the key at most."""
    created_at: Mapped[datetime]
    expires_at: Mapped[datetime] = mapped_column(index=True)


class RequestCount(Base):
    """Requests that servers may answer within a minute of the clock; see `store.request_rate`."""

    __tablename__ = "request_counts"

    owner: Mapped[str] = mapped_column(String(64), primary_key=True)
    """Id of the account; empty for all together."""
    minute: Mapped[datetime] = mapped_column(primary_key=True)
    taken: Mapped[int]
    """Answered, or set aside by a server for those that it will be asked."""


class AuditEntry(Base):
    """A request that would change something, and what came of it; see `store.audit`."""

    __tablename__ = "audit"
    __table_args__ = (Index("ix_audit_account_id_id", "account_id", "id"), {"sqlite_autoincrement": True})

    id: Mapped[int] = mapped_column(primary_key=True)
    at: Mapped[datetime] = mapped_column(index=True)
    account_id: Mapped[str] = mapped_column(String(64))
    """Empty when nobody proved who asks."""
    key_id: Mapped[str] = mapped_column(String(64))
    """Empty without a key."""
    action: Mapped[str] = mapped_column(String(128))
    """Method and route, e.g. ``POST /v1/inspections/{inspection_id}/retry``; of a command, its words."""
    target: Mapped[str] = mapped_column(String(256))
    """Path of the request, without its query; what a command was about."""
    status: Mapped[int]
    """Of HTTP; 200 for a command that was carried out."""
    code: Mapped[str] = mapped_column(String(64))
    """Of the problem; empty when it was accepted."""
    request_id: Mapped[str] = mapped_column(String(64))
    times: Mapped[int]
    """Requests like this one that the row stands for, itself included."""
