"""Publishing into the folder of a local run, under the names of the contract, each file whole or not at all.

Files first, tables then, `summary.json` last. What an earlier run published and this one did not is removed.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from core.report.build import Report
from core.report.record import RunRecord
from store.artifacts import ArtifactStore, Stored
from worker.publish import collected

_LIST = "published.json"


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
