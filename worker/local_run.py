"""A local run: the plan with local runners in the folder of the result, as the command line calls it.

The folder keeps `.bladeatlas/` inside it, and serves one run at a time and one input unless forced.
"""

from __future__ import annotations

import errno
import os
import signal
import threading
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import FrameType

from filelock import FileLock, Timeout

from core.errors import BadInput, BladeAtlasError, Cancelled, DiskFull, error_from_dict
from core.files import require_file
from core.fingerprint import digest_of_file
from core.outputs import OUTPUTS, TABLES
from core.report.summary import stage_state
from core.settings import Settings
from core.states import RunState, TaskState, run_state
from core.video.pictures import digest_of_video
from core.videos import Recording
from store.db import Database, open_sqlite
from store.environment import deployment_settings
from store.graph import CORE_GRAPH, Graph
from store.inspections import Inspections, input_digest
from store.models import ACTIVE_INSPECTION, OVER_TASK
from store.plan import Plan
from store.records import InputFiles, InspectionView, TaskView
from store.settings import available_cores
from worker.events import EventKind, OnEvent, Outcome, Reporter, StageOutcome, Tracker
from worker.limits import TaskLimits
from worker.logs import TaskLogs
from worker.loop import LocalRunners, raise_failure
from worker.publish import publish, record_of, report_rows
from worker.results import ResultFolders
from worker.runner import TaskRunner, result_of

HIDDEN = ".bladeatlas"
_LOCAL = "local"
"""Id of the one inspection in the plan of an output folder."""


@dataclass(frozen=True)
class RunFolder:
    """Where things lie in the output folder of a local run."""

    out: Path

    @property
    def hidden(self) -> Path:
        """This program's own folder."""
        return self.out / HIDDEN

    @property
    def database(self) -> Path:
        """The plan."""
        return self.hidden / "plan.db"

    @property
    def results(self) -> Path:
        """Results by stage and fingerprint."""
        return self.hidden / "results"

    @property
    def logs(self) -> Path:
        """One log per task."""
        return self.hidden / "logs"

    def foreign_files(self) -> list[str]:
        """Names of the contract that are taken; in a folder without a plan, by files of somebody else."""
        names = (*TABLES, *(output.path for output in OUTPUTS))
        return [name for name in names if (self.out / name).exists()]


@contextmanager
def locked(out: Path) -> Iterator[RunFolder]:
    """The folder, made when needed and held against other runs.

    Raises:
        BadInput: it is no folder, may not be written, or another run uses it.
        DiskFull: the disk has no space for it.
    """
    folder = RunFolder(out)
    path = folder.hidden / "lock"
    lock = FileLock(path, blocking=False, fallback_to_soft=False)  # the kernel's: a killed run holds nothing
    try:
        folder.hidden.mkdir(parents=True, exist_ok=True)
        held = lock.acquire()
    except Timeout:
        raise BadInput(f"another run is working in '{out}'", code="folder_in_use", where="--out") from None
    except OSError as error:
        raise _cannot_write(out, error) from None
    with held:
        try:
            path.write_text(str(os.getpid()), encoding="ascii")  # and proves that the disk takes data
        except OSError as error:
            raise _cannot_write(out, error) from None
        yield folder


def _cannot_write(out: Path, error: OSError) -> BladeAtlasError:
    reason = os.strerror(error.errno or 0).lower()
    if error.errno in (errno.ENOSPC, errno.EDQUOT):
        return DiskFull(f"the output folder '{out}' cannot be written: {reason}", where="--out")
    return BadInput(f"the output folder '{out}' cannot be written: {reason}", code="unwritable_output", where="--out")


@dataclass(frozen=True)
class Names:
    """The caller's own names of a run."""

    label: str = ""
    external_id: str = ""
    metadata: Mapping[str, str] = field(default_factory=dict)


def run_inspection(
    recordings: Sequence[Recording],
    out: Path,
    settings: Settings,
    *,
    workers: int | None = None,
    on_event: OnEvent | None = None,
    from_stage: str | None = None,
    force: bool = False,
    names: Names = Names(),
    graph: Graph = CORE_GRAPH,
) -> Outcome:
    """Run or continue one inspection in the folder `out`.

    Args:
        recordings: its videos in order, each with its annotations.
        out: the folder.
        settings: of the run.
        workers: tasks side by side; None = number of cores.
        on_event: called from runner threads, one call at a time.
        from_stage: delete the results of this stage and of all that depend on it.
        force: accept a folder that holds the result of another input, or files under the names of the contract.
        names: what the caller calls the run; kept beside the result.
        graph: stages to run; another one in tests.

    Ctrl-C and SIGTERM stop children, release leases and return the state ``interrupted``.

    Raises:
        BadInput: input file missing, unknown stage, folder of another input, or in use by another run.
        DiskFull: the folder cannot be written from the start.
    """
    if from_stage is not None and from_stage not in graph.stages:
        raise BadInput(f"unknown stage '{from_stage}'; known: {', '.join(graph.stages)}", where="--from")
    files = [_input_files(one) for one in recordings]
    with locked(out.resolve()) as folder:
        database = open_sqlite(folder.database)
        try:
            run = _Run(folder, database, graph, workers or available_cores(), on_event)
            run.open(files, settings, names, from_stage, force)
            with _terminable():
                return run.work()
        except OSError as error:
            raise DiskFull(f"the output folder '{out}' cannot be written: {error.strerror}", where="--out") from error
        finally:
            database.close()


def _input_files(recording: Recording) -> InputFiles:
    video, annotations = recording.video, recording.annotations
    video_sha256 = digest_of_video(video)
    if annotations is not None:
        require_file(annotations, "annotations")
    return InputFiles(
        video=str(video.resolve()),
        video_sha256=video_sha256,
        annotations=str(annotations.resolve()) if annotations else None,
        annotations_sha256=digest_of_file(annotations) if annotations else None,
    )


@contextmanager
def _terminable() -> Iterator[None]:
    """Let SIGTERM end the run as Ctrl-C does; only a main thread may and needs to."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def interrupt(_number: int, _frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    before = signal.signal(signal.SIGTERM, interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class _Run:
    """One call of `run_inspection` once the folder is its own."""

    def __init__(
        self, folder: RunFolder, database: Database, graph: Graph, workers: int, on_event: OnEvent | None
    ) -> None:
        deployment = deployment_settings()
        self._started = time.monotonic()
        self._folder = folder
        self._graph = graph
        self._results = ResultFolders(folder.results)
        self._inspections = Inspections(database, graph)
        self._plan = Plan(database, graph, deployment.lease_s, deployment.max_attempts)
        self._reporter = Reporter(Tracker(graph, workers), lambda: self._inspections.tasks(_LOCAL), on_event)
        runner = TaskRunner(
            self._plan,
            self._results,
            TaskLogs(folder.logs),
            self._reporter,
            limits=TaskLimits.of(deployment),
        )
        owner = f"run:{os.getpid()}"
        self._runners = LocalRunners(runner, owner, workers, deployment.heartbeat_s, inspection_id=_LOCAL)

    def open(
        self, files: Sequence[InputFiles], settings: Settings, names: Names, from_stage: str | None, force: bool
    ) -> None:
        """Put the plan in order: what crashed runs left, another input, forgotten stages, new parameters."""
        known = next(iter(self._inspections.find()), None)
        if not force:
            self._refuse_foreign(known, files)
        self._results.sweep()
        self._match_files_and_rows()
        if from_stage is not None:
            stages = self._inspections.stages_from(_LOCAL, from_stage)
            self._remove(name for name, path in self._inspections.known_results().items() if _stage(path) in stages)
        if known is None:
            self._inspections.create(_LOCAL, files, settings, str(self._folder.out), **asdict(names))
        else:
            # Nobody else can work here while this run holds the folder: every lease is one of a dead run.
            self._plan.take_over(_LOCAL)
            self._inspections.reopen(_LOCAL, files, settings, **asdict(names))

    def _refuse_foreign(self, known: InspectionView | None, files: Sequence[InputFiles]) -> None:
        out = self._folder.out
        if known is not None and known.input_digest != input_digest(files):
            message = f"'{out}' holds the result of another input; choose another folder or use --force"
            raise BadInput(message, code="another_input", where="--out")
        foreign = self._folder.foreign_files() if known is None else []
        if foreign:
            message = f"'{out}' already has '{foreign[0]}' from elsewhere; choose another folder or use --force"
            raise BadInput(message, code="foreign_files", where="--out")

    def _match_files_and_rows(self) -> None:
        """Files decide: results without a row are adopted, rows without files forgotten."""
        on_disk = {manifest.fingerprint: manifest for manifest in self._results.all()}
        known = self._inspections.known_results()
        self._inspections.delete_results(name for name in known if name not in on_disk)
        self._inspections.adopt(
            result_of(manifest, self._results, peak_rss_bytes=manifest.peak_rss_bytes)
            for name, manifest in on_disk.items()
            if name not in known
        )

    def _remove(self, fingerprints: Iterable[str]) -> None:
        paths = self._inspections.known_results()
        doomed = [name for name in fingerprints if name in paths]
        self._inspections.delete_results(doomed)
        for fingerprint in doomed:
            self._results.remove(_stage(paths[fingerprint]), fingerprint)

    def work(self) -> Outcome:
        """Run until the plan is over, publish what was reached, clean up."""
        try:
            self._reporter.opened()
            self._runners.start()
            self._runners.join(self._is_over)
            raise_failure(self._runners.failure)
            self._publish()
        except KeyboardInterrupt:
            self._runners.stop()
            return self._outcome(RunState.INTERRUPTED)
        except BladeAtlasError as error:
            return self._outcome(RunState.FAILED, error)
        except OSError as error:
            message = f"the output folder '{self._folder.out}' cannot be written: {error.strerror}"
            return self._outcome(RunState.FAILED, DiskFull(message, where="--out"))
        return self._outcome()

    def _is_over(self) -> bool:
        return self._inspections.get(_LOCAL).state not in ACTIVE_INSPECTION

    def _publish(self) -> None:
        inspection, tasks = self._inspections.get(_LOCAL), self._inspections.tasks(_LOCAL)
        record, folders = record_of(inspection, tasks, self._results)
        report = publish(record, folders, self._folder.out, self._folder.hidden)
        self._inspections.put_rows(_LOCAL, report_rows(report))
        self._reporter.tell(EventKind.PUBLISHED)
        self._remove(self._inspections.unused())

    def _outcome(self, state: RunState | None = None, error: BladeAtlasError | None = None) -> Outcome:
        inspection, tasks = self._inspections.get(_LOCAL), self._inspections.tasks(_LOCAL)
        reached = run_state(inspection.state)
        ended = state or reached
        if ended == RunState.CANCELLED:
            error = Cancelled("the run was cancelled", where="run")
        elif ended != RunState.INTERRUPTED and error is None and inspection.error:
            error = error_from_dict(inspection.error)
        self._reporter.tell(EventKind.FINISHED, state=ended)
        done, computed = sum(task.state == TaskState.SUCCEEDED for task in tasks), self._reporter.computed
        return Outcome(
            state=ended,
            out=self._folder.out,
            seconds=round(time.monotonic() - self._started, 3),
            computed=computed,
            reused=max(0, done - computed),
            failed_stage=inspection.failed_stage or "",
            error=error,
            stages=_stages(self._graph, tasks),
        )


def _stage(path: str) -> str:
    """Stage of a result, from its relative path."""
    return path.split("/", 1)[0]


def _stages(graph: Graph, tasks: Sequence[TaskView]) -> tuple[StageOutcome, ...]:
    """The stages that this plan has, in the graph's order."""
    rows = []
    for name in graph.stages:
        own = [task for task in tasks if task.stage == name]
        if own:
            rows.append(
                StageOutcome(
                    name=name,
                    state=stage_state([task.state if task.state in OVER_TASK else TaskState.WAITING for task in own]),
                    done=sum(task.state in OVER_TASK for task in own),
                    total=len(own),
                    reused=sum(task.reused for task in own),
                    seconds=round(sum(task.seconds or 0.0 for task in own), 3),
                    peak_rss_bytes=max(task.peak_rss_bytes or 0 for task in own),
                )
            )
    return tuple(rows)
