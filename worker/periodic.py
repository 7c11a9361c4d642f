"""Periodic tasks of a server, each in a thread of its own: at fixed intervals, and at once when nudged."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field

from store.json_log import logger

_log = logger("bladeatlas.chores")


@dataclass
class Periodic:
    """Calls `work` every `every_s` seconds; what it raises is logged, and the next round tries again."""

    name: str
    work: Callable[[], object]
    every_s: float
    _due: threading.Event = field(default_factory=threading.Event)
    _stopped: bool = False
    _thread: threading.Thread | None = None

    def start(self) -> None:
        """Begin with a round at once."""
        self._due.set()
        self._thread = threading.Thread(target=self._run, name=self.name, daemon=True)
        self._thread.start()

    def nudge(self) -> None:
        """There is something to do now."""
        self._due.set()

    def stop(self) -> None:
        """Let a round that is under way come to its end, then no more; may be called again."""
        self._stopped = True
        self._due.set()
        if self._thread is not None:
            self._thread.join()

    def _run(self) -> None:
        while True:
            self._due.wait(self.every_s)
            if self._stopped:
                return
            self._due.clear()
            try:
                self.work()
            except Exception as error:  # noqa: BLE001 - the next round may find that all is well
                # The names in the log are documented (docs/operations/stuck-jobs.md).
                _log.warning("chore_failed", chore=self.name, reason=f"{type(error).__name__}: {error}")
