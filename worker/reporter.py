"""From what runners do to the events that a caller sees; one call at a time, whichever thread it comes from."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from core.errors import BladeAtlasError
from core.states import AttemptOutcome
from store.records import Lease, TaskView
from worker.outcome import Event, EventKind, OnEvent
from worker.tracker import Tracker


@dataclass
class Reporter:
    """The observer of a local run."""

    tracker: Tracker
    tasks: Callable[[], Sequence[TaskView]]
    """Reads the plan as it stands."""
    on_event: OnEvent | None
    computed: int = 0
    """Tasks that ran and were accepted."""
    _mutex: threading.RLock = field(default_factory=threading.RLock)

    def opened(self) -> None:
        """The plan is in order; what is finished already is told at once."""
        with self._mutex:
            ended = self.tracker.refresh(self.tasks())
            self.tell("opened")
            self._send(ended)

    def started(self, lease: Lease) -> None:
        """A runner took a task."""
        with self._mutex:
            self.tracker.running(lease.key, 0.0)
            self.tell("started", lease.key)

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        """A running task reports."""
        with self._mutex:
            self.tracker.running(lease.key, fraction)
            self.tell("progress", lease.key, message)

    def ended(self, lease: Lease, outcome: AttemptOutcome, error: BladeAtlasError | None) -> None:
        """A runner is through with a task; others may have ended with it (reused, skipped)."""
        with self._mutex:
            self.computed += outcome == AttemptOutcome.SUCCEEDED
            self.tracker.idle(lease.key)
            ended = self.tracker.refresh(self.tasks())
            if outcome == AttemptOutcome.RETRIED:
                self.tell("retry", lease.key, error.message if error else "")
            self._send(ended)

    def tell(self, kind: EventKind, key: str = "", message: str = "", state: str = "") -> None:
        """Send an event of this moment."""
        with self._mutex:
            self._send([self.tracker.event(kind, key, message, state)])

    def _send(self, events: Sequence[Event]) -> None:
        if self.on_event is not None:
            for event in events:
                self.on_event(event)
