"""Inputs that a request names by URL: fetched beside the request, which may be sent again until they are there.

No thread and no connection of the request is held while files come in: it waits some seconds, is told that it is under
way, and takes up the same transfer when it is repeated, whichever process of the API it comes to. A fetched file is an
upload of its account, with the limits of one, and is removed once the inspection has it.
"""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus

from starlette.concurrency import run_in_threadpool

from api.problems import FieldError, Refused, status_of
from api.services import Services
from api.threads import in_daemon_thread
from api.transferring import Fetcher
from core.errors import BadInput, BladeAtlasError
from core.fingerprint import digest_of
from store.admission import LimitReached
from store.bucket_inputs import AllowedBuckets, BucketInputs
from store.downloads import AllowedHosts, Downloads
from store.integration_models import TransferState
from store.outbound import Outbound
from store.transfers import TransferView, WantedFile
from store.uploads import Digests

WAIT_S = 20.0
"""A request waits so long for its files before it is told to come back."""
_LOOK_S = 0.5
"""How often it looks how far another process is."""
_LATER = "5"


@dataclass(frozen=True)
class Wanted(WantedFile):
    """A file to fetch, and where the request names it."""

    pointer: str
    """JSON pointer to the URL in the request."""


@dataclass(frozen=True)
class _Fetch:
    """A transfer that this process carries out."""

    owner: str
    task: asyncio.Task[None]


@dataclass
class Fetches:
    """The transfers that one process carries out; what they are lies in the database."""

    services: Services
    digests: Digests
    wait_s: float = WAIT_S
    fetcher: Fetcher = field(init=False)
    _under_way: dict[str, _Fetch] = field(default_factory=dict)

    def __post_init__(self) -> None:
        settings = self.services.settings
        downloads = Downloads(Outbound(settings.allowed_networks()), AllowedHosts.parse(settings.input_hosts))
        buckets = BucketInputs(AllowedBuckets.parse(settings.input_buckets), settings.storage_options())
        self.fetcher = Fetcher(self.services, self.digests, downloads, buckets)

    async def uploads(self, owner: str, wanted: Sequence[Wanted]) -> list[str]:
        """Ids of uploads with these files, in their order; `done` follows once they are not needed any more.

        Raises:
            Refused: 409 `fetching`, not all are there yet: the same request takes them up; 422 or 413 with the place
                of the URL that cannot be had.
            LimitReached: as many transfers are under way as may be.
        """
        for one in wanted:
            try:
                self.fetcher.source(one.url).require(one.url)  # in vain nobody's place is taken
            except BadInput as error:
                raise _refused(one, error) from None
        name, until = _name(owner, wanted), time.monotonic() + self.wait_s
        await run_in_threadpool(self._remove, partial(self.services.transfers.ask, name))
        while True:
            view = await run_in_threadpool(self._look, name, owner)
            if view is not None and view.state == TransferState.FETCHED:
                return list(view.uploads)
            if view is not None and view.error is not None:
                await run_in_threadpool(self._remove, partial(self.services.transfers.end, name))
                raise _refused(wanted[view.failed], view.error)  # who asks again begins anew
            fetch = self._fetch_of(name, owner, wanted, view)  # before the time is looked at: no request is for nothing
            left = until - time.monotonic()
            if left <= 0:
                raise _under_way(view)
            await _something_new(fetch, left)

    async def done(self, owner: str, wanted: Sequence[Wanted]) -> None:
        """The files of this request were taken over: their uploads end."""
        await run_in_threadpool(self._remove, partial(self.services.transfers.end, _name(owner, wanted)))

    def _fetch_of(self, name: str, owner: str, wanted: Sequence[Wanted], view: TransferView | None) -> _Fetch | None:
        """The transfer as this process carries it out, also when nobody does yet; None when it is another's.

        Raises:
            LimitReached: it is new, and as many are under way as may be.
        """
        fetch = self._under_way.get(name)
        if fetch is not None or not (view is None or view.free):
            return fetch
        full = self._full(owner)
        if full is None:
            task = asyncio.create_task(self._run(name, owner, wanted, known=view is not None))
            fetch = self._under_way[name] = _Fetch(owner, task)
        elif view is None:
            raise full
        return fetch

    async def _run(self, name: str, owner: str, wanted: Sequence[Wanted], *, known: bool) -> None:
        """Carry out a transfer, one that is known under a new lease."""
        transfers = self.services.transfers
        take = transfers.take if known else partial(transfers.begin, owner=owner, files=wanted)

        def run() -> None:
            lease = take(name, holder=self.services.name)
            if lease is not None:
                self.fetcher.run(lease)

        try:
            await in_daemon_thread(run)
        finally:
            del self._under_way[name]

    def _full(self, owner: str) -> LimitReached | None:
        """Why this process carries out no more transfers now; None when it does."""
        running = [fetch.owner for fetch in self._under_way.values()]
        settings = self.services.settings
        for used, allowed, name, suffix in (
            (len(running), settings.max_fetches, "max_fetches", ""),
            (running.count(owner), settings.max_fetches_per_owner, "max_fetches_per_owner", "_of_owner"),
        ):
            if used >= allowed:
                message = f"{used} requests fetch inputs already, and {name} is {allowed}; try again later"
                return LimitReached(message, code=f"too_many_fetches{suffix}", where=name)
        return None

    def _look(self, name: str, owner: str) -> TransferView | None:
        """How far a transfer is; one whose files are gone, or lie on another machine, ends, and there is none."""
        view, uploads = self.services.transfers.find(name), self.services.uploads
        if view is None or view.state != TransferState.FETCHED:
            return view
        found = [uploads.find(upload_id, owner) for upload_id in view.uploads]
        if all(one is not None and not one.removed and one.complete for one in found):
            return view
        self._remove(partial(self.services.transfers.end, name))
        return None

    def _remove(self, end: Callable[[], Sequence[str]]) -> None:
        """Remove the files of the uploads that a change in the database ended."""
        for upload_id in end():
            self.services.uploads.remove(upload_id)


async def _something_new(fetch: _Fetch | None, seconds: float) -> None:
    """Wait until a transfer is over, or until it is worth to look how far another process is."""
    if fetch is None:
        await asyncio.sleep(min(_LOOK_S, seconds))
        return
    done, _ = await asyncio.wait((fetch.task,), timeout=seconds)
    if done:
        fetch.task.result()  # raises what nobody expects


def _name(owner: str, wanted: Sequence[Wanted]) -> str:
    return digest_of({"owner": owner, "files": [[one.url, one.sha256] for one in wanted]})


def _under_way(view: TransferView | None) -> Refused:
    came, size = (0, 0) if view is None else (view.came, view.size)
    detail = f"{came} of {size} bytes are here; send the same request again to go on"
    return Refused(HTTPStatus.CONFLICT, "fetching", detail, headers={"Retry-After": _LATER}, retryable=True)


def _refused(one: Wanted, error: BladeAtlasError) -> BladeAtlasError | Refused:
    """The error with the place of the URL; limits and a full disk stay what they are."""
    if isinstance(error, LimitReached) or status_of(error) == HTTPStatus.INSUFFICIENT_STORAGE:
        return error
    too_large = error.code == "too_large"
    status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE if too_large else HTTPStatus.UNPROCESSABLE_ENTITY
    errors = [FieldError(pointer=one.pointer, detail=error.message)]
    return Refused(status, error.code, error.message, where=one.pointer, errors=errors, retryable=error.retryable)
