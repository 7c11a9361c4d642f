"""The bytes of one upload while somebody writes to them: locked, positioned, and hashed on the way.

The lock is the kernel's (flock), so it holds between processes and ends with whoever held it, kill -9 included.
It is taken on the descriptor that is written through, by hand: filelock locks files of its own beside the data, which
would be left over for every upload, and `tidy` would have to know them.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections import OrderedDict
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Self

from core.errors import BladeAtlasError, DiskFull
from store.disk import NO_SPACE

if TYPE_CHECKING:
    from hashlib import _Hash

_REMEMBERED = 256


class UploadLocked(BladeAtlasError):
    """Another request writes to this upload."""

    code = "upload_locked"
    retryable = True


@dataclass
class Digests:
    """Hashes of what uploads hold so far, so that a file that came in several requests need not be read again."""

    _known: OrderedDict[str, tuple[int, _Hash]] = field(default_factory=OrderedDict)

    def take(self, name: str, offset: int) -> _Hash | None:
        """The hash of the first `offset` bytes; None when it is not known."""
        at, digest = self._known.pop(name, (0, hashlib.sha256()))
        return digest if at == offset else None

    def keep(self, name: str, offset: int, digest: _Hash | None) -> None:
        """Remember the hash of the first `offset` bytes; the longest unused one is forgotten."""
        if digest is not None:
            self._known[name] = (offset, digest)
            while len(self._known) > _REMEMBERED:
                self._known.popitem(last=False)


class UploadFile:
    """One upload's file, opened and locked; use as a context manager.

    Raises:
        UploadLocked: another request has it.
        FileNotFoundError: it was removed.
    """

    def __init__(self, path: Path, digests: Digests) -> None:
        self._name, self._digests = path.name, digests
        self._digest: _Hash | None = None
        self.offset = 0
        self._descriptor = os.open(path, os.O_RDWR)
        try:
            fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(self._descriptor)
            raise UploadLocked("another request is writing to this upload", where=path.name) from None

    def resume(self, committed: int) -> None:
        """Go on behind the bytes that were committed and are there."""
        # What lies behind the offset was never confirmed: it may be torn, and goes.
        self.offset = min(committed, os.fstat(self._descriptor).st_size)
        os.ftruncate(self._descriptor, self.offset)
        self._digest = self._digests.take(self._name, self.offset)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let go of the file; its lock ends."""
        self._digests.keep(self._name, self.offset, self._digest)
        os.close(self._descriptor)

    def write(self, data: bytes | bytearray) -> None:
        """Write at the offset and move it; `DiskFull` when the disk takes no more."""
        view = memoryview(data)
        try:
            while view:
                written = os.pwrite(self._descriptor, view, self.offset)
                if self._digest is not None:
                    self._digest.update(view[:written])
                self.offset += written
                view = view[written:]
        except OSError as error:
            raise _as_expected(error) from error

    def sync(self) -> None:
        """Bring everything written to the disk; only then may the offset be committed."""
        try:
            os.fdatasync(self._descriptor)
        except OSError as error:
            raise _as_expected(error) from error

    def sha256(self) -> str | None:
        """Hash of everything written, when it was followed from the first byte on."""
        return self._digest.hexdigest() if self._digest is not None else None


def _as_expected(error: OSError) -> Exception:
    if error.errno in NO_SPACE:
        return DiskFull("the upload cannot be written: no space left on its disk", where="upload")
    return error
