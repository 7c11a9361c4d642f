"""Bytes from the network to the disk: a piece in memory at a time, and nothing confirmed that is not on disk."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncIterator, Coroutine
from functools import partial
from http import HTTPStatus
from typing import Any, TypeVar

from fastapi import Request
from starlette.requests import ClientDisconnect

from api.limits import require_space
from api.problems import Refused
from api.services import Services
from api.state import State
from api.threads import LimitedThreads
from store.uploads import UploadFile, UploadView

T = TypeVar("T")

PIECE = 1 << 20
_COMMIT_EVERY_BYTES = 64 << 20
_COMMIT_EVERY_S = 2.0
"""A killed server loses at most so much of what a client sent."""
_SILENCE_S = 60.0
"""Seconds without a byte after which a client is taken as gone, so that its upload is free for the next request."""
_DISK_THREADS = 8
"""Threads that wait for disks: a few, so that many uploads leave threads to those who only ask."""


on_disk = LimitedThreads(_DISK_THREADS).run
"""Run a call that waits for the disk in a thread."""


async def body_of(request: Request) -> AsyncIterator[bytes]:
    """Pieces of the body as they come; ends early when the client goes or falls silent."""
    stream = request.stream()
    while True:
        try:
            async with asyncio.timeout(_SILENCE_S):
                chunk = await anext(stream)
        except (StopAsyncIteration, ClientDisconnect, TimeoutError):
            return
        if chunk:
            yield chunk


async def while_there(request: Request, work: Coroutine[Any, Any, T]) -> T:
    """Await `work` as long as the client of a request whose body was read is there; then it is cancelled.

    Raises:
        Refused: the client went away; nobody reads it.
    """
    working, going = asyncio.ensure_future(work), asyncio.ensure_future(_gone(request))
    try:
        await asyncio.wait((working, going), return_when=asyncio.FIRST_COMPLETED)
        if working.done():
            return working.result()
        raise Refused(HTTPStatus.REQUEST_TIMEOUT, "client_gone", "the client went away before its turn came")
    finally:
        for task in (working, going):
            task.cancel()
        await asyncio.gather(working, going, return_exceptions=True)


async def _gone(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


class _Writer:
    """Writes one piece while the next one comes in."""

    def __init__(self, services: Services, upload: UploadView, file: UploadFile) -> None:
        self._services, self._upload, self._file = services, upload, file
        self._under_way: asyncio.Future[None] | None = None
        self._committed, self._committed_at = file.offset, time.monotonic()

    async def write(self, piece: bytes) -> None:
        """Hand over a piece, once the one before is written."""
        await self._settle()
        self._under_way = asyncio.ensure_future(on_disk(partial(self._store, piece)))

    async def finish(self) -> None:
        """Everything that was handed over is on disk and committed."""
        await self._settle()
        await on_disk(self._commit)

    async def _settle(self) -> None:
        under_way, self._under_way = self._under_way, None
        if under_way is not None:
            await under_way

    def _store(self, piece: bytes) -> None:
        self._file.write(piece)
        due = self._file.offset - self._committed >= _COMMIT_EVERY_BYTES
        if due or time.monotonic() - self._committed_at >= _COMMIT_EVERY_S:
            self._commit()
            require_space(self._services)

    def _commit(self) -> None:
        file = self._file
        if file.offset == self._committed and file.offset < self._upload.length:
            return
        file.sync()  # before the commit: a committed byte is on disk, whatever happens to the power
        digest = file.sha256() if file.offset == self._upload.length else None
        if not self._services.uploads.commit(self._upload.id, file.offset, digest):
            raise Refused(HTTPStatus.GONE, "gone", "this upload was removed")
        self._committed, self._committed_at = file.offset, time.monotonic()


async def receive_patch(request: Request, state: State, upload: UploadView, declared: int) -> int:
    """Append the body of a PATCH to an upload; returns the offset that is safe.

    Raises:
        Refused: 409 when `declared` is not the offset, 413 for more bytes than were announced.
        UploadLocked: another request writes to it.
        DiskFull: the reserve of the disk is reached; what arrived before is kept.
    """
    _require_fit(upload, declared, request.headers.get("content-length"))
    with await on_disk(partial(_open, state, upload)) as file:
        if declared != file.offset:
            headers = {"Upload-Offset": str(file.offset)}
            detail = f"the upload stands at {file.offset}, not at {declared}"
            raise Refused(HTTPStatus.CONFLICT, "offset", detail, where="Upload-Offset", headers=headers)
        writer, room = _Writer(state.services, upload, file), upload.length - file.offset
        buffer = bytearray()
        try:
            async for chunk in body_of(request):
                room -= len(chunk)
                if room < 0:
                    raise _too_much(upload)
                buffer += chunk
                if len(buffer) >= PIECE:
                    await writer.write(bytes(buffer))
                    buffer.clear()
            if buffer:
                await writer.write(bytes(buffer))
        finally:
            await writer.finish()
        return file.offset


def _open(state: State, upload: UploadView) -> UploadFile:
    """The file, locked first and asked for its offset then: another request may just have moved it."""
    uploads = state.services.uploads
    try:
        file = UploadFile(uploads.path(upload.id), state.digests)
    except FileNotFoundError:
        raise Refused(HTTPStatus.GONE, "gone", "this upload was removed") from None
    try:
        now = uploads.find(upload.id, upload.owner)
        if now is None or now.removed:
            raise Refused(HTTPStatus.GONE, "gone", "this upload was removed")
        file.resume(now.offset)
    except BaseException:
        file.close()
        raise
    return file


def _require_fit(upload: UploadView, declared: int, content_length: str | None) -> None:
    """Refuse a body that is known to be too long before any of it is read."""
    if content_length and content_length.isdigit() and declared + int(content_length) > upload.length:
        raise _too_much(upload)


def _too_much(upload: UploadView) -> Refused:
    detail = f"more bytes than the announced {upload.length}"
    return Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "too_large", detail, where="Upload-Length")
