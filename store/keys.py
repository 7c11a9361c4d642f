"""API keys: shown once, kept as a hash, compared in constant time, with scopes, revocable.

A key reads ``ba_<id>_<secret>``: the id finds the row, the secret of 256 random bits proves it. A key belongs to an
account, and so does all that is made with it: keys come and go, and what the account has stays.
"""

from __future__ import annotations

import hashlib
import hmac
import re
import secrets
import threading
import time
import uuid
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta

from sqlalchemy import or_, select, update
from sqlalchemy.orm import Session

from core.errors import BadInput
from core.names import unknown_name
from store.account_models import DEFAULT_ACCOUNT, USUAL_SCOPES, ApiKey, Scope
from store.accounts import open_account
from store.db import Database
from store.leasing import changed

_FORM = re.compile(r"ba_([0-9a-f]{32})_[A-Za-z0-9_-]{43}")
_LONGEST = timedelta(days=36_525)
_NOTE_USE_EVERY = timedelta(minutes=1)
_FIRST_LOCK = 0x46495253
"""PostgreSQL advisory lock: of several that start together one makes the first key."""


@dataclass(frozen=True)
class KeyView:
    """A key as others may see it: never the key itself."""

    id: str
    account_id: str
    name: str
    scopes: tuple[Scope, ...]
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
    last_used_at: datetime | None

    def ended(self, now: datetime) -> str | None:
        """Why it may not be used any more; None while it may."""
        if self.revoked_at is not None:
            return "was revoked"
        return "has expired" if self.expires_at is not None and self.expires_at <= now else None


def parse_scopes(names: Collection[str]) -> tuple[Scope, ...]:
    """Scopes in the order of their declaration; `BadInput` for a name that is none, and when there is none at all."""
    known = [scope.value for scope in Scope]
    for name in names:
        if name not in known:
            raise BadInput(unknown_name("scope", name, known), where="scopes")
    if not names:
        raise BadInput(f"a key needs a scope: {', '.join(known)}", where="scopes")
    return tuple(scope for scope in Scope if scope in names)


@dataclass(frozen=True)
class Keys:
    """All keys of one database."""

    db: Database

    def create(
        self,
        name: str,
        account_id: str = DEFAULT_ACCOUNT,
        scopes: Collection[Scope] = USUAL_SCOPES,
        expires_at: datetime | None = None,
    ) -> tuple[KeyView, str]:
        """A new key of an account and its only showing.

        Raises:
            BadInput: there is no such account, it was closed, or the end of the key does not lie ahead.
        """
        with self.db.write() as session:
            return self._create_in(session, name, account_id, scopes, expires_at)

    def _create_in(
        self, session: Session, name: str, account_id: str, scopes: Collection[Scope], expires_at: datetime | None
    ) -> tuple[KeyView, str]:
        open_account(session, account_id)
        now = self.db.now(session)
        if expires_at is not None and not now < expires_at <= now + _LONGEST:
            raise BadInput("the end of a key must lie ahead, within 100 years", where="expires_at")
        key_id = uuid.uuid4().hex
        key = f"ba_{key_id}_{secrets.token_urlsafe(32)}"
        row = ApiKey(id=key_id, account_id=account_id, name=name, digest=_digest(key), created_at=now)
        row.scopes, row.expires_at = [scope.value for scope in Scope if scope in scopes], expires_at
        session.add(row)
        session.flush()
        return _view(row), key

    def create_first(self, name: str) -> tuple[KeyView, str] | None:
        """A key of the account `default` when there never was any key, and its only showing; else None."""
        with self.db.write() as session:
            self.db.lock(session, _FIRST_LOCK)
            if session.scalar(select(ApiKey.id).limit(1)) is not None:
                return None
            return self._create_in(session, name, DEFAULT_ACCOUNT, USUAL_SCOPES, None)

    def rotate(self, key_id: str, keep: timedelta = timedelta(0)) -> tuple[KeyView, str]:
        """A new key with the account, the name and the scopes of another, which ends after `keep`.

        A key that was to expire is followed by one that lives as long as it did.

        Raises:
            BadInput: there is no such key, or it has ended.
        """
        with self.db.write() as session:
            old, now = _found(session, key_id), self.db.now(session)
            view = _view(old)
            ended = view.ended(now)
            if ended is not None:
                raise BadInput(f"the key '{key_id}' {ended}", code="conflict", where="key")
            until = None if old.expires_at is None else now + (old.expires_at - old.created_at)
            made = self._create_in(session, old.name, old.account_id, view.scopes, until)
            if keep <= timedelta(0):
                old.revoked_at = now
            else:
                old.expires_at = min(now + keep, old.expires_at or now + keep)
        return made

    def revoke(self, key_id: str) -> KeyView:
        """End a key; `BadInput` when there is none. A key that was revoked stays so."""
        with self.db.write() as session:
            row = _found(session, key_id)
            row.revoked_at = row.revoked_at or self.db.now(session)
        return _view(row)

    def get(self, key_id: str) -> KeyView:
        """One key; `BadInput` when there is none."""
        with self.db.read() as session:
            return _view(_found(session, key_id))

    def all(self, account_id: str | None = None) -> list[KeyView]:
        """Every key, or those of an account, oldest first."""
        query = select(ApiKey).order_by(ApiKey.created_at, ApiKey.id)
        with self.db.read() as session:
            chosen = query if account_id is None else query.where(ApiKey.account_id == account_id)
            return [_view(row) for row in session.scalars(chosen)]

    def known(self) -> dict[str, tuple[str, KeyView]]:
        """Digest and view of every key that ever was, by id."""
        with self.db.read() as session:
            return {row.id: (row.digest, _view(row)) for row in session.scalars(select(ApiKey))}

    def any_valid(self) -> bool:
        """True while there is a key that may be used."""
        with self.db.read() as session:
            now = self.db.now(session)
            valid = (ApiKey.revoked_at.is_(None), or_(ApiKey.expires_at.is_(None), ApiKey.expires_at > now))
            return session.scalar(select(ApiKey.id).where(*valid).limit(1)) is not None

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
    """All keys, read again after `fresh_s` seconds: so long a revoked key may still work."""

    keys: Keys
    fresh_s: float = 1.0
    clock: Callable[[], float] = time.monotonic
    _known: Mapping[str, tuple[str, KeyView]] = field(default_factory=dict)
    _ever_made: bool = True
    _read_at: float | None = None
    _noted_at: dict[str, float] = field(default_factory=dict)
    _mutex: threading.Lock = field(default_factory=threading.Lock)

    @property
    def fresh(self) -> bool:
        """True while the database need not be asked."""
        return self._read_at is not None and self.clock() - self._read_at < self.fresh_s

    def refresh(self) -> None:
        """Read the keys, unless somebody just did."""
        with self._mutex:
            if not self.fresh:
                self._ever_made = self.keys.ever_made()
                self._known = self.keys.known()
                self._read_at = self.clock()

    def outdate(self) -> None:
        """Keys were changed by this process: the next request sees it."""
        self._read_at = None

    @property
    def ever_made(self) -> bool:
        """True once a key was made, whether or not it may still be used."""
        return self._ever_made

    def find(self, key: str) -> KeyView | None:
        """The key that this text is, ended or not; None when it is none that was ever made."""
        form = _FORM.fullmatch(key)
        # An unknown id is compared as well, so that the time says nothing about which ids exist.
        known = self._known.get(form[1]) if form else None
        same = hmac.compare_digest(_digest(key), known[0] if known else "0" * 64)
        return known[1] if known and same else None

    def by_id(self, key_id: str) -> KeyView | None:
        """The key of this id, ended or not."""
        known = self._known.get(key_id)
        return known[1] if known else None

    def unnoted(self, key_id: str) -> bool:
        """True once a minute: then the use of a key is worth writing down."""
        now = self.clock()
        if now - self._noted_at.get(key_id, float("-inf")) < _NOTE_USE_EVERY.total_seconds():
            return False
        self._noted_at[key_id] = now
        return True


def utc_now() -> datetime:
    """The time of this machine, with which the end of keys is compared."""
    return datetime.now(UTC)


def _found(session: Session, key_id: str) -> ApiKey:
    row = session.get(ApiKey, key_id)
    if row is None:
        raise BadInput(f"there is no key '{key_id}'", code="unknown_key", where="key")
    return row


def _digest(key: str) -> str:
    return hashlib.sha256(key.encode("utf-8", "surrogatepass")).hexdigest()


def _view(row: ApiKey) -> KeyView:
    return KeyView(
        id=row.id,
        account_id=row.account_id,
        name=row.name,
        scopes=parse_scopes(row.scopes),
        created_at=row.created_at,
        expires_at=row.expires_at,
        revoked_at=row.revoked_at,
        last_used_at=row.last_used_at,
    )
