"""Requests a minute, in all and of one account, over all servers of a database.

A server does not ask the database at every request: it sets some of the minute's requests aside in one transaction and
answers so many. So the limit is never passed, however many servers there are; each may leave up to a twentieth of it
unanswered. A minute is one of the database's clock: around its end twice the limit may come within 60 s.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime

from sqlalchemy.orm import Session

from store.account_models import RequestCount
from store.accounts import owner_limit
from store.admission import LimitReached
from store.db import Database
from store.settings import DeploymentSettings

_LOCK = 0x52415445
_PIECES = 20
"""A server sets aside this part of a limit at a time, or one request."""
_SETTING = "max_requests_per_minute"
_ALL = ""


@dataclass
class _Aside:
    """What this server may answer for one account until a moment of its own clock."""

    until: float
    left: int | None
    """None = no limit."""
    refused: str = ""
    """Name of the setting that leaves nothing more within this minute."""


@dataclass
class RequestRate:
    """Counts the requests of one server process."""

    db: Database
    settings: DeploymentSettings
    clock: Callable[[], float] = time.monotonic
    _aside: dict[str, _Aside] = field(default_factory=dict)
    _mutex: threading.Lock = field(default_factory=threading.Lock)

    def spend(self, owner: str) -> bool:
        """Count a request of an account; False when the database must be asked first: `spend_slowly`.

        Raises:
            LimitReached: the minute has no more.
        """
        with self._mutex:
            found = self._aside.get(owner)
            if found is None or found.until <= self.clock():
                return False
            if found.left is None:
                return True
            if found.left:
                found.left -= 1
                return True
            if found.refused:
                raise self._error(found)
            return False

    def spend_slowly(self, owner: str) -> None:
        """The same; sets requests aside when none are left. `LimitReached` as above."""
        while not self.spend(owner):
            aside = self._set_aside(owner)
            with self._mutex:
                # Another thread may have done so meanwhile: what it has left is not lost.
                before = self._aside.get(owner)
                if before is not None and before.until > self.clock() and before.left and aside.left is not None:
                    aside.left += before.left
                self._aside[owner] = aside

    def _set_aside(self, owner: str) -> _Aside:
        with self.db.read() as session:
            of_all, of_owner = getattr(self.settings, _SETTING), owner_limit(session, self.settings, owner, _SETTING)
            now = self.db.now(session)
        until = self.clock() + 60.0 - now.second - now.microsecond / 1e6
        limits = {key: limit for key, limit in ((_ALL, of_all), (owner, of_owner)) if limit}
        if not limits:
            return _Aside(until, None)
        with self.db.write() as session:
            self.db.lock(session, _LOCK)
            counts = {key: self._count(session, key, now) for key in limits}
            rest = {key: limit - counts[key].taken for key, limit in limits.items()}
            tightest = min(rest, key=lambda key: rest[key])
            if rest[tightest] <= 0:
                return _Aside(until, 0, _SETTING if tightest == _ALL else f"{_SETTING}_per_owner")
            size = min(rest[tightest], max(1, min(limits.values()) // _PIECES))
            for count in counts.values():
                count.taken += size
        return _Aside(until, size)

    def _count(self, session: Session, key: str, now: datetime) -> RequestCount:
        minute = now.replace(second=0, microsecond=0)
        found = session.get(RequestCount, (key, minute))
        if found is None:
            found = RequestCount(owner=key, minute=minute, taken=0)
            session.add(found)
        return found

    def _error(self, found: _Aside) -> LimitReached:
        whose = "" if found.refused == _SETTING else "_of_owner"
        seconds = max(1, round(found.until - self.clock() + 0.5))
        message = f"the requests of this minute are used up ({found.refused}); the next begins in {seconds} s"
        error = LimitReached(message, code=f"too_many_requests{whose}", where=found.refused)
        error.retry_after_s = seconds
        return error
