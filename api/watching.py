"""Many clients ask about few inspections: one look at the database answers all who ask within the same moment."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import dataclass

from starlette.concurrency import run_in_threadpool

FRESH_S = 0.2
"""A look may be this old. A change that came through this process is seen at once: see `Watcher.invalidate`."""
POLL_S = 0.7
"""How often a waiting request looks."""
_REMEMBERED = 1000


@dataclass(frozen=True)
class Snapshot:
    """An inspection's resource as it was at one moment, ready to be sent."""

    owner: str
    deleted: bool
    active: bool
    body: bytes
    """JSON."""
    etag: str
    """Strong, quoted."""


class Watcher:
    """Shares looks between requests of one process."""

    def __init__(self, load: Callable[[str], Snapshot | None]) -> None:
        self._load = load
        self._known: dict[str, tuple[float, Snapshot]] = {}
        self._flights: dict[str, asyncio.Task[Snapshot | None]] = {}

    async def look(self, inspection_id: str) -> Snapshot | None:
        """The inspection as it is now; None when there is none."""
        read_at, snapshot = self._known.get(inspection_id, (float("-inf"), None))
        if snapshot is not None and time.monotonic() - read_at < FRESH_S:
            return snapshot
        flight = self._flights.get(inspection_id)
        if flight is None or flight.get_loop() is not asyncio.get_running_loop():
            flight = asyncio.create_task(self._fly(inspection_id))
            self._flights[inspection_id] = flight
        return await asyncio.shield(flight)  # one client that goes away must not take the answer from the others

    async def _fly(self, inspection_id: str) -> Snapshot | None:
        me = asyncio.current_task()
        try:
            snapshot = await run_in_threadpool(self._load, inspection_id)
            if snapshot is not None and self._flights.get(inspection_id) is me:
                self._keep(inspection_id, snapshot)
            return snapshot
        finally:
            if self._flights.get(inspection_id) is me:
                del self._flights[inspection_id]

    def _keep(self, inspection_id: str, snapshot: Snapshot) -> None:
        self._known.pop(inspection_id, None)
        self._known[inspection_id] = (time.monotonic(), snapshot)
        if len(self._known) > _REMEMBERED:
            del self._known[next(iter(self._known))]

    def invalidate(self, inspection_id: str) -> None:
        """Something changed it: looks that began before are not given to anybody new."""
        self._known.pop(inspection_id, None)
        self._flights.pop(inspection_id, None)

    async def wait(self, inspection_id: str, seconds: float, etag: str | None) -> Snapshot | None:
        """Look again and again until the resource differs from `etag` (without one: until it is over)."""
        deadline = time.monotonic() + seconds
        while True:
            snapshot = await self.look(inspection_id)
            if snapshot is None or snapshot.deleted or not snapshot.active:
                return snapshot
            if etag is not None and etag != snapshot.etag:
                return snapshot
            left = deadline - time.monotonic()
            if left <= 0:
                return snapshot
            await asyncio.sleep(min(POLL_S, left))
