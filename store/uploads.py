"""Resumable uploads: rows that say what is surely on disk, and the bytes beside them under the row's id.

Whoever writes to an upload holds a lock of the kernel (flock), which holds between processes and ends with its
holder, kill -9 included. It is taken on the descriptor that is written through, by hand: filelock locks files of its
own beside the data, which would be left over for every upload.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
import uuid
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta
from enum import StrEnum
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

from sqlalchemy import and_, or_, select, update
from sqlalchemy.orm import Session

from core.errors import BladeAtlasError, DiskFull
from core.fingerprint import digest_of_file
from store.cursors import moment_cursor, read_moment_cursor
from store.db import Database
from store.disk import NO_SPACE, sync_path
from store.leasing import changed
from store.models import Upload

if TYPE_CHECKING:
    from hashlib import _Hash


_REMEMBERED = 256
_NAME = "uploads"
_PART = "form-"
"""Begin of the names of files that came in a form: they have no row and live as long as their request."""


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


class UploadState(StrEnum):
    """Whether all bytes of an upload have arrived."""

    OPEN = "open"
    FINISHED = "finished"


@dataclass(frozen=True)
class UploadView:
    """An upload as others may see it."""

    id: str
    owner: str
    length: int
    offset: int
    """Bytes that are surely on disk: at most what was committed, and at most what the file holds."""
    metadata: Mapping[str, Any]
    sha256: str | None
    """Of the whole file; None until it is whole and was read once."""
    removed: bool
    """True also of one whose time is over, whether or not the cleaner came by."""
    created_at: datetime
    updated_at: datetime
    expires_at: datetime | None
    """When it ends, finished or not; None = never."""

    @property
    def complete(self) -> bool:
        """True once every byte is there."""
        return self.offset == self.length

    @property
    def state(self) -> UploadState:
        """Finished once every byte is there."""
        return UploadState.FINISHED if self.complete else UploadState.OPEN


@dataclass(frozen=True)
class UploadPage:
    """Some uploads and how to get the next."""

    uploads: Sequence[UploadView]
    cursor: str | None


@dataclass(frozen=True)
class Uploads:
    """All uploads of one folder."""

    db: Database
    folder: Path
    keep_hours: float = 72.0

    def path(self, upload_id: str) -> Path:
        """Where the bytes of an upload lie."""
        return self.folder / upload_id

    def part(self) -> Path:
        """A new name for a file that comes in a form."""
        self.folder.mkdir(parents=True, exist_ok=True)
        return self.folder / f"{_PART}{uuid.uuid4().hex}"

    def create(
        self,
        owner: str,
        length: int,
        metadata: Mapping[str, str],
        admit: Callable[[Session], None] | None = None,
        upload_id: str | None = None,
    ) -> UploadView:
        """A new upload of `length` bytes. The file is there before the row, so that a row never lacks its file.

        `admit` is called in the transaction that makes the row; what it raises leaves nothing behind. An id that
        `admit` must know is given.
        """
        upload_id = upload_id or uuid.uuid4().hex
        return self._create(
            upload_id, lambda path: path.touch(mode=0o600, exist_ok=False), owner, length, metadata, admit
        )

    def create_from(
        self,
        source: Path,
        sha256: str,
        owner: str,
        metadata: Mapping[str, str],
        admit: Callable[[Session], None] | None = None,
    ) -> UploadView:
        """A finished upload of a file that never changes and lies on the same disk; not a byte is copied.

        Raises:
            OSError: the file was removed, or the disk cannot give it a second name.
        """
        os.utime(source)  # a new name with an old time would look to the cleaner like one that belongs to nothing
        length = source.stat().st_size
        upload_id = uuid.uuid4().hex
        return self._create(upload_id, lambda path: path.hardlink_to(source), owner, length, metadata, admit, sha256)

    def _create(
        self,
        upload_id: str,
        begin: Callable[[Path], None],
        owner: str,
        length: int,
        metadata: Mapping[str, str],
        admit: Callable[[Session], None] | None,
        sha256: str | None = None,
    ) -> UploadView:
        """Make the file with `begin`, then the row; a file whose hash is known is whole."""
        self.folder.mkdir(parents=True, exist_ok=True)
        begin(self.path(upload_id))
        try:
            sync_path(self.folder)
            return self._insert(upload_id, owner, length, metadata, admit, sha256)
        except BaseException:
            self.path(upload_id).unlink(missing_ok=True)
            raise

    def _insert(
        self,
        upload_id: str,
        owner: str,
        length: int,
        metadata: Mapping[str, str],
        admit: Callable[[Session], None] | None,
        sha256: str | None,
    ) -> UploadView:
        with self.db.write() as session:
            if admit is not None:
                admit(session)
            now = self.db.now(session)
            row = Upload(
                id=upload_id,
                owner=owner,
                length=length,
                offset=0 if sha256 is None else length,
                sha256=sha256,
                upload_metadata=dict(metadata),
                created_at=now,
                updated_at=now,
                expires_at=now + timedelta(hours=self.keep_hours),
            )
            session.add(row)
        return _view(row, now)

    def find(self, upload_id: str, owner: str) -> UploadView | None:
        """An upload of this owner; None when there is none. A removed one is found, with its mark."""
        with self.db.read() as session:
            row, now = session.get(Upload, upload_id), self.db.now(session)
        return None if row is None or row.owner != owner else self._on_disk(_view(row, now))

    def page(self, owner: str, state: UploadState | None, limit: int, cursor: str | None) -> UploadPage:
        """Uploads of this owner that were not removed, newest first; `BadInput` for a cursor that is none of ours."""
        query = select(Upload).where(Upload.owner == owner, Upload.removed_at.is_(None))
        if state is not None:
            finished = Upload.offset == Upload.length
            query = query.where(finished if state == UploadState.FINISHED else ~finished)
        if cursor is not None:
            created_at, upload_id = read_moment_cursor(_NAME, cursor)
            same = and_(Upload.created_at == created_at, Upload.id < upload_id)
            query = query.where(or_(Upload.created_at < created_at, same))
        with self.db.read() as session:
            now = self.db.now(session)
            query = query.where(or_(Upload.expires_at.is_(None), Upload.expires_at > now))
            query = query.order_by(Upload.created_at.desc(), Upload.id.desc())
            views = [_view(row, now) for row in session.scalars(query.limit(limit + 1))]
        last = views[limit - 1] if len(views) > limit else None
        shown = [self._on_disk(view) for view in views[:limit]]
        return UploadPage(shown, None if last is None else moment_cursor(_NAME, last.created_at, last.id))

    def _on_disk(self, view: UploadView) -> UploadView:
        """As the file says: bytes that it lacks are not safe, and without it there is no upload."""
        try:
            size = self.path(view.id).stat().st_size
        except FileNotFoundError:
            return replace(view, offset=0, removed=True)
        return replace(view, offset=min(view.offset, size))

    def find_content(self, owner: str, length: int, sha256: str) -> UploadView | None:
        """A finished upload of this owner with this content, kept from now on as long as a new one; None without any.

        One whose hash is not known yet is read for it.
        """
        with self.db.read() as session:
            alive = (Upload.removed_at.is_(None), Upload.expires_at > self.db.now(session))
            whole = (Upload.owner == owner, Upload.length == length, Upload.offset == length)
            rows = session.scalars(select(Upload).where(*whole, *alive).order_by(Upload.expires_at.desc())).all()
        for row in sorted(rows, key=lambda one: one.sha256 is None):
            if row.sha256 in (sha256, None) and self._holds(row, sha256) and self._renew(row.id):
                return self.find(row.id, owner)
        return None

    def _holds(self, row: Upload, sha256: str) -> bool:
        """True when all of the upload's file is there and hashes so; a hash that was not known is noted."""
        path = self.path(row.id)
        try:
            if path.stat().st_size != row.length:
                return False
            found = row.sha256 or digest_of_file(path)
        except FileNotFoundError:
            return False
        if row.sha256 is None:
            self.commit(row.id, row.length, found)
        return found == sha256

    def _renew(self, upload_id: str) -> bool:
        """Begin the time of an upload anew; False when it was removed meanwhile."""
        with self.db.write() as session:
            where, now = (Upload.id == upload_id, Upload.removed_at.is_(None)), self.db.now(session)
            values = {"updated_at": now, "expires_at": now + timedelta(hours=self.keep_hours)}
            return changed(session, update(Upload).where(*where).values(**values))

    def commit(self, upload_id: str, offset: int, sha256: str | None = None) -> bool:
        """Note that `offset` bytes are on disk for certain; False when the upload was removed meanwhile."""
        values: dict[str, Any] = {"offset": offset}
        if sha256 is not None:
            values["sha256"] = sha256
        with self.db.write() as session:
            where = (Upload.id == upload_id, Upload.removed_at.is_(None))
            return changed(session, update(Upload).where(*where).values(updated_at=self.db.now(session), **values))

    def remove(self, upload_id: str) -> None:
        """End an upload; its row stays, so that its id answers 410."""
        with self.db.write() as session:
            where = (Upload.id == upload_id, Upload.removed_at.is_(None))
            changed(session, update(Upload).where(*where).values(removed_at=self.db.now(session)))
        self.path(upload_id).unlink(missing_ok=True)


def _view(row: Upload, now: datetime) -> UploadView:
    return UploadView(
        id=row.id,
        owner=row.owner,
        length=row.length,
        offset=row.offset,
        metadata=dict(row.upload_metadata),
        sha256=row.sha256,
        removed=row.removed_at is not None or (row.expires_at is not None and row.expires_at <= now),
        created_at=row.created_at,
        updated_at=row.updated_at,
        expires_at=row.expires_at,
    )
