"""Publication of what a run reached: collected from its results, put into a folder or into the artifact store.

A local run publishes into its folder: files first, tables then, `summary.json` last; what an earlier run published and
this one did not is removed. A server's plans become artifacts in the store and rows in the database; a crash at any
point leaves an inspection that is still to be published, and files that the next publisher writes again, byte for byte,
under the same names.
"""

from __future__ import annotations

import gzip
import json
import shutil
import tempfile
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import Cancelled
from core.flags import Verdict
from core.outputs import BEST_CASE, OF_FURTHER_MODELS, OUTPUTS, TABLES, Output, best_case, is_of_page
from core.report.build import Report, build_report, write_tables
from core.report.load import load_tables, served_submodels
from core.report.record import RunRecord, TaskRecord
from core.settings import Settings
from core.states import TaskState, run_state
from core.task_key import key_of
from core.versions import all_versions
from core.videos import input_role
from core.viewer.pages import write_pages
from store.files import ArtifactStore, Stored
from store.inspections import Inspections
from store.json_log import logger
from store.models import OVER_TASK
from store.publishing import Publishing, Ticket, compressed_key, uncompressed_key
from store.records import InspectionView, TaskView
from store.tables import defect_rows
from worker.periodic import Periodic
from worker.results import MANIFEST, ResultFolders

_LIST = "published.json"
_GZIP_LEVEL = 6
_log = logger("bladeatlas.publisher")


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
    inputs = {}
    for number, one in enumerate(inspection.files):
        inputs[input_role("video", number)] = one.video_sha256
        if one.annotations_sha256:
            inputs[input_role("annotations", number)] = one.annotations_sha256
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
        metadata=inspection.metadata,
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
    files = dict(_files(folders, best_case(record.products), trusted=report.verdict != Verdict.REFUSED))
    scratch.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="tables-", dir=scratch) as folder:
        compared = set(write_tables(report, Path(folder))) - set(TABLES)
        pages = write_pages(report, folders, files, Path(folder))
        yield Collection(report, files, {path: Path(folder) / path for path in (*pages, *sorted(compared), *TABLES)})


def _files(folders: Mapping[str, Path], best: str, trusted: bool) -> Iterator[tuple[str, Path]]:
    """(published path, file) of everything the table of outputs finds; `best` is the key of the chosen case."""
    wanted = [(output, "", 0) for output in OUTPUTS]
    for submodel in served_submodels(folders):
        wanted += [(output, f"models/{submodel}/", submodel) for output in OF_FURTHER_MODELS]
    for output, below, submodel in wanted:
        source = _source(output, folders, best, submodel)
        if source is None or (output.needs_trust and not trusted):
            continue
        if not output.folder:
            yield below + output.path, source
            continue
        for path in sorted(p for p in source.rglob("*") if p.is_file() and p.name != MANIFEST):
            yield f"{below}{output.path}/{path.relative_to(source).as_posix()}", path


def _source(output: Output, folders: Mapping[str, Path], best: str, submodel: int) -> Path | None:
    for key, inner in output.sources:
        folder = folders.get(best if key == BEST_CASE else key_of(key, submodel))
        if folder is not None and (folder / inner).exists():
            return folder / inner
    return None


def publish(record: RunRecord, folders: Mapping[str, Path], out: Path, hidden: Path) -> Report:
    """Write the published folder of a run that ended.

    Args:
        folders: result folder of every finished task by key.
        out: the published folder.
        hidden: this program's own folder inside it, on the same disk.
    """
    store = ArtifactStore(out)
    known = _load(hidden / _LIST)
    # One run at a time works here: what a killed one left is nobody's.
    for left in hidden.glob("tables-*"):
        shutil.rmtree(left, ignore_errors=True)
    with collected(record, folders, hidden) as wanted:
        # Its presence says that everything else is of one run, so it goes first and comes last.
        store.remove("summary.json")
        published = {path: _put(store, out, path, source, known.get(path)) for path, source in wanted.files.items()}
        # Listed before anything is removed or the tables are written: a crash in between forgets no file.
        _save(hidden / _LIST, {**known, **published})
        for path, source in wanted.tables.items():
            stored = store.put(path, source)
            published[path] = {"size": stored.size, "sha256": stored.sha256}
    for path in sorted(set(known) - set(published)):
        store.remove(path)
    _save(hidden / _LIST, published)
    return wanted.report


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


@dataclass(frozen=True)
class Publisher:
    """Publishes one inspection after the other."""

    publishing: Publishing
    inspections: Inspections
    results: ResultFolders
    store: ArtifactStore
    scratch: Path
    """Local folder for tables until they are stored."""
    owner: str
    heartbeat_s: float = 10.0

    def publish_all(self) -> int:
        """Publish whatever is due; returns how many inspections."""
        done = 0
        while (ticket := self.publishing.take(self.owner)) is not None:
            try:
                done += self.publish(ticket)
            except Exception:  # noqa: BLE001 - whatever is wrong with one must not stop the others
                # Its lease runs out by itself: the others first, then this one again.
                _log.exception("publishing_failed", inspection=ticket.inspection_id)
        return done

    def publish(self, ticket: Ticket) -> bool:
        """Publish one attempt; False when its lease was lost on the way."""
        view, tasks = self.inspections.get(ticket.inspection_id), self.inspections.tasks(ticket.inspection_id)
        try:
            with self._kept(ticket) as lost:
                record, folders = record_of(view, tasks, self.results)
                with collected(record, folders, self.scratch) as wanted:
                    stored = self._store_files(ticket, wanted, lost)
            accepted = self.publishing.finish(ticket, stored, report_rows(wanted.report))
        except Cancelled:
            accepted = False
        if accepted:
            self._sweep(ticket, stored)
        _log.info(
            "published" if accepted else "publishing_refused",
            inspection=ticket.inspection_id,
            inspection_attempt=ticket.attempt,
            state=view.state,
        )
        return accepted

    @contextmanager
    def _kept(self, ticket: Ticket) -> Iterator[threading.Event]:
        """The lease, renewed in the background; the event says that it was lost."""
        lost = threading.Event()

        def renew() -> None:
            if not self.publishing.renew(ticket):
                lost.set()

        renewal = Periodic("publish lease", renew, self.heartbeat_s)
        renewal.start()
        try:
            yield lost
        finally:
            renewal.stop()

    def _store_files(self, ticket: Ticket, wanted: Collection, lost: threading.Event) -> list[Stored]:
        known = self._manifests(wanted.files.values())
        stored = []
        for path, source in (*wanted.files.items(), *wanted.tables.items()):
            if lost.is_set():
                raise Cancelled("somebody else publishes this", where=ticket.inspection_id)
            key = f"{ticket.prefix}/{path}"
            kept = self.store.link(key, source, known[source]) if source in known else self.store.put(key, source)
            stored.append(Stored(path, kept.size, kept.sha256))
            if is_of_page(path):
                self._store_compressed(key, source)
        return stored

    def _store_compressed(self, key: str, source: Path) -> None:
        """A gzipped copy beside a file of a page, made once: it is no artifact of its own."""
        target = compressed_key(key)
        if target is None:
            return
        with tempfile.TemporaryDirectory(prefix="gzip-", dir=self.scratch) as folder:
            packed = Path(folder) / "file.gz"
            packed.write_bytes(gzip.compress(source.read_bytes(), _GZIP_LEVEL, mtime=0))
            self.store.put(target, packed)

    def _manifests(self, sources: Iterable[Path]) -> dict[Path, Stored]:
        """Size and hash of files of results, from their manifests."""
        folders = {Path(*source.relative_to(self.results.root).parts[:2]) for source in sources}
        known = {}
        for folder in folders:
            manifest = self.results.find(folder.parent.name, folder.name)
            for name, entry in manifest.files.items() if manifest is not None else ():
                known[self.results.path(folder) / name] = Stored(name, int(entry["size"]), str(entry["sha256"]))
        return known

    def _sweep(self, ticket: Ticket, stored: list[Stored]) -> None:
        """Remove what earlier attempts, or a publisher that was cut off, put into the inspection's folder."""
        shown = {f"{ticket.prefix}/{file.path}" for file in stored}
        for key in self.store.list(f"inspections/{ticket.inspection_id}"):
            if uncompressed_key(key) not in shown:
                self.store.remove(key)
