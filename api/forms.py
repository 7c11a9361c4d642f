"""`multipart/form-data` streamed to disk: no part is ever in memory as a whole, none grows past its limit.

The bytes that are still to come are promised before the first is read; the promise is kept up to date, and given back
at the end.
"""

from __future__ import annotations

import hashlib
import re
import time
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING

from python_multipart.exceptions import MultipartParseError
from python_multipart.multipart import MultipartParser, parse_options_header

from api.limits import require_space
from api.problems import FieldError, Refused
from api.receiving import PIECE, on_disk
from api.services import Services
from core.errors import DiskFull
from core.names import unknown_name
from store.admission import Admission, FormPromise
from store.disk import NO_SPACE

if TYPE_CHECKING:
    from hashlib import _Hash

    from python_multipart.multipart import MultipartCallbacks


_STEP_BYTES = 64 << 20
_STEP_S = 10.0
"""The promise is brought up to date after so many bytes or so long; a form without a length promises in these steps."""
_DISPOSITION = b"content-disposition"
_BOUNDARY = re.compile(rb"[0-9A-Za-z'()+_,./:=? -]{1,70}")


@dataclass
class Promise:
    """The promise of one form while it comes in."""

    held: FormPromise
    size: int
    """Announced; grows with a form that did not say its length."""
    came: int = 0
    _kept_at: float = field(default_factory=time.monotonic)
    _kept: int = 0

    async def arrived(self, more: int) -> None:
        """So many bytes were written; `DiskFull` when there is no room for more than was announced."""
        self.came += more
        beyond = self.came > self.size
        if beyond:
            self.size = self.came + _STEP_BYTES
        if beyond or self.came - self._kept >= _STEP_BYTES or time.monotonic() - self._kept_at >= _STEP_S:
            await on_disk(partial(self.held.keep, self.size - self.came))
            self._kept, self._kept_at = self.came, time.monotonic()


@asynccontextmanager
async def promised(admission: Admission, owner: str, size: int) -> AsyncIterator[Promise]:
    """Promise the bytes of a form for the block.

    Raises:
        LimitReached: too many uploads are open.
        DiskFull: there is no room.
    """
    held = await on_disk(partial(admission.promise_form, owner, size))
    try:
        yield Promise(held, size)
    finally:
        await on_disk(held.end)


@dataclass
class Part:
    """One part of the form as it arrived: a file, and what its bytes hash to."""

    name: str
    path: Path
    limit: int
    """Bytes that it and the parts of the same name before it may have together."""
    before: int = 0
    """Bytes of those."""
    size: int = 0
    _digest: _Hash = field(default_factory=hashlib.sha256)
    _buffer: bytearray = field(default_factory=bytearray)

    @property
    def sha256(self) -> str:
        """Of everything that came."""
        return self._digest.hexdigest()

    def take(self, data: bytes) -> None:
        """Keep some bytes until `flush`; 413 above the limit."""
        self.size += len(data)
        if self.before + self.size > self.limit:
            detail = f"'{self.name}' may have at most {self.limit} bytes" + (" in all" if self.before else "")
            errors = [FieldError(pointer=f"/{self.name}", detail=detail)]
            status = HTTPStatus.REQUEST_ENTITY_TOO_LARGE
            raise Refused(status, "too_large", detail, where=self.name, errors=errors)
        self._buffer += data

    async def flush(self, at_least: int = 0) -> None:
        """Write what is kept once it is worth a write."""
        if len(self._buffer) > at_least:
            data, self._buffer = bytes(self._buffer), bytearray()
            await on_disk(partial(self._append, data))

    def _append(self, data: bytes) -> None:
        self._digest.update(data)
        try:
            with self.path.open("ab") as stream:
                stream.write(data)
        except OSError as error:
            if error.errno in NO_SPACE:
                raise DiskFull("the form cannot be kept: no space left on its disk", where=self.name) from error
            raise


class FormReader:
    """Reads one form; `parts` holds what came, in order. Call `discard` when it is no longer needed.

    Args:
        services: where files are kept.
        limits: bytes that the parts of each known name may have together.
        repeated: how often a part may come; those that are not named once.
    """

    def __init__(self, services: Services, limits: Mapping[str, int], repeated: Mapping[str, int]) -> None:
        self.parts: list[Part] = []
        self._services, self._limits, self._repeated = services, limits, repeated
        self._current: Part | None = None
        self._header, self._value = b"", b""
        self._disposition = b""
        self._ended = False

    async def read(self, headers: Mapping[str, str], owner: str, body: AsyncIterator[bytes]) -> None:
        """Take in the whole form; what its ``Content-Length`` promises counts against the disk meanwhile.

        Raises:
            Refused: 400 for what is no form or was cut off, 413 for a part above its limit, 422 for a part
                that is not known or comes too often.
            LimitReached, DiskFull: too many uploads are open, or there is no room for it.
        """
        parser = MultipartParser(_boundary(headers["content-type"]), callbacks=self._callbacks())
        announced = headers.get("content-length", "")
        async with promised(self._services.admission, owner, int(announced) if announced.isdigit() else 0) as promise:
            try:
                async for chunk in body:
                    for start in range(0, len(chunk), PIECE):
                        parser.write(chunk[start : start + PIECE])
                        await self._flush(PIECE)
                    await promise.arrived(len(chunk))
                    require_space(self._services)
            except MultipartParseError as error:
                raise _malformed(f"the form is malformed: {error}") from None
            if not self._ended:
                raise _malformed("the form was cut off before its end")
            await self._flush(0)

    def named(self, name: str) -> list[Part]:
        """What came under a name, in order."""
        return [part for part in self.parts if part.name == name]

    def discard(self) -> None:
        """Remove every file that came; one that was stored elsewhere lives on there."""
        for part in self.parts:
            part.path.unlink(missing_ok=True)

    async def _flush(self, at_least: int) -> None:
        for part in self.parts:
            # A finished part is written at once, so that memory holds one piece whatever the parts are.
            await part.flush(at_least if part is self._current else 0)

    def _callbacks(self) -> MultipartCallbacks:
        return {
            "on_part_begin": self._begin,
            "on_header_field": self._header_field,
            "on_header_value": self._header_value,
            "on_header_end": self._header_end,
            "on_headers_finished": self._headers_finished,
            "on_part_data": self._data,
            "on_part_end": self._end,
            "on_end": self._finish,
        }

    def _begin(self) -> None:
        self._disposition = b""

    def _header_field(self, data: bytes, start: int, end: int) -> None:
        self._header += data[start:end]

    def _header_value(self, data: bytes, start: int, end: int) -> None:
        self._value += data[start:end]

    def _header_end(self) -> None:
        if self._header.lower() == _DISPOSITION:
            self._disposition = self._value
        self._header, self._value = b"", b""

    def _headers_finished(self) -> None:
        _, options = parse_options_header(self._disposition)
        name = options.get(b"name", b"").decode("utf-8", "replace")
        there, most = self.named(name), self._repeated.get(name, 1)
        if name not in self._limits or len(there) >= most:
            often = f"the part '{name}' comes " + ("twice" if most == 1 else f"more than {most} times")
            detail = often if there else unknown_name("part", name[:64], self._limits)
            errors = [FieldError(pointer=f"/{name[:64]}", detail=detail)]
            raise Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_part", detail, where=name[:64], errors=errors)
        part = Part(name, self._services.uploads.part(), self._limits[name], sum(one.size for one in there))
        part.path.touch(mode=0o600)
        self.parts.append(part)
        self._current = part

    def _data(self, data: bytes, start: int, end: int) -> None:
        assert self._current is not None  # the parser tells the headers first
        self._current.take(data[start:end])

    def _end(self) -> None:
        self._current = None

    def _finish(self) -> None:
        self._ended = True


def _boundary(content_type: str) -> bytes:
    _, options = parse_options_header(content_type)
    boundary = options.get(b"boundary", b"")
    if not _BOUNDARY.fullmatch(boundary):
        raise _malformed("the form's content type names no boundary")
    return boundary


def _malformed(detail: str) -> Refused:
    return Refused(HTTPStatus.BAD_REQUEST, "bad_form", detail)
