"""Results in an object store: a local folder as before, filled from the store and copied into it.

A result is uploaded with its manifest last, so whoever finds the manifest finds everything. It counts as
finished only after that: any worker on any machine can go on from it.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Collection
from contextlib import suppress
from pathlib import Path

from store.files import ArtifactStore
from store.settings import DeploymentSettings
from worker.results import MANIFEST, Manifest, ResultFolders, age_s


class MirroredResults(ResultFolders):
    """Result folders whose truth is in an object store, below ``results/``."""

    def __init__(self, root: Path, store: ArtifactStore) -> None:
        super().__init__(root)
        self._store = store

    def find(self, stage: str, fingerprint: str) -> Manifest | None:
        """The manifest of a result that is whole here and in the store; else None."""
        manifest = super().find(stage, fingerprint)
        if manifest is None:
            return super().find(stage, fingerprint) if self._download(stage, fingerprint) else None
        if self._store.exists(self._stored(stage, fingerprint, MANIFEST)):
            return manifest
        if self._mark(stage, fingerprint).exists():
            # It was there once, so it was removed: what is forgotten everywhere must not come back from here.
            self._remove_local(stage, fingerprint)
            return None
        self._upload(manifest)
        return manifest

    def have(self, relative: str | os.PathLike[str]) -> bool:
        """True when a result's folder is here, downloaded when it was not."""
        if super().have(relative):
            return True
        stage, fingerprint = Path(relative).parts
        return self._download(stage, fingerprint)

    def remove(self, stage: str, fingerprint: str) -> None:
        """Remove a result here and in the store, there the manifest first."""
        self._remove_local(stage, fingerprint)
        self._store.remove(self._stored(stage, fingerprint, MANIFEST))
        for path in self._store.list(f"results/{self.relative(stage, fingerprint)}"):
            self._store.remove(path)

    def unknown(self, known: Callable[[], Collection[str]], older_than_s: float) -> list[str]:
        """The same here and in the store."""
        found = super().unknown(known, older_than_s)
        listed = {tuple(path.split("/")[1:3]): path for path in self._store.list("results")}
        names = known()
        for (stage, fingerprint), path in listed.items():
            with suppress(FileNotFoundError):
                if fingerprint not in names and self._store.age_s(path) >= older_than_s:
                    found.append(self.relative(stage, fingerprint))
        return sorted(set(found))

    def evict(self, used: Collection[str], older_than_s: float) -> int:
        """Remove local copies of results whose relative path nobody needs here any more; returns how many."""
        removed = 0
        for path in self.root.glob(f"*/*/{MANIFEST}"):
            folder = path.parent
            name = self.relative(folder.parent.name, folder.name)
            if name not in used and age_s(folder) >= older_than_s:
                self._remove_local(folder.parent.name, folder.name)
                removed += 1
        return removed

    def _stored(self, stage: str, fingerprint: str, name: str) -> str:
        return f"results/{self.relative(stage, fingerprint)}/{name}"

    def _mark(self, stage: str, fingerprint: str) -> Path:
        """A file that says: the store has had this result."""
        return self.root / stage / f".mirrored-{fingerprint}"

    def _remove_local(self, stage: str, fingerprint: str) -> None:
        super().remove(stage, fingerprint)
        self._mark(stage, fingerprint).unlink(missing_ok=True)

    def _upload(self, manifest: Manifest) -> None:
        folder = self.path(self.relative(manifest.stage, manifest.fingerprint))
        for name in (*manifest.files, MANIFEST):
            self._store.put(self._stored(manifest.stage, manifest.fingerprint, name), folder / name)
        self._mark(manifest.stage, manifest.fingerprint).touch()

    def _download(self, stage: str, fingerprint: str) -> bool:
        """Fetch a result, whole or not at all; False when the store has none."""
        try:
            with self._store.open(self._stored(stage, fingerprint, MANIFEST)) as stream:
                text = stream.read()
        except FileNotFoundError:
            return False
        files = json.loads(text)["files"]
        temporary = self.begin(stage, fingerprint)
        try:
            for name, entry in files.items():
                self._store.fetch(self._stored(stage, fingerprint, name), temporary / name, entry["sha256"])
            (temporary / MANIFEST).write_bytes(text)
            self._keep(temporary, stage, fingerprint)
            self._mark(stage, fingerprint).touch()
        except FileNotFoundError:
            return False  # removed while we read: it was not needed by anybody
        finally:
            self.discard(temporary)
        return True


def open_results(settings: DeploymentSettings, store: ArtifactStore) -> ResultFolders:
    """Result folders of a server: inside the artifact store when that is a folder, so there is one copy."""
    if store.folder is not None:
        return ResultFolders(store.folder / "results")
    return MirroredResults(settings.folder("results"), store)
