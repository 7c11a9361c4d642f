"""Result folders: `<root>/<stage>/<fingerprint>/`, there whole or not at all.

A stage writes into a temporary folder beside the final one. Sealing hashes and syncs its files and writes
the manifest `result.json`; one rename makes it a result. What a crash leaves is a temporary folder, which
the next start sweeps, or a result without a row in the database, which it adopts.
"""

from __future__ import annotations

import json
import os
import shutil
import time
import uuid
from collections.abc import Callable, Collection, Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import DiskFull
from core.fingerprint import canonical_json, digest_of, digest_of_file
from core.products.contract import Facts
from core.task_key import stage_of
from store.disk import disk_is_full, sync_path

MANIFEST = "result.json"
_TEMP = ".tmp-"
_SHORT = 16
"""Characters of the fingerprint in the name of a temporary folder."""


@dataclass(frozen=True)
class Manifest:
    """What `result.json` says."""

    fingerprint: str
    stage: str
    version: int
    facts: Facts
    files: dict[str, dict[str, Any]]
    """``{"size": bytes, "sha256": hex}`` by relative path."""
    digest: str
    """SHA-256 of facts and file hashes: what later fingerprints are made from."""
    seconds: float
    """How long the stage took; not part of the digest."""
    peak_rss_bytes: int
    key: str
    """Task that computed it first."""


def age_s(folder: Path) -> float:
    """Seconds since a name was added to or taken from a folder; 0 when it has just gone."""
    with suppress(FileNotFoundError):
        return max(0.0, time.time() - folder.stat().st_mtime)
    return 0.0


def seal(folder: Path, *, fingerprint: str, key: str, version: int, facts: Facts, seconds: float, rss: int) -> Manifest:
    """Hash and sync everything a stage wrote and put the manifest beside it.

    Raises:
        DiskFull: so little space is left that native writers may have lost data unseen.
        ValueError: facts are not finite JSON.
    """
    canonical_json(facts)
    files: dict[str, dict[str, Any]] = {}
    for path in sorted(p for p in folder.rglob("*") if p.is_file()):
        sync_path(path)
        name = path.relative_to(folder).as_posix()
        files[name] = {"size": path.stat().st_size, "sha256": digest_of_file(path)}
    if disk_is_full(folder):
        raise DiskFull("no space left on the disk of the output folder", where=key)
    digest = digest_of({"facts": facts, "files": {name: entry["sha256"] for name, entry in files.items()}})
    manifest = Manifest(fingerprint, stage_of(key), version, facts, files, digest, seconds, rss, key)
    path = folder / MANIFEST
    path.write_text(json.dumps(manifest.__dict__, sort_keys=True, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    sync_path(path)
    for inner in (*(p for p in folder.rglob("*") if p.is_dir()), folder):
        sync_path(inner)
    return manifest


class ResultFolders:
    """All result folders below one root."""

    def __init__(self, root: Path) -> None:
        self.root = root
        root.mkdir(parents=True, exist_ok=True)

    def relative(self, stage: str, fingerprint: str) -> str:
        """Path of a result below the root, as the database keeps it."""
        return f"{stage}/{fingerprint}"

    def path(self, relative: str | os.PathLike[str]) -> Path:
        """Absolute folder of a result."""
        return self.root / relative

    def begin(self, stage: str, fingerprint: str) -> Path:
        """A new empty temporary folder for one attempt."""
        folder = self.root / stage / f"{_TEMP}{fingerprint[:_SHORT]}-{uuid.uuid4().hex[:12]}"
        folder.mkdir(parents=True)
        return folder

    def commit(self, temporary: Path, stage: str, fingerprint: str) -> Manifest:
        """Turn a sealed temporary folder into the result; the first of two equal results stays."""
        if self.find(stage, fingerprint) is None:
            self._keep(temporary, stage, fingerprint)
        self.discard(temporary)
        manifest = self.find(stage, fingerprint)
        if manifest is None:
            raise DiskFull(f"the result of {stage} could not be kept", where=stage)
        return manifest

    def discard(self, temporary: Path) -> None:
        """Remove a temporary folder; nothing happens when it is gone."""
        shutil.rmtree(temporary, ignore_errors=True)

    def find(self, stage: str, fingerprint: str) -> Manifest | None:
        """The manifest of a result whose files are all there in full size; else None."""
        folder = self.root / stage / fingerprint
        try:
            manifest = Manifest(**json.loads((folder / MANIFEST).read_text(encoding="utf-8")))
            whole = all((folder / name).stat().st_size == entry["size"] for name, entry in manifest.files.items())
        except (OSError, ValueError, TypeError, KeyError):
            return None
        return manifest if whole and manifest.fingerprint == fingerprint else None

    def have(self, relative: str | os.PathLike[str]) -> bool:
        """True when a result's folder is there to be read."""
        return self.path(relative).is_dir()

    def all(self) -> Iterator[Manifest]:
        """Every usable result on disk."""
        for path in sorted(self.root.glob(f"*/*/{MANIFEST}")):
            if not path.parent.name.startswith(_TEMP):
                manifest = ResultFolders.find(self, path.parent.parent.name, path.parent.name)
                if manifest is not None:
                    yield manifest

    def temporary(self) -> list[Path]:
        """Temporary folders: of attempts that run, and of those that a crash cut off."""
        return list(self.root.glob(f"*/{_TEMP}*"))

    def sweep(self, in_use: Callable[[], Collection[str]] = tuple, older_than_s: float = 0.0) -> int:
        """Remove temporary folders, but those of the fingerprints that `in_use` names; returns how many.

        `in_use` is asked after the folders were listed: an attempt has its lease before its folder.
        """
        listed = [folder for folder in self.temporary() if age_s(folder) >= older_than_s]
        kept = tuple(f"{_TEMP}{fingerprint[:_SHORT]}-" for fingerprint in in_use())
        stale = [folder for folder in listed if not folder.name.startswith(kept)]
        for folder in stale:
            shutil.rmtree(folder, ignore_errors=True)
        return len(stale)

    def unknown(self, known: Callable[[], Collection[str]], older_than_s: float) -> list[str]:
        """Relative paths of results whose fingerprint `known` does not name: a crash cut their story off."""
        listed = [path.parent for path in self.root.glob(f"*/*/{MANIFEST}") if not path.parent.name.startswith(_TEMP)]
        names = known()
        unknown = [folder for folder in listed if folder.name not in names and age_s(folder) >= older_than_s]
        return [self.relative(folder.parent.name, folder.name) for folder in unknown]

    def remove(self, stage: str, fingerprint: str) -> None:
        """Remove a result."""
        self._remove(self.root / stage / fingerprint)

    def _keep(self, temporary: Path, stage: str, fingerprint: str) -> None:
        """Give a whole folder its final name; who does so first wins, and both are equal."""
        final = self.root / stage / fingerprint
        if ResultFolders.find(self, stage, fingerprint) is None:
            self._remove(final)
            # A folder that another process puts there in this moment is whole, and not empty: this fails.
            with suppress(OSError):
                temporary.rename(final)
            sync_path(final.parent)

    def _remove(self, folder: Path) -> None:
        # Renamed first: a crash in the middle leaves a temporary folder, never half a result.
        if folder.exists():
            doomed = folder.with_name(f"{_TEMP}gone-{uuid.uuid4().hex[:12]}")
            folder.rename(doomed)
            shutil.rmtree(doomed, ignore_errors=True)
