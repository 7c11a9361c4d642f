"""The storage port: files by relative path, written whole or not at all, with size and SHA-256.

One class serves every file system that fsspec knows. On a local folder a write goes to a temporary name, is
synced and renamed; object stores make a whole object visible at its end by themselves.
"""

from __future__ import annotations

import hashlib
import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Any

import fsspec
from fsspec.implementations.local import LocalFileSystem

from core.errors import BadInput
from store.disk import sync_path

_CHUNK = 1 << 20


@dataclass(frozen=True)
class Stored:
    """One stored file."""

    path: str
    size: int
    sha256: str


class ArtifactStore:
    """Files below one root: a local folder as a `Path`, or a URL, e.g. ``s3://bucket/prefix``."""

    def __init__(self, root: Path | str, **options: Any) -> None:
        if isinstance(root, Path):  # never read as a URL: a folder may have any name
            self._fs, self._root = LocalFileSystem(), str(root.absolute())
        else:
            self._fs, self._root = fsspec.core.url_to_fs(root, **options)
        self._local = isinstance(self._fs, LocalFileSystem)

    def put(self, path: str, source: Path) -> Stored:
        """Store a copy of the file `source` under `path`, replacing what was there in one step."""
        target = self._full(path)
        with source.open("rb") as read, self._writer(target) as write:
            digest, size = _copy(read, write)
        return Stored(path, size, digest)

    def adopt(self, path: str, source: Path) -> None:
        """Store the file `source`, whose bytes nobody changes any more, without a copy where the disk allows it."""
        if not self._local:
            self.put(path, source)
            return
        final = Path(self._full(path))
        final.parent.mkdir(parents=True, exist_ok=True)
        part = final.with_name(f".part-{uuid.uuid4().hex}")
        try:
            sync_path(source)
            os.link(source, part)
        except OSError:  # another disk, or one without links
            self.put(path, source)
            return
        part.replace(final)
        part.unlink(missing_ok=True)  # between two names of one file a rename does nothing
        sync_path(final.parent)

    @contextmanager
    def open(self, path: str) -> Iterator[IO[bytes]]:
        """Read a file; FileNotFoundError when there is none."""
        with self._fs.open(self._full(path), "rb") as stream:
            yield stream

    def exists(self, path: str) -> bool:
        """True for a stored file."""
        return bool(self._fs.isfile(self._full(path)))

    def size(self, path: str) -> int:
        """Bytes of a stored file."""
        return int(self._fs.size(self._full(path)))

    def remove(self, path: str) -> None:
        """Remove a file; nothing happens when there is none."""
        with suppress(FileNotFoundError):
            self._fs.rm_file(self._full(path))

    def list(self, below: str = "") -> list[str]:
        """Relative paths of all files, or of those below a folder, sorted.

        Temporary files of writes that were cut off are not files.
        """
        root = self._root.rstrip("/") + "/"
        found = (str(name).removeprefix(root) for name in self._fs.find(self._full(below) if below else self._root))
        return sorted(name for name in found if not PurePosixPath(name).name.startswith(".part-"))

    def sweep(self) -> int:
        """Remove what writes left behind that were cut off; returns how many files."""
        stale = [name for name in self._fs.find(self._root) if PurePosixPath(name).name.startswith(".part-")]
        for name in stale:
            self._fs.rm_file(name)
        return len(stale)

    def _full(self, path: str) -> str:
        parts = PurePosixPath(path)
        if parts.is_absolute() or ".." in parts.parts or not parts.parts:
            raise BadInput(f"'{path}' is not a path inside the store", code="bad_path", where="artifact")
        return f"{self._root.rstrip('/')}/{parts}"

    @contextmanager
    def _writer(self, target: str) -> Iterator[IO[bytes]]:
        if not self._local:
            with self._fs.open(target, "wb") as stream:
                yield stream
            return
        final = Path(target)
        final.parent.mkdir(parents=True, exist_ok=True)
        part = final.with_name(f".part-{uuid.uuid4().hex}")
        try:
            with part.open("wb") as stream:
                yield stream
                stream.flush()
                os.fsync(stream.fileno())
            part.replace(final)
            sync_path(final.parent)
        except BaseException:
            part.unlink(missing_ok=True)
            raise


def _copy(read: IO[bytes], write: IO[bytes]) -> tuple[str, int]:
    digest, size = hashlib.sha256(), 0
    while chunk := read.read(_CHUNK):
        digest.update(chunk)
        size += write.write(chunk)
    return digest.hexdigest(), size
