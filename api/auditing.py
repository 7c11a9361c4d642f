"""Every request that would change something comes into the audit log, accepted or refused, before it is answered.

So no client ever holds an answer that the log does not know. What strangers send, and requests beyond an account's
limits, could fill a disk and keep the database busy: of these the first of a kind in a minute has a row, and the next
one says how many came since.
"""

from __future__ import annotations

import time
from collections.abc import Callable, MutableMapping
from dataclasses import dataclass, field, replace
from functools import partial
from http import HTTPStatus
from typing import Any

from sqlalchemy.exc import SQLAlchemyError

from api.auth import Caller
from api.prefix import own_path
from api.threads import LimitedThreads
from core.errors import BladeAtlasError
from store.audit import AuditLog, Deed
from store.json_log import logger

_WRITES = ("POST", "PUT", "PATCH", "DELETE")
"""Other methods change nothing: no route has one that is not known."""
_BELOW = "/v1/"
_EVERY_S = 60.0
_THREADS = 4
_log = logger("bladeatlas.audit")
_write = LimitedThreads(_THREADS).run
"""Not in the threads of all requests: writers wait for each other, and those who only ask would wait for them."""
_Kind = tuple[str, str, str, int, str]


@dataclass
class Auditor:
    """Writes for one application."""

    log: AuditLog
    clock: Callable[[], float] = time.monotonic
    _counted: dict[_Kind, tuple[float, int]] = field(default_factory=dict)
    """Moment of the last row of a kind, and how many came since."""

    def concerns(self, scope: MutableMapping[str, Any]) -> bool:
        """True for a request that would change something."""
        return scope["method"] in _WRITES and own_path(scope).startswith(_BELOW)

    async def note(self, scope: MutableMapping[str, Any], status: int) -> None:
        """Write down a request and its answer; where the database is away, into the server's log instead."""
        deed = self._in_turn(_deed(scope, status))
        if deed is None:
            return
        try:
            await _write(partial(self.log.write, deed))
        except (SQLAlchemyError, BladeAtlasError) as error:
            _log.error("not_written", error=type(error).__name__, **vars(deed))

    def _in_turn(self, deed: Deed) -> Deed | None:
        """The entry to write; None for one of many, which the next entry of its kind counts."""
        beyond = deed.status == HTTPStatus.TOO_MANY_REQUESTS
        if deed.status < HTTPStatus.BAD_REQUEST or (deed.account_id and not beyond):
            return deed
        kind = (deed.account_id, deed.key_id, deed.action, deed.status, deed.code)
        last, since = self._counted.get(kind, (float("-inf"), 0))
        if self.clock() - last < _EVERY_S:
            self._counted[kind] = (last, since + 1)
            return None
        self._counted[kind] = (self.clock(), 0)
        return replace(deed, times=since + 1)


def _deed(scope: MutableMapping[str, Any], status: int) -> Deed:
    state = scope["state"]
    who: Caller | None = state.get("caller")
    route = getattr(scope.get("route"), "path", "none")
    return Deed(
        account_id=who.owner if who else "",
        key_id=who.key_id if who else "",
        action=f"{scope['method']} {route}",
        target=own_path(scope),
        status=status,
        code=str(state.get("problem_code", "")),
        request_id=state["request_id"],
    )
