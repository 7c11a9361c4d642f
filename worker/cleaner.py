"""The cleaner of a server: removes what belongs to no inspection any more, and what crashes left behind."""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from store.files import ArtifactStore, LocalInputs
from store.housekeeping import Retention
from store.inspections import Inspections
from store.json_log import logger
from store.plan import Plan
from worker.mirror import MirroredResults
from worker.results import ResultFolders

_log = logger("bladeatlas.cleaner")


@dataclass(frozen=True)
class Cleaner:
    """One round after the other; every step may be cut off, and the next round goes on."""

    retention: Retention
    inspections: Inspections
    plan: Plan
    store: ArtifactStore
    results: ResultFolders
    inputs: LocalInputs
    stale_s: float
    """Files that belong to nothing stay so long: somebody may be about to say whose they are."""

    def round(self) -> None:
        """Everything that a worker or an embedded server cleans up."""
        self.retention.expire()
        self.retention.tidy()
        for inspection_id in self.retention.to_purge():
            self.retention.purge(inspection_id)
            for folder in (f"inspections/{inspection_id}", f"logs/{inspection_id}"):
                self._remove(self.store.list(folder))
            _log.info("purged", inspection=inspection_id)
        self._sweep_results()
        self._sweep_store()
        self._evict()

    def _sweep_results(self) -> None:
        for path in self.retention.delete_unused(self.inspections.unused()):
            self.results.remove(*path.split("/", 1))
        for path in self.results.unknown(self.retention.known_fingerprints, self.stale_s):
            self.results.remove(*path.split("/", 1))
        self.results.sweep(self.plan.leased, self.stale_s)

    def _sweep_store(self) -> None:
        """Inputs, published files and logs that belong to nothing, and writes that were cut off."""
        self._sweep_below("inputs", 1, self.retention.inputs_in_use)
        self._sweep_below("inspections", 2, lambda: {_tail(path) for path in self.retention.folders_in_use()})
        self._sweep_below("logs", 1, self.retention.logs_in_use)
        self.store.sweep(self.stale_s)

    def _sweep_below(self, root: str, depth: int, in_use: Callable[[], Collection[str]]) -> None:
        """Remove old files whose first `depth` folders below `root` are not in use.

        What is in use is asked after the files were listed: who makes a file says soon whose it is.
        """
        listed = self.store.list(root)
        used = in_use()
        unused = [path for path in listed if "/".join(path.split("/")[1 : depth + 1]) not in used]
        self._remove(path for path in unused if self._is_stale(path))

    def _is_stale(self, path: str) -> bool:
        with suppress(FileNotFoundError):
            return self.store.age_s(path) >= self.stale_s
        return False

    def _remove(self, paths: Iterable[str]) -> None:
        for path in paths:
            self.store.remove(path)

    def _evict(self) -> None:
        """Local copies of what an object store holds, once nobody here needs them."""
        self.inputs.evict(self.retention.inputs_at_work(), self.stale_s)
        if isinstance(self.results, MirroredResults):
            self.results.evict(self.retention.results_at_work(), self.stale_s)


@dataclass(frozen=True)
class UploadCleaner:
    """Removes uploads that nobody used; only the machine that received them has their files."""

    retention: Retention
    folder: Path
    stale_s: float

    def round(self) -> None:
        """Mark, then remove files that belong to no living upload."""
        self.retention.expire_transfers()
        self.retention.expire_uploads()
        listed = list(self.folder.iterdir()) if self.folder.is_dir() else []
        used = self.retention.uploads_in_use()
        for path in listed:
            with suppress(FileNotFoundError):
                if path.name not in used and time.time() - path.stat().st_mtime >= self.stale_s:
                    path.unlink()


def _tail(path: str) -> str:
    return path.split("/", 1)[1]
