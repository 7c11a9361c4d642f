"""Sessions of browsers: a key is shown once, and a cookie is good for what it is good for, for a while.

A session lives in the database, so every server knows it, and it ends with its key, by its time, or when it is ended.
"""

from __future__ import annotations

import hashlib
import secrets
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import delete

from core.errors import BadInput
from store.account_models import ApiKey, WebSession
from store.db import Database

SESSION_LENGTH = timedelta(hours=12)


@dataclass(frozen=True)
class WebSessions:
    """All sessions of one database."""

    db: Database

    def begin(self, key_id: str) -> tuple[str, datetime]:
        """A new session of a key: what the cookie holds, which is not kept, and when it ends.

        Raises:
            BadInput: there is no such key.
        """
        cookie = secrets.token_urlsafe(32)
        with self.db.write() as session:
            key, now = session.get(ApiKey, key_id), self.db.now(session)
            if key is None:
                raise BadInput(f"there is no key '{key_id}'", code="unknown_key", where="key")
            until = now + SESSION_LENGTH
            if key.expires_at is not None:
                until = min(until, key.expires_at)
            session.add(WebSession(digest=_digest(cookie), key_id=key_id, created_at=now, expires_at=until))
        return cookie, until

    def find(self, cookie: str) -> str | None:
        """Id of the key of a session; None for one that is over or never was. Whether the key is valid is not asked."""
        with self.db.read() as session:
            row = session.get(WebSession, _digest(cookie))
            return row.key_id if row is not None and row.expires_at > self.db.now(session) else None

    def end(self, cookie: str) -> None:
        """End a session; one that is over stays so."""
        with self.db.write() as session:
            session.execute(delete(WebSession).where(WebSession.digest == _digest(cookie)))


def _digest(cookie: str) -> str:
    return hashlib.sha256(cookie.encode("utf-8", "surrogatepass")).hexdigest()
