"""Runners that ask the database for work by themselves: inside a server, or in a worker without a broker."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field

from store.json_log import logger
from worker.local import LocalRunners
from worker.service import WorkerService

_log = logger("bladeatlas.runners")
_PAUSE_S = 5.0


@dataclass
class PollingRunners:
    """Local runners that are started again whenever something stops them, e.g. a full disk."""

    service: WorkerService
    workers: int
    _current: LocalRunners | None = None
    _stopped: threading.Event = field(default_factory=threading.Event)
    _thread: threading.Thread | None = None

    def start(self) -> None:
        """Run until stopped, in a thread."""
        self._thread = threading.Thread(target=self._supervise, name="runners", daemon=True)
        self._thread.start()

    def wake(self) -> None:
        """Something may have become runnable."""
        current = self._current
        if current is not None:
            current.wake()

    def stop(self) -> None:
        """End running tasks and give their leases back; may be called again."""
        self._stopped.set()
        self.wake()
        if self._thread is not None:
            self._thread.join()

    def _supervise(self) -> None:
        settings = self.service.settings
        while not self._stopped.is_set():
            self._current = LocalRunners(
                self.service.runner(),
                self.service.name,
                self.workers,
                settings.heartbeat_s,
                queues=self.service.queues,
            )
            self._current.start()
            self._current.join(self._stopped.is_set)
            if self._current.failure is not None:
                _log.error("runners_stopped", reason=str(self._current.failure))
                self._stopped.wait(_PAUSE_S)
