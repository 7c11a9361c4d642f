"""Keeps the leases of a runner alive, and tells its tasks when they must stop."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from store.retry import retried_until
from worker.runner import Held, TaskRunner

T = TypeVar("T")

TICK_S = 0.5
"""How soon a cancellation, the end of the plan or work of others is noticed."""


@dataclass
class LeaseKeeper:
    """Heartbeats for everything that one `TaskRunner` holds."""

    runner: TaskRunner
    heartbeat_s: float = 10.0
    stopped: threading.Event = field(default_factory=threading.Event)

    def run(self) -> None:
        """Heartbeats, expired leases of others, and word of cancellations, until stopped."""
        plan, next_beat = self.runner.plan, 0.0
        while not self.stopped.wait(TICK_S):
            held = list(self.runner.held.values())
            self._retried(partial(self._pass_on_cancellations, held))
            if time.monotonic() >= next_beat:
                next_beat = time.monotonic() + self.heartbeat_s
                self._retried(partial(self._beat, held))
                self._retried(plan.expire)

    def _retried(self, call: Callable[[], T]) -> T:
        return retried_until(self.stopped, self.runner.plan.db, call)

    def _pass_on_cancellations(self, held: Sequence[Held]) -> None:
        if held:
            stopping = self.runner.plan.cancelling({one.lease.inspection_id for one in held})
            for one in held:
                if one.lease.inspection_id in stopping:
                    one.stop = "cancelled"

    def _beat(self, held: Sequence[Held]) -> None:
        lost = self.runner.plan.heartbeat((one.lease, one.progress, one.message) for one in held)
        gone = {lease.task_id for lease in lost}
        for one in held:
            # A task that ended meanwhile is no longer held, and its lease is not lost but over.
            if one.lease.task_id in gone and self.runner.held.get(one.lease.task_id) is one:
                one.stop = "lost"
