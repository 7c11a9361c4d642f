"""Threads for one kind of work, a few at a time and in turn by account.

Much of such work then leaves threads and time to the rest, and much of one account to the others.
"""

from __future__ import annotations

import asyncio
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from contextvars import ContextVar
from typing import TypeVar

import anyio

from api.turns import Turns

T = TypeVar("T")

WHOSE: ContextVar[str] = ContextVar("WHOSE", default="")
"""The account that the present request is of, once it is known."""


class LimitedThreads:
    """Runs at most so many calls at a time, of each account in turn; one limit per event loop."""

    def __init__(self, side_by_side: int) -> None:
        self._side_by_side = side_by_side
        self._limiter: anyio.CapacityLimiter | None = None
        self._turns: Turns | None = None
        self._loop: asyncio.AbstractEventLoop | None = None

    async def run(self, call: Callable[[], T]) -> T:
        """Run a call in a thread."""
        loop = asyncio.get_running_loop()
        if self._limiter is None or self._turns is None or self._loop is not loop:
            self._limiter, self._loop = anyio.CapacityLimiter(self._side_by_side), loop
            self._turns = Turns(self._side_by_side, sys.maxsize, sys.maxsize, None)
        async with self._turns.turn(WHOSE.get()):
            return await anyio.to_thread.run_sync(call, limiter=self._limiter)


async def in_daemon_thread(call: Callable[[], T]) -> T:
    """Run a call that may take long in a thread of its own, which does not keep the process from ending."""
    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def settle(value: T | None, error: BaseException | None) -> None:
        if future.done():  # nobody waits any more
            return
        if error is not None:
            future.set_exception(error)
        else:
            future.set_result(value)  # type: ignore[arg-type]  # without an error it is what the call returned

    def run() -> None:
        value, failed = None, None
        try:
            value = call()
        except BaseException as error:  # noqa: BLE001 - the border of a thread: raised again where it is awaited
            failed = error
        with suppress(RuntimeError):  # the loop was closed
            loop.call_soon_threadsafe(settle, value, failed)

    threading.Thread(target=run, daemon=True).start()
    return await future
