"""Publishing: what a run reached, under the names of the contract, each file whole or not at all.

Files first, tables then, `summary.json` last. What an earlier run published and this one did not is removed.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from core.outputs import BEST_CASE, OUTPUTS, TABLES, Output, best_case
from core.report.build import Report, build_report, write_tables
from core.report.load import load_tables
from core.report.record import RunRecord, RunState, TaskRecord, TaskState
from core.settings import Settings
from core.stage import Facts
from core.versions import all_versions
from store.artifacts import ArtifactStore, Stored
from store.records import InspectionView, TaskView
from worker.results import MANIFEST, ResultFolders
from worker.rows import defect_rows

_LIST = "published.json"


def record_of(
    inspection: InspectionView, tasks: Sequence[TaskView], results: ResultFolders
) -> tuple[RunRecord, dict[str, Path]]:
    """The run as the report wants it, and the result folder of every finished task by key."""
    folders = {task.key: results.path(task.path) for task in tasks if task.path is not None}
    error = dict(inspection.error or {})
    states: tuple[RunState, ...] = ("succeeded", "partial", "cancelled")
    state: RunState = next((known for known in states if known == inspection.state), "failed")
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
    )
    return record, folders


def _task_record(task: TaskView) -> TaskRecord:
    states: tuple[TaskState, ...] = ("succeeded", "failed", "skipped", "cancelled")
    state: TaskState = next((known for known in states if known == task.state), "waiting")
    error = task.error if task.state == "failed" and task.error else {}
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


def publish(record: RunRecord, folders: Mapping[str, Path], out: Path, hidden: Path) -> Report:
    """Write the published folder of a run that ended.

    Args:
        folders: result folder of every finished task by key.
        out: the published folder.
        hidden: this program's own folder inside it, on the same disk.
    """
    report = build_report(record)
    store = ArtifactStore(out)
    known = _load(hidden / _LIST)
    facts = {task.key: task.facts for task in record.tasks if task.state == "succeeded"}
    wanted = dict(_files(folders, facts, trusted=report.verdict != "refused"))
    # Its presence says that everything else is of one run, so it goes first and comes last.
    store.remove("summary.json")
    published = {path: _put(store, out, path, source, known.get(path)) for path, source in wanted.items()}
    # Listed before anything is removed or the tables are written: a crash in between forgets no file.
    _save(hidden / _LIST, {**known, **published})
    with tempfile.TemporaryDirectory(prefix="tables-", dir=hidden) as folder:
        write_tables(report, Path(folder))
        for path in TABLES:
            stored = store.put(path, Path(folder) / path)
            published[path] = {"size": stored.size, "sha256": stored.sha256}
    for path in sorted(set(known) - set(published)):
        store.remove(path)
        _remove_empty(out, (out / path).parent)
    _save(hidden / _LIST, published)
    return report


def _files(folders: Mapping[str, Path], facts: Mapping[str, Facts], trusted: bool) -> Iterator[tuple[str, Path]]:
    """(published path, file) of everything the table of outputs finds."""
    for output in OUTPUTS:
        source = _source(output, folders, facts)
        if source is None or (output.needs_trust and not trusted):
            continue
        if not output.folder:
            yield output.path, source
            continue
        for path in sorted(p for p in source.rglob("*") if p.is_file() and p.name != MANIFEST):
            yield f"{output.path}/{path.relative_to(source).as_posix()}", path


def _source(output: Output, folders: Mapping[str, Path], facts: Mapping[str, Facts]) -> Path | None:
    for key, inner in output.sources:
        folder = folders.get(best_case(facts) if key == BEST_CASE else key)
        if folder is not None and (folder / inner).exists():
            return folder / inner
    return None


def _put(store: ArtifactStore, out: Path, path: str, source: Path, known: Mapping[str, Any] | None) -> dict[str, Any]:
    """Copy a file unless the very same is there; a copy, because people edit what lies in their folder."""
    target = out / path
    origin = str(source.relative_to(out)) if source.is_relative_to(out) else str(source)
    if known and known.get("origin") == origin and target.is_file() and known.get("mtime_ns") == _mtime(target):
        return dict(known)
    stored: Stored = store.put(path, source)
    return {"size": stored.size, "sha256": stored.sha256, "origin": origin, "mtime_ns": _mtime(target)}


def _mtime(path: Path) -> int:
    return path.stat().st_mtime_ns


def _remove_empty(out: Path, folder: Path) -> None:
    while folder != out and folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
        folder = folder.parent


def _load(path: Path) -> dict[str, dict[str, Any]]:
    if not path.is_file():
        return {}
    known: dict[str, dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))
    return known


def _save(path: Path, published: Mapping[str, Mapping[str, Any]]) -> None:
    part = path.with_suffix(".part")
    part.write_text(json.dumps(published, sort_keys=True, indent=1), encoding="utf-8")
    ArtifactStore(path.parent).put(path.name, part)
    part.unlink()
