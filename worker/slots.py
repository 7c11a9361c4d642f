"""How many tasks a worker runs side by side, whether a message or its own look into the plan brought them."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence

from store.json_log import logger

_log = logger("bladeatlas.worker")
_TICK_S = 0.5


class Slots:
    """A message starts work at once; a worker that has heard none for a while asks the plan by itself.

    A broker may stop delivering without saying so: after a restart of Redis in the moment of an acknowledgement,
    Celery counts that message for ever and asks for no other. The plan is the truth, so the worker need not know why.
    """

    def __init__(
        self, count: int, run_next: Callable[[Sequence[str]], bool], stopped: threading.Event, quiet_s: float
    ) -> None:
        """Make `count` slots.

        Args:
            run_next: leases the next task of some queues and runs it to its end; False when there was none.
            stopped: set when nothing more may start.
            quiet_s: so long without a message, and the worker asks by itself.
        """
        self._free = threading.Semaphore(count)
        self._run_next = run_next
        self._stopped = stopped
        self._quiet_s = quiet_s
        self._last_message = time.monotonic()

    def on_message(self, queue: str) -> None:
        """Run the next task of a queue, as soon as a slot is free."""
        self._last_message = time.monotonic()
        while not self._free.acquire(timeout=_TICK_S):
            if self._stopped.is_set():
                return
        try:
            self._run_next((queue,))
        finally:
            self._free.release()

    def without_message(self, queues: Sequence[str]) -> None:
        """Run tasks of the queues for as long as there are some, a slot is free and no message comes."""
        while self._is_quiet() and self._free.acquire(blocking=False):
            try:
                if not self._run_next(queues):
                    return
                _log.warning("ran_without_message", queues=list(queues))
            finally:
                self._free.release()

    def _is_quiet(self) -> bool:
        return not self._stopped.is_set() and time.monotonic() - self._last_message >= self._quiet_s
