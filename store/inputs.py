"""Input files by key of the artifact store, as local files that a stage can open."""

from __future__ import annotations

import os
import time
from collections.abc import Collection
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from store.artifacts import ArtifactStore
from store.records import InputFiles


def input_key(sha256: str, role: str) -> str:
    """Where an input lies in the artifact store; `role` is ``video`` or ``annotations``."""
    return f"inputs/{sha256}/{role}"


@dataclass(frozen=True)
class LocalInputs:
    """Resolves the inputs of an inspection; those of `bladeatlas run` are local paths already."""

    store: ArtifactStore | None = None
    cache: Path | None = None
    """Where inputs from an object store are kept as long as an inspection uses them."""

    def video(self, files: InputFiles, needed: bool) -> Path:
        """The video as a local file.

        Args:
            needed: False = only its name is asked for; nothing is downloaded.

        Raises:
            FileNotFoundError: it is gone from the store.
            ResourceError: what the store holds is damaged.
        """
        return self._local(files.video, files.video_sha256, needed)

    def annotations(self, files: InputFiles, needed: bool) -> Path | None:
        """The annotations, the same way; None when the inspection has none."""
        if files.annotations is None or files.annotations_sha256 is None:
            return None
        return self._local(files.annotations, files.annotations_sha256, needed)

    def evict(self, used: Collection[str], older_than_s: float) -> int:
        """Remove cached files whose hash nobody uses and that were not opened lately; returns how many."""
        removed = 0
        for path in self.cache.iterdir() if self.cache is not None and self.cache.is_dir() else ():
            with suppress(FileNotFoundError):
                if path.name not in used and time.time() - path.stat().st_mtime >= older_than_s:
                    path.unlink()
                    removed += 1
        return removed

    def _local(self, key: str, sha256: str, needed: bool) -> Path:
        if self.store is None or Path(key).is_absolute():
            return Path(key)
        if self.store.folder is not None:
            return self.store.folder / key
        assert self.cache is not None, "inputs of an object store need a folder to lie in"
        path = self.cache / sha256
        if needed and path.is_file():
            os.utime(path)
        elif needed:
            self.store.fetch(key, path, sha256)
        return path
