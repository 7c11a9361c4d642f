"""How answers travel: without a body for HEAD, gzipped for who takes that, to pages of other origins by setting.

Compression changes the representation, so it has a tag of its own: weak, because another version of zlib may write
other bytes, and the original's with `-gzip` in it. Parts of a file (`Range`) are always parts of the original, under
its own strong tag (RFC 9110, 8.8.3 and 14.2). zstd is not offered: this Python's library has none, and every client
that takes it takes gzip too.
"""

from __future__ import annotations

import re
import zlib
from collections.abc import Mapping, Sequence
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.cors import CORSMiddleware
from starlette.routing import Match
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.negotiation import accepts_gzip

_COMPRESSED = ("application/json", "application/problem+json", "application/schema+json", "text/", "image/svg+xml")
"""How media types begin of which gzip leaves little; not those that are compressed in themselves."""
_NEVER = "text/event-stream"
"""Each event must leave at once."""
_COMPRESSED_NAME = re.compile(r"\.(?:ply|glb|gltf|obj|csv|json)(?:[\"']|$)", re.IGNORECASE)
"""Files of results that are sent as bytes of no special kind, told by the name that the answer gives them."""
_LEAST = 1024
"""Bytes below which it is not worth it."""
_IN_THREAD = 1 << 16
"""A piece of so many bytes is compressed in a thread, so that others are served meanwhile."""
_LEVEL = 5
_TAG = re.compile(r'(?:W/)?"([^"]*)-gzip"')

_EXPOSED = (
    *("ETag", "Link", "Location", "Retry-After", "X-Request-Id", "Content-Range", "Content-Disposition", "Repr-Digest"),
    *("Tus-Resumable", "Tus-Version", "Tus-Extension", "Tus-Max-Size"),
    *("Upload-Offset", "Upload-Length", "Upload-Metadata", "Upload-Expires"),
)
"""What pages of other origins may read of an answer's head."""
_ALLOWED = (
    *("Authorization", "Content-Type", "Accept", "Range", "If-Range", "If-None-Match", "Idempotency-Key"),
    *("X-Request-Id", "Last-Event-ID", "X-Requested-With"),
    *("Tus-Resumable", "Upload-Offset", "Upload-Length", "Upload-Metadata"),
)
"""What they may send; cookies are none of it."""
_METHODS = ("GET", "HEAD", "POST", "PATCH", "DELETE", "OPTIONS")
_PREFLIGHT_S = 600


def install(app: FastAPI, origins: Sequence[str]) -> None:
    """Add what every answer passes through; to be called before middleware that shall see answers as they are sent."""
    app.add_middleware(CompressionMiddleware)
    app.add_middleware(HeadMiddleware)
    if origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=origins,
            allow_methods=_METHODS,
            allow_headers=_ALLOWED,
            expose_headers=_EXPOSED,
            max_age=_PREFLIGHT_S,
        )


class _Headed(Exception):
    """The head of an answer is out, and no more is wanted."""


class HeadMiddleware:
    """Answers HEAD as GET would, without the body, where no route does so itself."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Ask as GET, send the head, and end the rest: of a stream or an archive nothing more is made."""
        if scope["type"] != "http" or scope["method"] != "HEAD" or _has_own_head(scope):
            await self._app(scope, receive, send)
            return

        async def head(message: Message) -> None:
            if message["type"] != "http.response.start":
                return
            await send(message)
            await send({"type": "http.response.body", "body": b""})
            raise _Headed

        scope["method"] = "GET"
        try:
            await self._app(scope, receive, head)
        except _Headed:
            pass
        finally:
            scope["method"] = "HEAD"


def _has_own_head(scope: Scope) -> bool:
    routes = scope["app"].router.routes
    return any(route.matches(scope)[0] is Match.FULL for route in routes)


class CompressionMiddleware:
    """Gzips answers that are worth it, under a tag of their own."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, and the answer through a `_Packer`."""
        headers = Headers(scope=scope)
        if scope["type"] != "http" or not accepts_gzip(headers.get("accept-encoding")) or "range" in headers:
            await self._app(scope, receive, send)
            return
        known = headers.get("if-none-match")
        if known is not None and _TAG.search(known):
            # Whoever has the gzipped form has what the original's tag names.
            scope["headers"] = _with_originals(scope["headers"])
        await self._app(scope, receive, _Packer(send, known or "").send)


def _with_originals(headers: Sequence[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
    return [
        (
            name,
            value + b", " + b", ".join(f'"{tag}"'.encode("latin-1") for tag in _TAG.findall(value.decode("latin-1"))),
        )
        if name == b"if-none-match" and _TAG.search(value.decode("latin-1"))
        else (name, value)
        for name, value in headers
    ]


class _Packer:
    """The gzipped form of one answer, or the answer as it is where that is not worth it."""

    def __init__(self, send: Send, known: str) -> None:
        self._send, self._known = send, known
        self._start: Message | None = None
        """Held back until the first bytes tell how much there is."""
        self._packer: Any = None

    async def send(self, message: Message) -> None:
        """Send a part of the answer."""
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            if _is_worth(headers):
                headers.add_vary_header("Accept-Encoding")
                if message["status"] == HTTPStatus.OK:
                    self._start = message
                    return
            if message["status"] == HTTPStatus.NOT_MODIFIED and "etag" in headers:
                packed = packed_tag(headers["etag"])
                if packed.removeprefix("W/") in self._known:
                    headers["ETag"] = packed
            await self._send(message)
            return
        if message["type"] == "http.response.body":
            if self._start is not None:
                await self._begin(self._start, message)
                self._start = None
            if self._packer is not None:
                message = {**message, "body": await self._pack(message)}
        await self._send(message)

    async def _begin(self, start: Message, first: Message) -> None:
        """Send the head as it is now known to be."""
        if first.get("more_body", False) or len(first.get("body", b"")) >= _LEAST:
            headers = MutableHeaders(scope=start)
            headers["Content-Encoding"] = "gzip"
            for name in ("Content-Length", "Repr-Digest"):  # said of the original
                del headers[name]
            if "etag" in headers:
                headers["ETag"] = packed_tag(headers["etag"])
            self._packer = zlib.compressobj(_LEVEL, zlib.DEFLATED, 16 + zlib.MAX_WBITS)
        await self._send(start)

    async def _pack(self, message: Mapping[str, Any]) -> bytes:
        body: bytes = message.get("body", b"")
        packed: bytes
        if len(body) > _IN_THREAD:
            packed = await run_in_threadpool(self._packer.compress, body)
        else:
            packed = self._packer.compress(body)
        return packed if message.get("more_body", False) else packed + self._packer.flush()


def packed_tag(etag: str) -> str:
    """The tag of the gzipped form of what `etag` names."""
    return "W/" + re.sub(r'"$', '-gzip"', etag.removeprefix("W/"))


def _is_worth(headers: Headers) -> bool:
    kind = headers.get("content-type", "")
    if "content-encoding" in headers or kind.startswith(_NEVER):
        return False
    if int(headers.get("content-length", _LEAST)) < _LEAST:
        return False
    return kind.startswith(_COMPRESSED) or _COMPRESSED_NAME.search(headers.get("content-disposition", "")) is not None
