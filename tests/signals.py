"""Signals for processes that tests start."""

from __future__ import annotations

import signal


def heed_interrupts() -> None:
    """A shell lets its background jobs ignore SIGINT, and children inherit that: here it must arrive."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)
