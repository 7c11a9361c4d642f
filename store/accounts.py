"""Accounts: made, changed and listed. What an account has carries its id as `owner`."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from core.errors import BadInput
from store.account_models import Account
from store.db import Database
from store.settings import DeploymentSettings

HIGHEST_PRIORITY = 9
LIMITS = ("max_active", "max_open_uploads", "max_promised_bytes", "max_kept_bytes", "max_requests_per_minute")
"""Limits that hold in all and for one account."""
_ID = re.compile(r"[a-z0-9][a-z0-9-]{0,63}")
_RANGES: Mapping[str, tuple[int, int]] = {
    "retention_days": (0, 36_525),
    "max_priority": (0, HIGHEST_PRIORITY),
    "max_active": (1, 1 << 30),
    "max_open_uploads": (1, 1 << 30),
    "max_promised_bytes": (0, 1 << 60),
    "max_kept_bytes": (0, 1 << 60),
    "max_requests_per_minute": (0, 1 << 30),
}
"""Least and most of everything that can be set of an account; what 0 means is what it means in `store.settings`."""


@dataclass(frozen=True)
class AccountView:
    """An account with what is set of it; None where the deployment's setting for one owner holds."""

    id: str
    name: str
    created_at: datetime
    closed_at: datetime | None
    retention_days: float | None
    max_priority: int
    max_active: int | None
    max_open_uploads: int | None
    max_promised_bytes: int | None
    max_kept_bytes: int | None
    max_requests_per_minute: int | None


@dataclass(frozen=True)
class Accounts:
    """All accounts of one database."""

    db: Database

    def create(self, account_id: str, name: str = "", **limits: float | None) -> AccountView:
        """A new account.

        Args:
            account_id: up to 64 of a-z, 0-9 and -, not beginning with -; never given to another account again.
            name: free text; without one it is the id.
            limits: as `change`.

        Raises:
            BadInput: the id has another form or is taken, or a limit cannot be.
        """
        if not _ID.fullmatch(account_id):
            message = f"'{account_id}' is no id of an account: up to 64 of a-z, 0-9 and -, not beginning with -"
            raise BadInput(message, where="account")
        _require_limits(limits)
        with self.db.write() as session:
            if session.get(Account, account_id) is not None:
                raise BadInput(f"there is an account '{account_id}' already", code="conflict", where="account")
            row = Account(id=account_id, name=name or account_id, created_at=self.db.now(session))
            row.max_priority = HIGHEST_PRIORITY
            _set(row, limits)
            session.add(row)
        return _view(row)

    def change(self, account_id: str, name: str | None = None, **limits: float | None) -> AccountView:
        """Set the name or limits of an account; None brings the deployment's limit back.

        Raises:
            BadInput: there is no such account, it was closed, or a limit cannot be.
        """
        _require_limits(limits)
        with self.db.write() as session:
            row = open_account(session, account_id)
            row.name = row.name if name is None else name
            _set(row, limits)
        return _view(row)

    def get(self, account_id: str) -> AccountView:
        """One account; `BadInput` when there is none."""
        with self.db.read() as session:
            return _view(_found(session, account_id))

    def limits(self, account_id: str, settings: DeploymentSettings) -> dict[str, int]:
        """What an account may use, by the names of the deployment's settings, e.g. ``max_active_per_owner``."""
        with self.db.read() as session:
            return {f"{name}_per_owner": owner_limit(session, settings, account_id, name) for name in LIMITS}

    def retention_days(self, account_id: str, settings: DeploymentSettings) -> float:
        """Days until an inspection of the account is removed; 0 = never."""
        own = self.get(account_id).retention_days
        return settings.retention_days if own is None else own

    def all(self) -> list[AccountView]:
        """Every account, oldest first, those that were closed included."""
        with self.db.read() as session:
            return [_view(row) for row in session.scalars(select(Account).order_by(Account.created_at, Account.id))]


def open_account(session: Session, account_id: str) -> Account:
    """The row of an account that was not closed; `BadInput` for any other."""
    row = _found(session, account_id)
    if row.closed_at is not None:
        raise BadInput(f"the account '{account_id}' was closed", code="conflict", where="account")
    return row


def owner_limit(session: Session, settings: DeploymentSettings, owner: str, name: str) -> int:
    """What one account may use of something: its own value, or else the deployment's for one owner.

    Args:
        name: of the limit in all, e.g. ``max_active``; the deployment's for one owner is ``max_active_per_owner``.
    """
    account = session.get(Account, owner)
    own = None if account is None else getattr(account, name)
    return int(getattr(settings, f"{name}_per_owner") if own is None else own)


def _found(session: Session, account_id: str) -> Account:
    row = session.get(Account, account_id) if _ID.fullmatch(account_id) else None
    if row is None:
        raise BadInput(f"there is no account '{account_id}'", code="unknown_account", where="account")
    return row


def _require_limits(limits: Mapping[str, float | None]) -> None:
    for name, value in limits.items():
        least, most = _RANGES[name]
        if value is not None and not least <= value <= most:
            raise BadInput(f"{name} is {value:g}; it may be {least} to {most}", where=name)


def _set(row: Account, limits: Mapping[str, float | None]) -> None:
    for name, value in limits.items():
        setattr(row, name, HIGHEST_PRIORITY if name == "max_priority" and value is None else value)


def _view(row: Account) -> AccountView:
    values: dict[str, Any] = {name: getattr(row, name) for name in AccountView.__dataclass_fields__}
    return AccountView(**values)
