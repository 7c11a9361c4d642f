"""The runner: lease a task, execute its stage in a child process, commit the result; N of them side by side.

Local runs and embedded servers use these threads; a queue's task calls `TaskRunner.run` for the same.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Protocol, TypeVar

from core.errors import BladeAtlasError, DiskFull, ResourceError, StageFailed
from core.settings import Settings
from store.disk import NO_SPACE
from store.plan import Plan
from store.records import Lease, Result
from store.settings import available_cores
from worker.patience import patiently
from worker.process import Ended, StopReason, TaskProcess
from worker.results import Manifest, ResultFolders
from worker.rows import rows_of

T = TypeVar("T")


class Observer(Protocol):
    """Who wants to know what a runner does; called from its thread."""

    def started(self, lease: Lease) -> None:
        """A task begins."""

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        """A task reports."""

    def ended(self, lease: Lease, outcome: str, error: BladeAtlasError | None) -> None:
        """A task is over: succeeded, reused, retried, failed, released, refused."""


@dataclass
class Held:
    """A lease while this process works on it."""

    lease: Lease
    progress: float = 0.0
    message: str = ""
    stop: StopReason = ""


@dataclass
class TaskRunner:
    """Runs leased tasks, each to one of the ends that the plan knows."""

    plan: Plan
    results: ResultFolders
    logs: Path
    observer: Observer
    memory_limit_bytes: int = 0
    interrupted: threading.Event = field(default_factory=threading.Event)
    held: dict[int, Held] = field(default_factory=dict)

    def run(self, lease: Lease) -> str:
        """Execute a lease; returns how it ended."""
        held = Held(lease)
        self.held[lease.task_id] = held
        self.observer.started(lease)
        error: BladeAtlasError | None = None
        try:
            outcome, error = self._execute(held)
        except OSError as failure:
            error = _as_expected(failure, lease.key)
            outcome = self._fail(lease, error, 0.0, 0)
        finally:
            self.held.pop(lease.task_id, None)
        self.observer.ended(lease, outcome, error)
        return outcome

    def _execute(self, held: Held) -> tuple[str, BladeAtlasError | None]:
        lease = held.lease
        # Finished files whose commit a crash cut off, or that another worker has just made, are not made again.
        finished = self.results.find(lease.stage, lease.fingerprint)
        if finished is not None:
            accepted = self._complete(lease, finished, finished.peak_rss_bytes) == "succeeded"
            return "reused" if accepted else "refused", None
        temporary = self.results.begin(lease.stage, lease.fingerprint)
        try:
            ended = self._in_child(held, temporary)
            if ended.stopped:
                return self._release(held.lease), None
            if ended.error is not None:
                outcome = self._fail(lease, ended.error, ended.seconds, ended.peak_rss_bytes)
                return outcome, ended.error
            manifest = self.results.commit(temporary, lease.stage, lease.fingerprint)
            return self._complete(lease, manifest, ended.peak_rss_bytes), None
        finally:
            self.results.discard(temporary)

    def _in_child(self, held: Held, temporary: Path) -> Ended:
        lease = held.lease
        missing = [key for key, path in lease.inputs.items() if not self.results.path(path).is_dir()]
        if missing:
            error = StageFailed(f"the result of {missing[0]} has vanished; run again to make it anew", where=lease.key)
            return Ended(error, "", 0.0, 0)
        process = TaskProcess(self._spec(lease, temporary), self._log(lease), self.memory_limit_bytes)

        def progress(fraction: float, message: str) -> None:
            held.progress, held.message = fraction, message
            self.observer.progressed(lease, fraction, message)

        return process.wait(progress, lambda: "interrupted" if self.interrupted.is_set() else held.stop)

    def _log(self, lease: Lease) -> Path:
        """The task's log; a first attempt begins it anew. Who writes to it is said in its own lines."""
        self.logs.mkdir(parents=True, exist_ok=True)
        path = self.logs / f"{lease.key.replace('/', '__')}.log"
        names = ("inspection_id", "key", "attempt", "fence", "fingerprint", "owner")
        line = {"event": "attempt_started", **{name: getattr(lease, name) for name in names}}
        with path.open("w" if lease.attempt == 1 else "a", encoding="utf-8") as stream:
            stream.write(json.dumps({"time": datetime.now(UTC).isoformat(timespec="milliseconds"), **line}) + "\n")
        return path

    def _spec(self, lease: Lease, temporary: Path) -> dict[str, Any]:
        stage = self.plan.graph.stages[lease.stage]
        settings = Settings.model_validate(lease.settings)
        return {
            "key": lease.key,
            "entry": stage.entry,
            "version": stage.version,
            "fingerprint": lease.fingerprint,
            "args": dict(lease.args),
            "settings": dict(lease.settings),
            "inputs": {key: str(self.results.path(path)) for key, path in lease.inputs.items()},
            "facts": {key: dict(facts) for key, facts in lease.facts.items()},
            "video": lease.files.video,
            "annotations": lease.files.annotations,
            "out": str(temporary),
            "threads": 1 if stage.fan_out else settings.compute.threads or available_cores(),
        }

    def _complete(self, lease: Lease, manifest: Manifest, peak_rss_bytes: int) -> str:
        result = result_of(manifest, self.results, peak_rss_bytes=peak_rss_bytes)
        return "succeeded" if self._patiently(lambda: self.plan.complete(lease, result)) else "refused"

    def _fail(self, lease: Lease, error: BladeAtlasError, seconds: float, peak_rss_bytes: int) -> str:
        # A full disk would fail every other task as well, and tolerating it would spoil the result unseen.
        record = {**error.to_dict(), "stops_run": isinstance(error, DiskFull)}
        return self._patiently(
            lambda: self.plan.fail(lease, record, retry=error.retryable, seconds=seconds, peak_rss_bytes=peak_rss_bytes)
        )

    def _release(self, lease: Lease) -> str:
        # A lost lease is given back as well: the plan refuses it, and the attempt says so.
        return "released" if self._patiently(lambda: self.plan.release(lease)) else "refused"

    def _patiently(self, call: Callable[[], T]) -> T:
        return patiently(self.plan.db, call, self.interrupted)


def _as_expected(failure: OSError, key: str) -> BladeAtlasError:
    """What a failure of the runner's own work on files and processes means."""
    if failure.errno in NO_SPACE:
        return DiskFull(f"the results folder cannot be written: {failure.strerror}", where=key)
    return ResourceError(f"the task could not be started or kept: {failure}", where=key)


def result_of(manifest: Manifest, results: ResultFolders, *, peak_rss_bytes: int) -> Result:
    """A finished folder as the plan keeps it."""
    path = results.relative(manifest.stage, manifest.fingerprint)
    return Result(
        fingerprint=manifest.fingerprint,
        stage=manifest.stage,
        digest=manifest.digest,
        facts=manifest.facts,
        path=path,
        seconds=manifest.seconds,
        peak_rss_bytes=peak_rss_bytes,
        rows=rows_of(manifest.stage, manifest.facts, results.path(path)),
    )
