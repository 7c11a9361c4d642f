"""The runner: lease a task, execute its stage in a child process, commit the result, and keep its lease alive.

Local runs and embedded servers use these threads; a queue's task calls `TaskRunner.run` for the same.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Protocol, TypeVar

from core.errors import BladeAtlasError, DiskFull, ProgrammingError, ResourceError
from core.settings import Settings
from core.states import AttemptOutcome
from core.video.limits import MAX_FRAME_PIXELS
from store.disk import NO_SPACE
from store.files import UNREACHABLE, LocalInputs
from store.json_log import logger
from store.plan import Plan
from store.records import Lease, Result
from store.retry import retried_until
from store.settings import available_cores
from store.tables import rows_of
from worker.limits import TaskLimits
from worker.logs import TaskLogs
from worker.results import Manifest, ResultFolders
from worker.task import Ended, StopReason, TaskProcess

T = TypeVar("T")
_log = logger("bladeatlas.tasks")
_SAME_AGAIN = ("oom", "timeout")
"""Codes of errors that a second attempt would meet again, after the same time and to the same harm of others."""
_STORE_PAUSE_S = 5.0
TICK_S = 0.5
"""How soon a cancellation, the end of the plan or work of others is noticed."""


class Observer(Protocol):
    """Who wants to know what a runner does; called from its thread."""

    def started(self, lease: Lease) -> None:
        """A task begins."""

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        """A task reports."""

    def ended(self, lease: Lease, outcome: AttemptOutcome, error: BladeAtlasError | None) -> None:
        """A task is over: succeeded, reused, retried, failed, released, refused."""


@dataclass(frozen=True)
class Ending:
    """How a lease ended."""

    outcome: AttemptOutcome
    error: BladeAtlasError | None
    """What the stage, or the runner, failed with."""


@dataclass
class Held:
    """A lease while this process works on it."""

    lease: Lease
    progress: float = 0.0
    message: str = ""
    stop: StopReason | None = None


@dataclass
class TaskRunner:
    """Runs leased tasks, each to one of the ends that the plan knows."""

    plan: Plan
    results: ResultFolders
    logs: TaskLogs
    observer: Observer
    inputs: LocalInputs = field(default_factory=LocalInputs)
    limits: TaskLimits = field(default_factory=TaskLimits)
    max_frame_pixels: int = MAX_FRAME_PIXELS
    interrupted: threading.Event = field(default_factory=threading.Event)
    held: dict[int, Held] = field(default_factory=dict)

    def run(self, lease: Lease) -> Ending:
        """Execute a lease; returns how it ended."""
        held = Held(lease)
        self.held[lease.task_id] = held
        self.observer.started(lease)
        error: BladeAtlasError | None = None
        try:
            outcome, error = self._execute(held)
        except (OSError, BladeAtlasError) as failure:
            error = _as_expected(failure, lease.key)
            outcome = self._give_up(held, error)
        finally:
            self.held.pop(lease.task_id, None)
        self._end_log(lease, outcome)
        self.observer.ended(lease, outcome, error)
        return Ending(outcome, error)

    def _execute(self, held: Held) -> tuple[AttemptOutcome, BladeAtlasError | None]:
        lease = held.lease
        # Finished files whose commit a crash cut off, or that another worker has just made, are not made again.
        finished = self.results.find(lease.stage, lease.fingerprint)
        if finished is not None:
            accepted = self._complete(lease, finished, finished.peak_rss_bytes) == AttemptOutcome.SUCCEEDED
            return AttemptOutcome.REUSED if accepted else AttemptOutcome.REFUSED, None
        missing = [key for key, path in lease.inputs.items() if not self.results.have(path)]
        if missing:
            _log.warning("results_vanished", **ids(lease), missing=missing)
            remade = self._retried(lambda: self.plan.remake(lease, missing))
            return AttemptOutcome.RELEASED if remade else AttemptOutcome.REFUSED, None
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
        spec = self._spec(lease, temporary)
        process = TaskProcess(spec, self.logs.begin(lease), self.limits)

        def progress(fraction: float, message: str) -> None:
            held.progress, held.message = fraction, message
            self.observer.progressed(lease, fraction, message)

        return process.wait(progress, lambda: StopReason.INTERRUPTED if self.interrupted.is_set() else held.stop)

    def _end_log(self, lease: Lease, outcome: AttemptOutcome) -> None:
        try:
            self.logs.end(lease, outcome)
        except (OSError, BladeAtlasError) as failure:
            # The result is committed: a log that cannot be kept must not undo that.
            _log.warning("task_log_not_kept", **ids(lease), reason=str(failure))

    def _spec(self, lease: Lease, temporary: Path) -> dict[str, Any]:
        stage = self.plan.graph.stages[lease.stage]
        settings = Settings.model_validate(lease.settings)
        recordings = [
            self.inputs.recording(one, video=stage.reads_video, annotations=stage.reads_annotations)
            for one in lease.files
        ]
        threads = 1 if stage.fan_out else settings.compute.threads or available_cores()
        return {
            "key": lease.key,
            "entry": stage.entry,
            "version": stage.version,
            "fingerprint": lease.fingerprint,
            "args": dict(lease.args),
            "settings": dict(lease.settings),
            "declared": list(stage.settings),
            "inputs": {key: str(self.results.path(path)) for key, path in lease.inputs.items()},
            "facts": {key: dict(facts) for key, facts in lease.facts.items()},
            "recordings": [one.to_dict() for one in recordings],
            "out": str(temporary),
            "max_frame_pixels": self.max_frame_pixels,
            "threads": threads,
            "limits": asdict(self.limits.of_process(stage.queue, threads)),
        }

    def _complete(self, lease: Lease, manifest: Manifest, peak_rss_bytes: int) -> AttemptOutcome:
        result = result_of(manifest, self.results, peak_rss_bytes=peak_rss_bytes)
        accepted = self._retried(lambda: self.plan.complete(lease, result))
        return AttemptOutcome.SUCCEEDED if accepted else AttemptOutcome.REFUSED

    def _fail(self, lease: Lease, error: BladeAtlasError, seconds: float, peak_rss_bytes: int) -> AttemptOutcome:
        record = {**error.to_dict(), "stops_run": _stops_run(error)}
        retry = error.retryable and error.code not in _SAME_AGAIN
        return self._retried(
            lambda: self.plan.fail(lease, record, retry=retry, seconds=seconds, peak_rss_bytes=peak_rss_bytes)
        )

    def _give_up(self, held: Held, error: BladeAtlasError) -> AttemptOutcome:
        if error.code != UNREACHABLE:
            return self._fail(held.lease, error, 0.0, 0)
        # Nobody's fault but the store's, and what was computed is kept here: again when it answers.
        self.interrupted.wait(_STORE_PAUSE_S)
        return self._release(held.lease)

    def _release(self, lease: Lease) -> AttemptOutcome:
        # A lost lease is given back as well: the plan refuses it, and the attempt says so.
        released = self._retried(lambda: self.plan.release(lease))
        return AttemptOutcome.RELEASED if released else AttemptOutcome.REFUSED

    def _retried(self, call: Callable[[], T]) -> T:
        return retried_until(self.interrupted, self.plan.db, call)


def ids(lease: Lease) -> dict[str, str | int]:
    """What every log line about a lease names."""
    return {"inspection": lease.inspection_id, "stage": lease.key, "attempt": lease.attempt}


def _stops_run(error: BladeAtlasError) -> bool:
    """Whether an error ends the run in an optional task too, because going on would spoil the result unseen.

    A full disk would fail every other task as well, and a mistake in the code is never something that the video says.
    What a library raises on hard input (`RuntimeError`, `ValueError`) is an outcome of that task alone.
    """
    return isinstance(error, DiskFull | ProgrammingError)


def _as_expected(failure: OSError | BladeAtlasError, key: str) -> BladeAtlasError:
    """What a failure of the runner's own work on files and processes means."""
    if isinstance(failure, BladeAtlasError):
        return failure
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
        rows=rows_of(manifest.key, manifest.facts, results.path(path)),
    )


@dataclass
class Heartbeat:
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
                    one.stop = StopReason.CANCELLED

    def _beat(self, held: Sequence[Held]) -> None:
        lost = self.runner.plan.heartbeat((one.lease, one.progress, one.message) for one in held)
        gone = {lease.task_id for lease in lost}
        for one in held:
            # A task that ended meanwhile is no longer held, and its lease is not lost but over.
            if one.lease.task_id in gone and self.runner.held.get(one.lease.task_id) is one:
                one.stop = StopReason.LOST
