"""The storage port: files by relative path, written whole or not at all, with size and SHA-256; inputs among them.

One class serves every file system that fsspec knows. On a local folder a write goes to a temporary name, is
synced and renamed; object stores make a whole object visible at its end by themselves. Inputs of an object store are
fetched to a local file that a stage can open.
"""

from __future__ import annotations

import hashlib
import os
import time
import uuid
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path, PurePosixPath
from typing import IO, Any

import fsspec
from fsspec.implementations.local import LocalFileSystem

from core.errors import BadInput, ResourceError
from core.fingerprint import digest_of_file
from core.videos import Recording
from store.disk import sync_path
from store.records import InputFiles

_CHUNK = 1 << 20
_PART = ".part-"
UNREACHABLE = "store_unreachable"
"""Code of the error that waiting may mend."""


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
            self._silence: tuple[type[Exception], ...] = ()
        else:
            from botocore.exceptions import BotoCoreError

            self._silence = (BotoCoreError,)
            # Others write to the same store: what it held a minute ago is no answer.
            self._fs, self._root = fsspec.core.url_to_fs(root, use_listings_cache=False, **options)
        self._local = isinstance(self._fs, LocalFileSystem)

    @property
    def folder(self) -> Path | None:
        """The root as a local folder; None for an object store."""
        return Path(self._root) if self._local else None

    def prepare(self) -> None:
        """Make the root when it is missing, a bucket included, and try whether files can be written below it.

        Raises:
            ResourceError: they cannot, or nobody answers.
        """
        name = f".tried-{uuid.uuid4().hex}"
        try:
            with self._answering():
                root = self._root if self._local else self._root.partition("/")[0]
                if not self._fs.exists(root):
                    self._fs.makedirs(root, exist_ok=True)
                self._fs.pipe_file(f"{self._root.rstrip('/')}/{name}", b"")
                self._fs.rm_file(f"{self._root.rstrip('/')}/{name}")
        except OSError as error:
            message = f"the artifact store cannot be written: {error.strerror or error}"
            raise ResourceError(message, code=UNREACHABLE, where="store") from None

    def put(self, path: str, source: Path) -> Stored:
        """Store a copy of the file `source` under `path`, replacing what was there in one step."""
        target = self._full(path)
        if not self._local:
            digest, size = digest_of_file(source), source.stat().st_size
            with self._answering():
                self._fs.put_file(str(source), target)
            return Stored(path, size, digest)
        with source.open("rb") as read, _written_whole(Path(target)) as part, part.open("wb") as write:
            digest, size = _copy(read, write)
            write.flush()
            os.fsync(write.fileno())
        return Stored(path, size, digest)

    def link(self, path: str, source: Path, known: Stored) -> Stored:
        """Store a file that never changes and whose hash is known: on one file system without copying a byte."""
        return Stored(path, known.size, known.sha256) if self._linked(path, source) else self.put(path, source)

    def adopt(self, path: str, source: Path) -> None:
        """Store a file whose bytes nobody changes any more, without a copy where the disk allows it."""
        if self._local:
            sync_path(source)
        if not self._linked(path, source):
            self.put(path, source)

    def fetch(self, path: str, target: Path, sha256: str) -> None:
        """Copy a stored file to the local file `target`, there whole or not at all.

        Raises:
            FileNotFoundError: there is none.
            ResourceError: it is not the file that `sha256` names.
        """
        full = self._full(path)
        with _written_whole(target) as part:
            with self._answering():
                self._fs.get_file(full, str(part))
            if digest_of_file(part) != sha256:
                raise ResourceError(f"'{path}' in the store is damaged", code="damaged_file", where=path)
            sync_path(part)

    @contextmanager
    def open(self, path: str) -> Iterator[IO[bytes]]:
        """Read a file; FileNotFoundError when there is none."""
        with self._answering(), self._fs.open(self._full(path), "rb") as stream:
            yield stream

    def exists(self, path: str) -> bool:
        """True for a stored file."""
        with self._answering():
            return bool(self._fs.isfile(self._full(path)))

    def size(self, path: str) -> int:
        """Bytes of a stored file."""
        with self._answering():
            return int(self._fs.size(self._full(path)))

    def age_s(self, path: str) -> float:
        """Seconds since a file was last written or linked; FileNotFoundError when there is none."""
        if self._local:
            return time.time() - Path(self._full(path)).stat().st_ctime
        with self._answering():
            modified: datetime = self._fs.modified(self._full(path))
        # The memory file system of tests says UTC without a zone.
        return (datetime.now(UTC) - (modified if modified.tzinfo else modified.replace(tzinfo=UTC))).total_seconds()

    def remove(self, path: str) -> None:
        """Remove a file; nothing happens when there is none."""
        with self._answering(), suppress(FileNotFoundError):
            self._fs.rm_file(self._full(path))
            self._prune(path)

    def list(self, below: str = "") -> list[str]:
        """Relative paths of all files (below a folder), sorted; temporary files of writes are not files."""
        return sorted(name for name in self._find(below) if not PurePosixPath(name).name.startswith(_PART))

    def sweep(self, older_than_s: float = 0.0) -> int:
        """Remove what writes left behind that were cut off; returns how many files."""
        stale = [name for name in self._find("") if PurePosixPath(name).name.startswith(_PART)]
        removed = 0
        for name in stale:
            with suppress(FileNotFoundError):
                if self.age_s(name) >= older_than_s:
                    self.remove(name)
                    removed += 1
        return removed

    def _find(self, below: str) -> Sequence[str]:
        root = self._root.rstrip("/") + "/"
        with self._answering(), suppress(FileNotFoundError):
            return [str(name).removeprefix(root) for name in self._fs.find(self._full(below) if below else self._root)]
        return []

    @contextmanager
    def _answering(self) -> Iterator[None]:
        """Say in our own words that an object store does not answer."""
        try:
            yield
        except self._silence as error:
            raise ResourceError(f"the object store does not answer: {error}", code=UNREACHABLE, where="store") from None

    def _linked(self, path: str, source: Path) -> bool:
        """Try to give a local file a second name; False on another disk, or one without links."""
        if self._local:
            with suppress(OSError), _written_whole(Path(self._full(path)), lambda part: part.hardlink_to(source)):
                return True
        return False

    def _prune(self, path: str) -> None:
        """Remove the folders that a removed file left empty, as an object store has none."""
        if self._local:
            for folder in PurePosixPath(path).parents[:-1]:
                try:
                    Path(self._full(str(folder))).rmdir()
                except OSError:
                    return

    def _full(self, path: str) -> str:
        parts = PurePosixPath(path)
        if parts.is_absolute() or ".." in parts.parts or not parts.parts:
            raise BadInput(f"'{path}' is not a path inside the store", code="bad_path", where="artifact")
        return f"{self._root.rstrip('/')}/{parts}"


@contextmanager
def _written_whole(final: Path, begin: Callable[[Path], None] = Path.touch) -> Iterator[Path]:
    """A temporary name beside `final`, made by `begin`, that becomes it when the block ends well."""
    part = _begun(final, begin)
    try:
        yield part
        part.replace(final)
        part.unlink(missing_ok=True)  # between two names of one file a rename does nothing
        sync_path(final.parent)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


def _begun(final: Path, begin: Callable[[Path], None]) -> Path:
    """The temporary file; somebody who removes the last file of a folder may take the folder away under us."""
    for tries_left in reversed(range(5)):
        part = final.with_name(f"{_PART}{uuid.uuid4().hex}")
        final.parent.mkdir(parents=True, exist_ok=True)
        try:
            begin(part)
        except FileNotFoundError:
            if not tries_left:
                raise
        else:
            break
    return part


def _copy(read: IO[bytes], write: IO[bytes]) -> tuple[str, int]:
    digest, size = hashlib.sha256(), 0
    while chunk := read.read(_CHUNK):
        digest.update(chunk)
        size += write.write(chunk)
    return digest.hexdigest(), size


def input_key(sha256: str, role: str) -> str:
    """Where an input lies in the artifact store; `role` is ``video`` or ``annotations``."""
    return f"inputs/{sha256}/{role}"


@dataclass(frozen=True)
class LocalInputs:
    """Resolves the inputs of an inspection; those of `bladeatlas run` are local paths already."""

    store: ArtifactStore | None = None
    cache: Path | None = None
    """Where inputs from an object store are kept as long as an inspection uses them."""

    def recording(self, files: InputFiles, *, video: bool, annotations: bool) -> Recording:
        """A video and its annotations as local files.

        Args:
            files: in the store.
            video: False = only its name is asked for; nothing is downloaded.
            annotations: the same of them.

        Raises:
            FileNotFoundError: one is gone from the store.
            ResourceError: what the store holds is damaged.
        """
        notes = None
        if files.annotations is not None and files.annotations_sha256 is not None:
            notes = self._local(files.annotations, files.annotations_sha256, annotations)
        return Recording(self._local(files.video, files.video_sha256, video), notes)

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
