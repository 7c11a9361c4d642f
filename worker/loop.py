"""The loops that run tasks: threads that ask the plan, those of a server that outlive failures, and a server's service.

Local runs use `LocalRunners` until nothing is left. `WorkerService` is what every process that runs tasks for a server
consists of, whether a queue feeds it or it asks by itself.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import TypeVar

from core.confinement import NetworkGuard, hide_memory, possible_guard
from core.errors import BladeAtlasError
from core.states import AttemptOutcome, Queue
from store.db import Database
from store.files import ArtifactStore, LocalInputs
from store.graph import Graph
from store.housekeeping import Retention
from store.inspections import Inspections
from store.json_log import logger
from store.monitoring import WorkerRegistry
from store.plan import Plan
from store.publishing import Publishing
from store.records import Lease
from store.retry import retried_until
from store.settings import DeploymentSettings
from worker.cleaner import Cleaner
from worker.limits import TaskLimits
from worker.logs import TaskLogs
from worker.mirror import open_results
from worker.periodic import Periodic
from worker.publish import Publisher
from worker.runner import TICK_S, Heartbeat, TaskRunner, ids
from worker.webhooks import webhook_sender

_task_log = logger("bladeatlas.tasks")
_runners_log = logger("bladeatlas.runners")
_children_log = logger("bladeatlas.children")
T = TypeVar("T")
_TICK_S = 0.5
_AFTER_FAILURE_S = 5.0
"""Until runners that something stopped are started again."""
_CLEAN_EVERY = 6
"""Rounds of the sweeper between two of the cleaner, which lists whole folders."""
_SEND_PER_SWEEP = 5
"""Looks for events to send in the time of one round of the sweeper."""
_SENDERS = 2
"""Threads that send to webhooks, so that one slow receiver does not stop all others."""


class ConcurrencyLimit:
    """How many tasks a worker runs side by side, whether a message or its own look into the plan brought them.

    A message starts its task at once; a worker that has heard none for a while asks the plan by itself.

    A broker may stop delivering without saying so: after a restart of Redis in the moment of an acknowledgement,
    Celery counts that message for ever and asks for no other. The plan is the truth, so the worker need not know why.
    """

    def __init__(self, count: int, stopped: threading.Event, quiet_s: float) -> None:
        """Let `count` tasks run side by side.

        Args:
            count: at most so many.
            stopped: set when nothing more may start.
            quiet_s: so long without a message, and the worker asks by itself.
        """
        self._free = threading.Semaphore(count)
        self._stopped = stopped
        self._quiet_s = quiet_s
        self._last_message = time.monotonic()
        self._waiting = 0
        self._mutex = threading.Lock()

    def on_message(self, run: Callable[[], T | None]) -> T | None:
        """Run what a message named, as soon as another task may run; None when nothing ran."""
        self._note_message(1)
        try:
            while not self._free.acquire(timeout=_TICK_S):
                if self._stopped.is_set():
                    return None
        finally:
            self._note_message(-1)
        try:
            return run()
        finally:
            # The next message is asked for by now: only from here on is its absence silence.
            self._note_message(0)
            self._free.release()

    def _note_message(self, waiting: int) -> None:
        with self._mutex:
            self._waiting += waiting
            self._last_message = time.monotonic()

    def without_message(self, run_next: Callable[[float | None], bool]) -> None:
        """Run tasks for as long as there are some, another task may run and no message comes.

        Args:
            run_next: leases the next task and runs it to its end; False when there was none. Its argument is as
                `overdue_s` of `Plan.lease`: the first task must be one of which no message came in time, which shows
                that messages do not come. After it any will do.
        """
        overdue_s: float | None = self._quiet_s
        while self._is_quiet() and self._free.acquire(blocking=False):
            try:
                if not run_next(overdue_s):
                    return
                overdue_s = None
            finally:
                self._free.release()

    def _is_quiet(self) -> bool:
        with self._mutex:
            silent_s = time.monotonic() - self._last_message
            return not self._stopped.is_set() and not self._waiting and silent_s >= self._quiet_s


@dataclass(frozen=True)
class TaskLog:
    """The observer of a server: writes down what happens and passes on that something ended."""

    on_end: Callable[[], None]

    def started(self, lease: Lease) -> None:
        """A task begins."""
        _task_log.info("task_started", **ids(lease), owner=lease.owner)

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        """Progress is in the database, not in the log."""

    def ended(self, lease: Lease, outcome: AttemptOutcome, error: BladeAtlasError | None) -> None:
        """A task is over."""
        said = {"code": error.code, "message": error.message} if error else {}
        _task_log.info("task_ended", **ids(lease), outcome=outcome, **said)
        self.on_end()


@dataclass
class WorkerService:
    """Runs tasks when asked, publishes what is over, cleans up, and says that it is there."""

    settings: DeploymentSettings
    database: Database
    store: ArtifactStore
    graph: Graph
    name: str
    """Owner of its leases; unique, or kept over restarts by whoever can vouch that the old process is gone."""
    queues: Sequence[str] = tuple(Queue)
    concurrency: int = 0
    """Tasks side by side that it takes by message."""
    on_end: Callable[[], None] = field(default=lambda: None)
    """Called whenever a task ended: others may have become runnable."""

    def __post_init__(self) -> None:
        settings = self.settings
        self.plan = Plan(self.database, self.graph, settings.lease_s, settings.max_attempts)
        self.inspections = Inspections(self.database, self.graph)
        self.results = open_results(settings, self.store)
        self.inputs = LocalInputs(self.store, settings.folder("inputs"))
        self.publishing = Publishing(self.database, settings.lease_s, settings.retention_days)
        self._registry = WorkerRegistry(self.database)
        publisher = Publisher(
            self.publishing,
            self.inspections,
            self.results,
            self.store,
            settings.folder("scratch"),
            self.name,
            settings.heartbeat_s,
        )
        cleaner = Cleaner(
            Retention(self.database, settings.audit_days, settings.event_days),
            self.inspections,
            self.plan,
            self.store,
            self.results,
            self.inputs,
            settings.stale_s,
        )
        self._publisher = Periodic("publisher", publisher.publish_all, settings.sweep_s)
        self._sender = webhook_sender(settings, self.database)
        self._periodic = (
            self._publisher,
            *(
                Periodic(f"webhooks_{number}", self._sender.round, settings.sweep_s / _SEND_PER_SWEEP)
                for number in range(_SENDERS)
            ),
            Periodic("cleaner", cleaner.round, settings.sweep_s * _CLEAN_EVERY),
            Periodic("registry", self.report, settings.heartbeat_s),
        )

    def runner(self) -> TaskRunner:
        """A new runner; the last one may have been stopped for good."""
        remote = None if self.store.folder is not None else self.store
        logs = (self.store.folder or self.settings.data_dir.absolute()) / "logs"
        return TaskRunner(
            self.plan,
            self.results,
            TaskLogs(logs, by_inspection=True, mirror=remote),
            TaskLog(self._ended),
            self.inputs,
            TaskLimits.of(self.settings),
            self.settings.max_frame_pixels,
        )

    def report(self) -> None:
        """Say that this worker is there, and what it takes."""
        self._registry.seen(self.name, self.queues, self.concurrency)

    def start(self) -> None:
        """Begin with the periodic tasks."""
        for task in self._periodic:
            task.start()

    def stop(self) -> None:
        """End them, and say so."""
        self._sender.stopped.set()
        for task in self._periodic:
            task.stop()
        self._registry.gone(self.name)

    def _ended(self) -> None:
        self._publisher.nudge()
        self.on_end()


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
    queues: Sequence[str] = tuple(Queue)
    failure: BaseException | None = None
    """What ended a thread that should not have ended, e.g. a full disk under the database."""
    _woken: threading.Condition = field(default_factory=threading.Condition)
    _stop: threading.Event = field(default_factory=threading.Event)
    _threads: list[threading.Thread] = field(default_factory=list)

    def start(self) -> None:
        """Start all threads."""
        targets: list[Callable[[], None]] = [Heartbeat(self.runner, self.heartbeat_s, self._stop).run]
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
                _runners_log.error("runners_stopped", reason=str(self._current.failure))
                self._stopped.wait(_AFTER_FAILURE_S)


def say_confinement() -> None:
    """Hide this process's memory from children, and write down what keeps them from the network."""
    hide_memory()
    guard = possible_guard()
    if guard == NetworkGuard.NONE:
        meaning = "processes that read uploaded files can reach the network: allow seccomp filters or user namespaces"
        _children_log.warning("children_not_confined", network=guard, meaning=meaning)
    else:
        _children_log.info("children_confined", network=guard)
