"""API keys: shown once, kept as a hash, compared in constant time, revocable.

A key reads ``ba_<id>_<secret>``: the id finds the row, the secret of 256 random bits proves it.
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
import threading
import time
import uuid
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime, timedelta

from sqlalchemy import or_, select, update

from core.errors import BadInput
from store.db import Database
from store.leasing import changed
from store.models import ApiKey

_FORM = re.compile(r"ba_([0-9a-f]{32})_[A-Za-z0-9_-]{43}")
_NOTE_USE_EVERY = timedelta(minutes=1)


@dataclass(frozen=True)
class KeyView:
    """A key as others may see it: never the key itself."""

    id: str
    name: str
    created_at: datetime
    revoked_at: datetime | None
    last_used_at: datetime | None


@dataclass(frozen=True)
class Keys:
    """All keys of one database."""

    db: Database

    def create(self, name: str) -> tuple[KeyView, str]:
        """A new key and its only showing."""
        key_id = uuid.uuid4().hex
        key = f"ba_{key_id}_{secrets.token_urlsafe(32)}"
        with self.db.write() as session:
            row = ApiKey(id=key_id, name=name, digest=_digest(key), created_at=self.db.now(session))
            session.add(row)
        return _view(row), key

    def revoke(self, key_id: str) -> None:
        """End a key; `BadInput` when there is none. A key that was revoked stays so."""
        with self.db.write() as session:
            row = session.get(ApiKey, key_id)
            if row is None:
                raise BadInput(f"there is no key '{key_id}'", where="key")
            row.revoked_at = row.revoked_at or self.db.now(session)

    def all(self) -> list[KeyView]:
        """Every key, oldest first."""
        with self.db.read() as session:
            return [_view(row) for row in session.scalars(select(ApiKey).order_by(ApiKey.created_at, ApiKey.id))]

    def valid(self) -> dict[str, str]:
        """Digest of every key that may be used, by id."""
        with self.db.read() as session:
            rows = session.execute(select(ApiKey.id, ApiKey.digest).where(ApiKey.revoked_at.is_(None)))
            return {key_id: digest for key_id, digest in rows}  # noqa: C416 - rows are not plain tuples

    def ever_made(self) -> bool:
        """True once there was a key. Revoked ones count: their rows stay, so a server never opens again."""
        with self.db.read() as session:
            return session.scalar(select(ApiKey.id).limit(1)) is not None

    def note_use(self, key_id: str) -> None:
        """Remember that a key was used, once a minute at most."""
        with self.db.write() as session:
            now = self.db.now(session)
            stale = or_(ApiKey.last_used_at.is_(None), ApiKey.last_used_at < now - _NOTE_USE_EVERY)
            changed(session, update(ApiKey).where(ApiKey.id == key_id, stale).values(last_used_at=now))


@dataclass
class KeyRing:
    """The valid keys, read again after `fresh_s` seconds: so long a revoked key may still work."""

    keys: Keys
    fresh_s: float = 1.0
    clock: Callable[[], float] = time.monotonic
    _valid: dict[str, str] = field(default_factory=dict)
    _ever_made: bool = True
    _read_at: float | None = None
    _noted_at: dict[str, float] = field(default_factory=dict)
    _mutex: threading.Lock = field(default_factory=threading.Lock)

    @property
    def fresh(self) -> bool:
        """True while the database need not be asked."""
        return self._read_at is not None and self.clock() - self._read_at < self.fresh_s

    def refresh(self) -> None:
        """Read the valid keys, unless somebody just did."""
        with self._mutex:
            if not self.fresh:
                self._ever_made = self.keys.ever_made()
                self._valid = self.keys.valid()
                self._read_at = self.clock()

    @property
    def ever_made(self) -> bool:
        """True once a key was made, whether or not it may still be used."""
        return self._ever_made

    def owner(self, key: str) -> str | None:
        """Id of the key that this text is; None for no valid one."""
        form = _FORM.fullmatch(key)
        # An unknown id is compared as well, so that the time says nothing about which ids exist.
        known = self._valid.get(form[1], "") if form else ""
        same = hmac.compare_digest(_digest(key), known or "0" * 64)
        return form[1] if form and known and same else None

    def unnoted(self, key_id: str) -> bool:
        """True once a minute: then the use of a key is worth writing down."""
        now = self.clock()
        if now - self._noted_at.get(key_id, float("-inf")) < _NOTE_USE_EVERY.total_seconds():
            return False
        self._noted_at[key_id] = now
        return True


def _digest(key: str) -> str:
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()


def _view(row: ApiKey) -> KeyView:
    return KeyView(row.id, row.name, row.created_at, row.revoked_at, row.last_used_at)
