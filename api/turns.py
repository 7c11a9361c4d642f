"""Turns at something scarce: a few at a time, fair between owners, and nobody waits without an end."""

from __future__ import annotations

import asyncio
from collections import Counter, deque
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from http import HTTPStatus
from itertools import count

from api.problems import Refused

_RETRY_S = "15"


@dataclass
class Turns:
    """Next is, of the owners that wait, who has the fewest turns under way, then whose last one began first.

    For one event loop.
    """

    side_by_side: int
    max_waiting: int
    max_waiting_per_owner: int
    wait_s: float | None
    """Who got no turn after so many seconds is sent away; None: nobody is."""
    spare: int = 0
    """So many more run at once for owners that have none: turns may be long, and none of them can be taken back."""
    _running: Counter[str] = field(default_factory=Counter)
    _waiting: dict[str, deque[asyncio.Future[None]]] = field(default_factory=dict)
    _last: dict[str, int] = field(default_factory=dict)
    """Number of the last turn of every owner that has one or waits for one."""
    _numbers: Iterator[int] = field(default_factory=lambda: count(1))

    @asynccontextmanager
    async def turn(self, owner: str) -> AsyncIterator[None]:
        """Wait for a turn and hold it for the block.

        Raises:
            Refused: 429 or 503 as `require_room`, 503 when it took too long.
        """
        await self._take(owner)
        try:
            yield
        finally:
            self._give_back(owner)

    def require_room(self, owner: str) -> None:
        """Refuse who would have to wait where no more may wait: 429 for this owner's own fault, else 503."""
        if self._is_free(owner):
            return
        own = len(self._waiting.get(owner, ()))
        if own >= self.max_waiting_per_owner:
            limit = f"max_probes_waiting_per_owner is {self.max_waiting_per_owner}"
            detail = f"{own} requests of yours wait, and {limit}; try again later"
            raise _refused(HTTPStatus.TOO_MANY_REQUESTS, "too_many_probes_of_owner", detail)
        if self.waiting >= self.max_waiting:
            detail = f"{self.waiting} requests wait, and max_probes_waiting is {self.max_waiting}; try again later"
            raise _refused(HTTPStatus.SERVICE_UNAVAILABLE, "too_many_probes", detail)

    @property
    def waiting(self) -> int:
        """How many wait, of all owners."""
        return sum(map(len, self._waiting.values()))

    def _is_free(self, owner: str) -> bool:
        running = self._running.total()
        return running < self.side_by_side + (0 if owner in self._running else self.spare)

    async def _take(self, owner: str) -> None:
        if self._is_free(owner):
            self._begin(owner)
            return
        self.require_room(owner)
        mine: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        self._waiting.setdefault(owner, deque()).append(mine)
        try:
            async with asyncio.timeout(self.wait_s):
                await mine
        except BaseException as error:
            if mine.done() and not mine.cancelled():
                self._give_back(owner)  # the turn came in the moment in which the wait ended
            else:
                self._leave(owner, mine)
            if not isinstance(error, TimeoutError):
                raise
            detail = f"no turn came within {self.wait_s:g} s (probe_wait_seconds); try again later"
            raise _refused(HTTPStatus.SERVICE_UNAVAILABLE, "probe_wait", detail) from None

    def _begin(self, owner: str) -> None:
        self._running[owner] += 1
        self._last[owner] = next(self._numbers)

    def _leave(self, owner: str, mine: asyncio.Future[None]) -> None:
        """Take somebody out of the line, who may have been passed over already."""
        line = self._waiting.get(owner, deque())
        if mine in line:
            line.remove(mine)
        if not line:
            self._waiting.pop(owner, None)

    def _give_back(self, owner: str) -> None:
        """End a turn and begin the next."""
        self._running[owner] -= 1
        self._running = +self._running  # forgets owners without a turn
        while served := [name for name in self._waiting if self._is_free(name)]:
            following = min(served, key=lambda name: (self._running[name], self._last.get(name, 0)))
            mine = self._waiting[following].popleft()
            if not self._waiting[following]:
                del self._waiting[following]
            if not mine.done():  # one that was cancelled is about to leave
                self._begin(following)
                mine.set_result(None)
        self._last = {name: n for name, n in self._last.items() if name in self._running or name in self._waiting}


def _refused(status: HTTPStatus, code: str, detail: str) -> Refused:
    return Refused(status, code, detail, headers={"Retry-After": _RETRY_S})
