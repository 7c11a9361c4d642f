"""Threads for one kind of work, a few at a time, so that much of it leaves threads and time to the rest."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import TypeVar

import anyio

T = TypeVar("T")


class LimitedThreads:
    """Runs at most so many calls at a time; one limit per event loop."""

    def __init__(self, side_by_side: int) -> None:
        self._side_by_side = side_by_side
        self._limiter: anyio.CapacityLimiter | None = None
        self._loop: asyncio.AbstractEventLoop | None = None

    async def run(self, call: Callable[[], T]) -> T:
        """Run a call in a thread."""
        loop = asyncio.get_running_loop()
        if self._limiter is None or self._loop is not loop:
            self._limiter, self._loop = anyio.CapacityLimiter(self._side_by_side), loop
        return await anyio.to_thread.run_sync(call, limiter=self._limiter)
