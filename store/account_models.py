"""Tables of accounts: whose things are, who calls in their name, and what they may use."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum

from sqlalchemy import BigInteger, ForeignKey, String
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
    """Make, rotate and revoke keys of the account."""
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
