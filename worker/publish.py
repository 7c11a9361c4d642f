"""What a run that ended publishes, whatever it reached: files of its results and tables of its report."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.flags import Verdict
from core.outputs import BEST_CASE, OF_FURTHER_MODELS, OUTPUTS, TABLES, Output, best_case
from core.report.build import Report, build_report, write_tables
from core.report.load import load_tables, served_pieces
from core.report.record import RunRecord, TaskRecord
from core.settings import Settings
from core.stage import Facts
from core.states import TaskState, run_state
from core.task_key import key_of
from core.versions import all_versions
from store.models import OVER_TASK
from store.records import InspectionView, TaskView
from worker.results import MANIFEST, ResultFolders
from worker.rows import defect_rows


@dataclass(frozen=True)
class Collection:
    """What a run publishes, by path of the contract."""

    report: Report
    files: Mapping[str, Path]
    """Files of results, which never change."""
    tables: Mapping[str, Path]
    """Written for this report; `summary.json` last, its presence says that everything else is there."""


class Folders(Mapping[str, Path]):
    """Result folder of every finished task by key, brought here only when it is asked for."""

    def __init__(self, tasks: Sequence[TaskView], results: ResultFolders) -> None:
        self._paths = {task.key: task.path for task in tasks if task.path is not None}
        self._results = results

    def __getitem__(self, key: str) -> Path:
        path = self._paths[key]
        self._results.have(path)
        return self._results.path(path)

    def __contains__(self, key: object) -> bool:
        return key in self._paths

    def __iter__(self) -> Iterator[str]:
        return iter(self._paths)

    def __len__(self) -> int:
        return len(self._paths)


def record_of(
    inspection: InspectionView, tasks: Sequence[TaskView], results: ResultFolders
) -> tuple[RunRecord, Folders]:
    """The run as the report wants it, and the result folders of its finished tasks."""
    folders = Folders(tasks, results)
    error = dict(inspection.error or {})
    state = run_state(inspection.state)
    files = inspection.files
    inputs = {"video": files.video_sha256}
    if files.annotations_sha256:
        inputs["annotations"] = files.annotations_sha256
    record = RunRecord(
        settings=Settings.model_validate(inspection.settings),
        state=state,
        tasks=[_task_record(task) for task in tasks],
        tables=load_tables(folders),
        inputs=inputs,
        versions=all_versions(),
        failed_stage=inspection.failed_stage or "",
        reason=str(error.get("code", "")),
        message=str(error.get("message", "")),
        label=inspection.label,
        external_id=inspection.external_id,
    )
    return record, folders


def _task_record(task: TaskView) -> TaskRecord:
    state = task.state if task.state in OVER_TASK else TaskState.WAITING
    error = task.error if task.state == TaskState.FAILED and task.error else {}
    return TaskRecord(
        key=task.key,
        state=state,
        reason=str(error.get("code", "")),
        message=str(error.get("message", "")),
        seconds=task.seconds or 0.0,
        peak_rss_bytes=task.peak_rss_bytes or 0,
        facts=dict(task.facts or {}),
    )


def report_rows(report: Report) -> dict[str, Any]:
    """The report's tables as rows of the database, so that both say the same."""
    return {
        "cases": list(report.cases),
        "detections": list(report.detections),
        "events": list(report.timeline),
        "defects": defect_rows([dict(record) for record in report.defects]),
    }


@contextmanager
def collected(record: RunRecord, folders: Mapping[str, Path], scratch: Path) -> Iterator[Collection]:
    """Everything that a run publishes; its tables lie below the folder `scratch` as long as the block lasts."""
    report = build_report(record)
    facts = {task.key: task.facts for task in record.tasks if task.state == TaskState.SUCCEEDED}
    files = dict(_files(folders, facts, trusted=report.verdict != Verdict.REFUSED))
    scratch.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="tables-", dir=scratch) as folder:
        write_tables(report, Path(folder))
        yield Collection(report, files, {path: Path(folder) / path for path in TABLES})


def _files(folders: Mapping[str, Path], facts: Mapping[str, Facts], trusted: bool) -> Iterator[tuple[str, Path]]:
    """(published path, file) of everything the table of outputs finds."""
    wanted = [(output, "", 0) for output in OUTPUTS]
    for piece in served_pieces(folders):
        wanted += [(output, f"models/{piece}/", piece) for output in OF_FURTHER_MODELS]
    for output, below, piece in wanted:
        source = _source(output, folders, facts, piece)
        if source is None or (output.needs_trust and not trusted):
            continue
        if not output.folder:
            yield below + output.path, source
            continue
        for path in sorted(p for p in source.rglob("*") if p.is_file() and p.name != MANIFEST):
            yield f"{below}{output.path}/{path.relative_to(source).as_posix()}", path


def _source(output: Output, folders: Mapping[str, Path], facts: Mapping[str, Facts], piece: int) -> Path | None:
    for key, inner in output.sources:
        folder = folders.get(best_case(facts) if key == BEST_CASE else key_of(key, piece))
        if folder is not None and (folder / inner).exists():
            return folder / inner
    return None
