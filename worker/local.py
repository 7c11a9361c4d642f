"""Local runners: threads that lease and run tasks until there is nothing left, or for ever in a server."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from core.errors import BladeAtlasError
from store.retry import retried_until
from worker.keeper import TICK_S, LeaseKeeper
from worker.runner import TaskRunner

T = TypeVar("T")


@dataclass
class LocalRunners:
    """`workers` threads that share one `TaskRunner`, and one that keeps their leases alive."""

    runner: TaskRunner
    owner: str
    """Name in leases; a number per thread is added."""
    workers: int
    heartbeat_s: float = 10.0
    inspection_id: str | None = None
    """Work on this inspection only, and stop when it is over; None = serve all, until stopped."""
    queues: Sequence[str] = ("cpu", "gpu")
    failure: BaseException | None = None
    """What ended a thread that should not have ended, e.g. a full disk under the database."""
    _woken: threading.Condition = field(default_factory=threading.Condition)
    _stop: threading.Event = field(default_factory=threading.Event)
    _threads: list[threading.Thread] = field(default_factory=list)

    def start(self) -> None:
        """Start all threads."""
        targets: list[Callable[[], None]] = [LeaseKeeper(self.runner, self.heartbeat_s, self._stop).run]
        targets += [partial(self._work, number) for number in range(self.workers)]
        for target in targets:
            thread = threading.Thread(target=self._guarded, args=(target,), daemon=True)
            self._threads.append(thread)
            thread.start()

    def join(self, is_over: Callable[[], bool]) -> None:
        """Wait until `is_over` or until a thread failed; then all threads have ended."""
        while not self._stop.is_set() and not self._retried(is_over):
            with self._woken:
                self._woken.wait(TICK_S)
        self.stop()

    def stop(self) -> None:
        """End running tasks, give their leases back, and wait for the threads; may be called again."""
        self.runner.interrupted.set()
        self._stop.set()
        self.wake()
        for thread in self._threads:
            thread.join()

    def wake(self) -> None:
        """Something may have become runnable."""
        with self._woken:
            self._woken.notify_all()

    def _guarded(self, target: Callable[[], None]) -> None:
        try:
            target()
        except BaseException as error:  # noqa: BLE001 - the border of a thread: kept for whoever waits
            self.failure = self.failure or error
            self._stop.set()
            self.runner.interrupted.set()
            self.wake()

    def _retried(self, call: Callable[[], T]) -> T:
        return retried_until(self._stop, self.runner.plan.db, call)

    def _work(self, number: int) -> None:
        plan = self.runner.plan
        while not self._stop.is_set():
            lease = self._retried(
                lambda: plan.lease(f"{self.owner}/{number}", inspection_id=self.inspection_id, queues=self.queues)
            )
            if lease is not None:
                self.runner.run(lease)
                self.wake()
                continue
            with self._woken:
                self._woken.wait(TICK_S)


def raise_failure(failure: BaseException | None) -> None:
    """Raise what ended a runner's thread, if anything did."""
    if isinstance(failure, BladeAtlasError):
        raise failure
    if failure is not None:
        raise BladeAtlasError(f"the runner stopped: {failure}", where="runner") from failure
