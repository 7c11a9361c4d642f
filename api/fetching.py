"""Inputs that a request names by URL: fetched beside the request, which may be sent again until they are there.

No thread and no connection of the request is held while files come in: it waits some seconds, is told that it is under
way, and takes up the same transfer when it is repeated. A fetched file is an upload of its account, with the limits of
one, and is removed once the inspection has it.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus

from starlette.concurrency import run_in_threadpool

from api.limits import require_space
from api.problems import FieldError, Refused, status_of
from api.services import Services
from api.threads import in_daemon_thread
from core.errors import BadInput, BladeAtlasError
from core.fingerprint import digest_of
from store.admission import LimitReached
from store.bucket_inputs import SCHEME, AllowedBuckets, BucketInputs
from store.downloads import AllowedHosts, Downloads, Source
from store.outbound import Outbound
from store.uploads import Digests, UploadFile, UploadView

WAIT_S = 20.0
"""A request waits so long for its files before it is told to come back."""
_KEPT_S = 900.0
"""What nobody asked for again is given up after this."""
_COMMIT_BYTES = 64 << 20
_LATER = "5"


@dataclass(frozen=True)
class Wanted:
    """A file to fetch."""

    pointer: str
    """JSON pointer to the URL in the request."""
    url: str
    sha256: str | None
    """What it must hash to."""
    most_bytes: int


@dataclass
class _Fetch:
    """The files of one request on their way."""

    owner: str
    task: asyncio.Task[list[str]]
    sizes: list[int] = field(default_factory=list)
    came: int = 0
    asked_at: float = 0.0


@dataclass
class Fetches:
    """All transfers of one process."""

    services: Services
    digests: Digests
    wait_s: float = WAIT_S
    clock: Callable[[], float] = time.monotonic
    downloads: Downloads = field(init=False)
    buckets: BucketInputs = field(init=False)
    _under_way: dict[str, _Fetch] = field(default_factory=dict)

    def __post_init__(self) -> None:
        settings = self.services.settings
        outbound = Outbound(settings.allowed_networks())
        self.downloads = Downloads(outbound, AllowedHosts.parse(settings.input_hosts))
        self.buckets = BucketInputs(AllowedBuckets.parse(settings.input_buckets), settings.storage_options())

    async def uploads(self, owner: str, wanted: Sequence[Wanted]) -> list[str]:
        """Ids of uploads with these files, in their order; `done` follows once they are not needed any more.

        Raises:
            Refused: 409 `fetching`, not all are there yet: the same request takes them up; 422 or 413 with the place
                of the URL that cannot be had.
            LimitReached: as many transfers are under way as may be.
        """
        for one in wanted:
            try:
                self._source(one.url).require(one.url)  # in vain nobody's place is taken
            except BadInput as error:
                raise _refused(one, error) from None
        self._delete_old()
        name = _name(owner, wanted)
        fetch = self._under_way.get(name)
        if fetch is None:
            self._require_place(owner)
            fetch = _Fetch(owner, asyncio.create_task(self._fetch_all(name, owner, wanted)))
            self._under_way[name] = fetch
        fetch.asked_at = self.clock()
        done, _ = await asyncio.wait((fetch.task,), timeout=self.wait_s)
        if not done:
            detail = f"{fetch.came} of {sum(fetch.sizes)} bytes are here; send the same request again to go on"
            headers = {"Retry-After": _LATER}
            raise Refused(HTTPStatus.CONFLICT, "fetching", detail, headers=headers, retryable=True)
        if fetch.task.exception() is not None and self._under_way.get(name) is fetch:
            del self._under_way[name]  # who asks again begins anew
        return fetch.task.result()

    async def done(self, owner: str, wanted: Sequence[Wanted]) -> None:
        """The files of this request were taken over: their uploads end."""
        fetch = self._under_way.pop(_name(owner, wanted), None)
        if fetch is not None:
            await run_in_threadpool(partial(self._remove, fetch.task.result()))

    def _source(self, url: str) -> Source:
        return self.buckets if url.startswith(SCHEME) else self.downloads

    def _delete_old(self) -> None:
        """Drop files that were not used soon: at their URL there may be others by now."""
        for name, fetch in list(self._under_way.items()):
            if fetch.task.done() and self.clock() - fetch.asked_at > _KEPT_S:
                del self._under_way[name]  # its uploads end by their own time

    def _require_place(self, owner: str) -> None:
        running = [fetch.owner for fetch in self._under_way.values() if not fetch.task.done()]
        settings = self.services.settings
        for used, allowed, name, suffix in (
            (len(running), settings.max_fetches, "max_fetches", ""),
            (running.count(owner), settings.max_fetches_per_owner, "max_fetches_per_owner", "_of_owner"),
        ):
            if used >= allowed:
                message = f"{used} requests fetch inputs already, and {name} is {allowed}; try again later"
                raise LimitReached(message, code=f"too_many_fetches{suffix}", where=name)

    async def _fetch_all(self, name: str, owner: str, wanted: Sequence[Wanted]) -> list[str]:
        made: list[str] = []
        try:
            for one in wanted:
                await in_daemon_thread(partial(self._fetch, name, owner, one, made))
        except BaseException:
            self._remove(made)
            raise
        return made

    def _fetch(self, name: str, owner: str, one: Wanted, made: list[str]) -> None:
        """Fetch one file into an upload, whose id is added to `made`."""
        seconds = self.services.settings.fetch_seconds
        sink: _UploadSink | None = None

        def begin(size: int) -> _UploadSink:
            nonlocal sink
            require_space(self.services)
            admit = partial(self.services.admission.admit_upload, owner=owner, size=size)
            upload = self.services.uploads.create(owner, size, {}, admit)
            made.append(upload.id)
            fetch = self._under_way[name]
            fetch.sizes.append(size)
            sink = _UploadSink(self.services, upload, self.digests, fetch)
            return sink

        try:
            self._source(one.url).fetch(one.url, one.most_bytes, seconds, begin)
            sha256 = sink.finish() if sink is not None else None
        except BladeAtlasError as error:
            raise _refused(one, error) from None
        finally:
            if sink is not None:
                sink.close()
        if one.sha256 is not None and sha256 != one.sha256:
            raise _refused(one, BadInput(f"the file hashes to {sha256}", code="checksum", where="sha256"))

    def _remove(self, uploads: Sequence[str]) -> None:
        for upload_id in uploads:
            self.services.uploads.remove(upload_id)


class _UploadSink:
    """Writes what comes into an upload."""

    def __init__(self, services: Services, upload: UploadView, digests: Digests, fetch: _Fetch) -> None:
        self._services, self._upload, self._fetch = services, upload, fetch
        self._before = fetch.came
        self._committed = 0
        self._file = UploadFile(services.uploads.path(upload.id), digests)
        self._file.resume(0)

    @property
    def offset(self) -> int:
        return self._file.offset

    def write(self, data: bytes) -> None:
        self._file.write(data)
        self._fetch.came = self._before + self._file.offset
        if self._file.offset - self._committed >= _COMMIT_BYTES:
            self._commit(None)
            require_space(self._services)

    def restart(self) -> None:
        self._commit_offset(0, None)
        self._file.resume(0)

    def finish(self) -> str | None:
        """All is there: note its hash, and return it."""
        sha256 = self._file.sha256()
        self._commit(sha256)
        return sha256

    def close(self) -> None:
        self._file.close()

    def _commit(self, sha256: str | None) -> None:
        self._file.sync()
        self._commit_offset(self._file.offset, sha256)

    def _commit_offset(self, offset: int, sha256: str | None) -> None:
        if not self._services.uploads.commit(self._upload.id, offset, sha256):
            raise BadInput("the upload of the file was removed", code="gone", where="url")
        self._committed = offset


def _name(owner: str, wanted: Sequence[Wanted]) -> str:
    return digest_of({"owner": owner, "files": [[one.url, one.sha256] for one in wanted]})


def _refused(one: Wanted, error: BladeAtlasError) -> BladeAtlasError | Refused:
    """The error with the place of the URL; limits and a full disk stay what they are."""
    if isinstance(error, LimitReached) or status_of(error) == HTTPStatus.INSUFFICIENT_STORAGE:
        return error
    too_large = error.code == "too_large"
    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE if too_large else HTTPStatus.UNPROCESSABLE_ENTITY
    errors = [FieldError(pointer=one.pointer, detail=error.message)]
    return Refused(status, error.code, error.message, where=one.pointer, errors=errors, retryable=error.retryable)
