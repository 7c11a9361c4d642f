"""What every process that runs tasks for a server consists of, whether a queue feeds it or it asks by itself."""

from __future__ import annotations

import os
import platform
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial

from core.errors import BladeAtlasError
from core.states import AttemptOutcome
from store.artifacts import ArtifactStore
from store.db import Database
from store.graph import Graph
from store.inputs import LocalInputs
from store.inspections import Inspections
from store.json_log import logger
from store.plan import Plan
from store.publishing import Publishing
from store.records import Lease
from store.retention import Retention
from store.settings import DeploymentSettings
from store.workers import WorkerRegistry
from worker.cleaner import Cleaner
from worker.logs import TaskLogs
from worker.mirror import open_results
from worker.periodic import Periodic
from worker.publisher import Publisher
from worker.runner import TaskRunner, ids

_log = logger("bladeatlas.tasks")
_CLEAN_EVERY = 6
"""Rounds of the sweeper between two of the cleaner, which lists whole folders."""


@dataclass(frozen=True)
class TaskLog:
    """The observer of a server: writes down what happens and passes on that something ended."""

    on_end: Callable[[], None]

    def started(self, lease: Lease) -> None:
        """A task begins."""
        _log.info("task_started", **ids(lease), owner=lease.owner)

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        """Progress is in the database, not in the log."""

    def ended(self, lease: Lease, outcome: AttemptOutcome, error: BladeAtlasError | None) -> None:
        """A task is over."""
        said = {"code": error.code, "message": error.message} if error else {}
        _log.info("task_ended", **ids(lease), outcome=outcome, **said)
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
    queues: Sequence[str] = ("cpu", "gpu")
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
            Retention(self.database),
            self.inspections,
            self.plan,
            self.store,
            self.results,
            self.inputs,
            settings.stale_s,
        )
        self._publisher = Periodic("publisher", publisher.publish_all, settings.sweep_s)
        seen = partial(self._registry.seen, self.name, self.queues)
        self._chores = (
            self._publisher,
            Periodic("cleaner", cleaner.round, settings.sweep_s * _CLEAN_EVERY),
            Periodic("registry", seen, settings.heartbeat_s),
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
            self.settings.task_memory_bytes,
            self.settings.task_seconds,
            self.settings.max_frame_pixels,
        )

    def start(self) -> None:
        """Begin with the chores."""
        for chore in self._chores:
            chore.start()

    def stop(self) -> None:
        """End them, and say so."""
        for chore in self._chores:
            chore.stop()
        self._registry.gone(self.name)

    def _ended(self) -> None:
        self._publisher.nudge()
        self.on_end()


def unique_name() -> str:
    """A name that no other process has or had."""
    return f"{platform.node()[:64]}-{os.getpid()}-{uuid.uuid4().hex[:6]}"
