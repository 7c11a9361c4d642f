"""Bytes of a form that are still to come: promised before the first is read, kept up to date, given back at the end."""

from __future__ import annotations

import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial

from api.receiving import on_disk
from store.admission import Admission, FormPromise

_STEP_BYTES = 64 << 20
_STEP_S = 10.0
"""The promise is brought up to date after so many bytes or so long; a form without a length promises in these steps."""


@dataclass
class Promise:
    """The promise of one form while it comes in."""

    held: FormPromise
    size: int
    """Announced; grows with a form that did not say its length."""
    came: int = 0
    _kept_at: float = field(default_factory=time.monotonic)
    _kept: int = 0

    async def arrived(self, more: int) -> None:
        """So many bytes were written; `DiskFull` when there is no room for more than was announced."""
        self.came += more
        beyond = self.came > self.size
        if beyond:
            self.size = self.came + _STEP_BYTES
        if beyond or self.came - self._kept >= _STEP_BYTES or time.monotonic() - self._kept_at >= _STEP_S:
            await on_disk(partial(self.held.keep, self.size - self.came))
            self._kept, self._kept_at = self.came, time.monotonic()


@asynccontextmanager
async def promised(admission: Admission, owner: str, size: int) -> AsyncIterator[Promise]:
    """Promise the bytes of a form for the block.

    Raises:
        LimitReached: too many uploads are open.
        DiskFull: there is no room.
    """
    held = await on_disk(partial(admission.promise_form, owner, size))
    try:
        yield Promise(held, size)
    finally:
        await on_disk(held.end)
