"""One transfer of inputs by URL: its files come into uploads, as long as this process holds its lease.

What an earlier holder of the lease has left is gone on with: behind the bytes that were committed where the file has
a tag that says that it is still the same, else from the first byte on. An upload that cannot be opened, because a
process that stands still has it or it lies on another machine, gives its place to a new one.
"""

from __future__ import annotations

import threading
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field

from sqlalchemy.exc import SQLAlchemyError
from sqlalchemy.orm import Session

from api.limits import require_space
from api.services import Services
from core.errors import BadInput, BladeAtlasError
from core.fingerprint import digest_of_file
from store.bucket_inputs import SCHEME, BucketInputs
from store.downloads import Begun, Downloads, Source
from store.json_log import logger
from store.transfers import KnownFile, TransferLease, TransferLost, transfer_lost
from store.uploads import Digests, UploadFile, UploadLocked, UploadView

_COMMIT_BYTES = 64 << 20
_COMMIT_S = 1.0
"""A killed process loses at most so much of what it fetched."""
_log = logger("bladeatlas.transfers")


@dataclass
class Fetcher:
    """Fetches the files of transfers."""

    services: Services
    digests: Digests
    downloads: Downloads
    buckets: BucketInputs

    def source(self, url: str) -> Source:
        """What a URL is fetched by."""
        return self.buckets if url.startswith(SCHEME) else self.downloads

    def run(self, lease: TransferLease) -> None:
        """Fetch what is missing and write down how it ended; without the lease nothing is written any more."""
        transfers = self.services.transfers
        with self._holding(lease) as held:
            for file in lease.files:
                try:
                    self._fetch(held, file)
                except TransferLost:
                    _log.info("transfer_lost", transfer=lease.id, fence=lease.fence)
                    return
                except BladeAtlasError as error:
                    for upload_id in transfers.refuse(lease, file.number, error):
                        self.services.uploads.remove(upload_id)
                    return
            transfers.finish(lease)

    @contextmanager
    def _holding(self, lease: TransferLease) -> Iterator[_Held]:
        """Renew the lease during the block."""
        held, stopped = _Held(lease), threading.Event()

        def keep() -> None:
            while not stopped.wait(self.services.settings.heartbeat_s):
                with suppress(SQLAlchemyError):  # the database is away: the next heartbeat may find it
                    if not self.services.transfers.renew(lease):
                        held.lost.set()
                        return

        thread = threading.Thread(target=keep, name=f"transfer-{lease.id[:8]}", daemon=True)
        thread.start()
        try:
            yield held
        finally:
            stopped.set()
            thread.join()

    def _fetch(self, held: _Held, file: KnownFile) -> None:
        source = self.source(file.url)
        source.require(file.url)  # the lists may be others than when the request came
        sink = self._resumed(held, file)
        begun = None if sink is None else Begun(sink, sink.length, file.tag)

        def begin(size: int, tag: str) -> _UploadSink:
            nonlocal sink
            sink = self._begin(held, file, size, tag)
            return sink

        try:
            source.fetch(file.url, file.most_bytes, self.services.settings.fetch_seconds, begin, begun)
            sha256 = sink.finish() if sink is not None else None
        finally:
            if sink is not None:
                sink.close()
        if file.sha256 is not None and sha256 != file.sha256:
            raise BadInput(f"the file hashes to {sha256}", code="checksum", where="sha256")

    def _resumed(self, held: _Held, file: KnownFile) -> _UploadSink | None:
        """The upload that an earlier holder of the lease began; None when there is none that can be gone on with."""
        uploads = self.services.uploads
        upload = None if file.upload_id is None else uploads.find(file.upload_id, held.lease.owner)
        if upload is None or upload.removed:
            return None
        try:
            opened = UploadFile(uploads.path(upload.id), self.digests)
        except (UploadLocked, FileNotFoundError):
            return None
        opened.resume(upload.offset)
        return _UploadSink(self.services, held, file, upload, opened)

    def _begin(self, held: _Held, file: KnownFile, size: int, tag: str) -> _UploadSink:
        """A new upload for a file. For one whose place it takes the limits were asked already."""
        require_space(self.services)
        uploads, upload_id = self.services.uploads, uuid.uuid4().hex

        def admit(session: Session) -> None:
            replaced = self.services.transfers.set_upload(session, held.lease, file.number, upload_id, tag)
            if replaced != size:
                self.services.admission.admit_upload(session, held.lease.owner, size)

        upload = uploads.create(held.lease.owner, size, {}, admit, upload_id)
        if file.upload_id is not None:
            uploads.remove(file.upload_id)  # its row ended with the transaction; now its file goes
        opened = UploadFile(uploads.path(upload_id), self.digests)
        opened.resume(0)
        return _UploadSink(self.services, held, file, upload, opened)


@dataclass
class _Held:
    """A lease that is renewed."""

    lease: TransferLease
    lost: threading.Event = field(default_factory=threading.Event)


class _UploadSink:
    """Writes what comes into an upload, as long as the lease is held."""

    def __init__(
        self, services: Services, held: _Held, file: KnownFile, upload: UploadView, opened: UploadFile
    ) -> None:
        self.length = upload.length
        self._services, self._held, self._number = services, held, file.number
        self._id, self._file = upload.id, opened
        self._committed, self._committed_at = opened.offset, time.monotonic()

    @property
    def offset(self) -> int:
        return self._file.offset

    def write(self, data: bytes) -> None:
        if self._held.lost.is_set():
            raise transfer_lost()
        self._file.write(data)
        due = self._file.offset - self._committed >= _COMMIT_BYTES
        if due or time.monotonic() - self._committed_at >= _COMMIT_S:
            self._commit(None)
            require_space(self._services)

    def restart(self, tag: str) -> None:
        # The tag comes last: with the new one before the old bytes are gone, a crash would mix two files.
        self._commit_offset(0, None)
        self._file.resume(0)
        self._services.transfers.set_tag(self._held.lease, self._number, tag)

    def finish(self) -> str:
        """All is there: note its hash, and return it. What another process has fetched is read for it."""
        sha256 = self._file.sha256() or digest_of_file(self._services.uploads.path(self._id))
        self._commit(sha256)
        return sha256

    def close(self) -> None:
        self._file.close()

    def _commit(self, sha256: str | None) -> None:
        self._file.sync()
        self._commit_offset(self._file.offset, sha256)

    def _commit_offset(self, offset: int, sha256: str | None) -> None:
        if not self._services.uploads.commit(self._id, offset, sha256):
            raise BadInput("the upload of the file was removed", code="gone", where="url")
        self._committed, self._committed_at = offset, time.monotonic()
