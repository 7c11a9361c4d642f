"""Files that are fetched from servers which a setting names: by https, resumed where a transfer was cut.

Every request, that of a redirect included, is held against the list of hosts and goes through `store.outbound`.
"""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from http import HTTPStatus
from typing import Protocol
from urllib.parse import urljoin

import httpcore

from core.errors import BadInput
from store.outbound import Outbound, Unreachable, parse_url

_REDIRECTS = 5
TRIES = 5
"""Requests in a row that bring no byte, and it is given up."""
_PAUSE_S = 1.0
_SILENCE_S = 30.0
_PIECE = 1 << 20
_HTTPS = 443
_MOVED = (
    *(HTTPStatus.MOVED_PERMANENTLY, HTTPStatus.FOUND, HTTPStatus.SEE_OTHER),
    *(HTTPStatus.TEMPORARY_REDIRECT, HTTPStatus.PERMANENT_REDIRECT),
)
_AGAIN = (
    *(HTTPStatus.TOO_MANY_REQUESTS, HTTPStatus.BAD_GATEWAY),
    *(HTTPStatus.SERVICE_UNAVAILABLE, HTTPStatus.GATEWAY_TIMEOUT),
)
MAX_TAG = 256
"""Characters of a tag that is used; a file with a longer one is fetched anew after a cut."""
_RANGE = re.compile(r"bytes (\d{1,18})-\d{1,18}/(\d{1,18})")


class Sink(Protocol):
    """Where the bytes go: knows how many it has, and can begin anew."""

    @property
    def offset(self) -> int:
        """Bytes so far."""
        ...

    def write(self, data: bytes) -> None:
        """Take more."""
        ...

    def restart(self, tag: str) -> None:
        """Delete all of them; what comes now is of the file with this tag."""
        ...


@dataclass(frozen=True)
class Begun:
    """A file of which an earlier transfer brought a part."""

    sink: Sink
    length: int
    tag: str
    """What the file had when its first byte came; empty: there was none, and it begins anew."""


class Source(Protocol):
    """A kind of place that files are fetched from."""

    def require(self, url: str) -> None:
        """Pass a URL that may be fetched; BadInput otherwise, before anything is asked of anybody."""
        ...

    def fetch(
        self, url: str, most_bytes: int, seconds: float, begin: Callable[[int, str], Sink], begun: Begun | None = None
    ) -> None:
        """Fetch a file as a whole, or what is missing of one that was begun.

        `begin` gives what takes its bytes once its size is known and allowed; it is told size and tag. It is not
        called for one that was begun.
        """
        ...


@dataclass(frozen=True)
class AllowedHosts:
    """Hosts that files may be fetched from: ``host``, ``host:port`` or ``*.domain``; without a port, 443."""

    entries: frozenset[tuple[str, int]]

    @classmethod
    def parse(cls, text: str) -> AllowedHosts:
        """The list that a setting holds, separated by commas; ValueError for a port that is none."""
        found = set()
        for entry in filter(None, (part.strip().lower() for part in text.split(","))):
            host, _, port = entry.partition(":")
            found.add((host, int(port) if port else _HTTPS))
        return cls(frozenset(found))

    def require(self, url: str) -> None:
        """Pass a URL whose host is in the list.

        Raises:
            BadInput: `bad_url`; `insecure_url` without TLS; `host_not_allowed`, it is not, or the list is empty.
        """
        parts = parse_url(url)
        if parts.scheme != "https":
            raise BadInput("files are fetched by https only", code="insecure_url", where="url")
        host, port = (parts.hostname or "").rstrip("."), parts.port or _HTTPS
        domains = [f"*.{host.split('.', number)[number]}" for number in range(1, host.count(".") + 1)]
        if not any((name, port) in self.entries for name in (host, *domains)):
            said = "input_hosts has it not" if self.entries else "this server fetches none (input_hosts is empty)"
            message = f"files are not fetched from '{host}:{port}': {said}"
            raise BadInput(message, code="host_not_allowed", where="url")


@dataclass(frozen=True)
class Downloads:
    """Fetches files."""

    outbound: Outbound
    hosts: AllowedHosts
    sleep: Callable[[float], None] = time.sleep

    def require(self, url: str) -> None:
        """Pass a URL that may be fetched; see `AllowedHosts.require`."""
        self.hosts.require(url)

    def fetch(
        self, url: str, most_bytes: int, seconds: float, begin: Callable[[int, str], Sink], begun: Begun | None = None
    ) -> None:
        """Fetch a file as a whole, or what is missing of one that was begun.

        Args:
            most_bytes: of the file.
            seconds: for all that is fetched now.
            begin: called with its size and tag once the size is known and allowed; gives what takes the bytes.
            begun: what an earlier transfer has left.

        Raises:
            BadInput: it may not be fetched from there, is too large (`too_large`), of no known size (`no_length`), is
                refused there (`fetch_refused`), changes while it is fetched (`fetch_changed`), or takes too long
                (`fetch_timeout`).
            Unreachable: the server is away, or cuts the transfer again and again.
        """
        transfer = _Transfer(self, url, most_bytes, time.monotonic() + seconds, begin)
        if begun is not None:
            transfer.sink, transfer.length, transfer.validator = begun.sink, begun.length, begun.tag
        transfer.run()


@dataclass
class _Transfer:
    """One file on its way."""

    downloads: Downloads
    url: str
    most_bytes: int
    until: float
    begin: Callable[[int, str], Sink]
    sink: Sink | None = None
    length: int = 0
    validator: str = ""
    _failures: int = field(default=0)

    def run(self) -> None:
        while self.sink is None or self.sink.offset < self.length:
            had = self.sink.offset if self.sink is not None else 0
            try:
                self._request()
            except Unreachable as error:
                if time.monotonic() >= self.until:
                    raise took_too_long() from None
                gained = self.sink is not None and self.sink.offset > had
                self._failures = 0 if gained else self._failures + 1
                if self._failures >= TRIES or error.code == "unknown_host":
                    raise
                self.downloads.sleep(min(_PAUSE_S * 2**self._failures, max(0.0, self.until - time.monotonic())))

    def _request(self) -> None:
        """Ask once for what is missing, through redirects."""
        url = self.url
        for _ in range(_REDIRECTS + 1):
            self.downloads.hosts.require(url)
            left = self.until - time.monotonic()
            if left <= 0:
                raise took_too_long()
            with self.downloads.outbound.call("GET", url, self._headers(), left, silence_s=_SILENCE_S) as answer:
                headers = {name.decode("latin-1").lower(): value.decode("latin-1") for name, value in answer.headers}
                if answer.status not in _MOVED:
                    self._take(answer, headers)
                    return
                url = urljoin(url, headers.get("location", ""))
        raise BadInput(f"more than {_REDIRECTS} redirects", code="fetch_refused", where="url")

    def _headers(self) -> Mapping[str, str]:
        headers = {"Accept-Encoding": "identity", "User-Agent": "bladeatlas"}
        if self.sink is not None and self.sink.offset and self.validator:
            headers |= {"Range": f"bytes={self.sink.offset}-", "If-Range": self.validator}
        return headers

    def _take(self, answer: httpcore.Response, headers: Mapping[str, str]) -> None:
        if answer.status in _AGAIN:
            raise Unreachable(f"the server of the file answers {answer.status}", where="url")
        if answer.status not in (HTTPStatus.OK, HTTPStatus.PARTIAL_CONTENT):
            raise BadInput(f"the server of the file answers {answer.status}", code="fetch_refused", where="url")
        (start, length), tag = _extent(answer.status, headers), _validator(headers)
        if self.sink is None:
            if length > self.most_bytes:
                raise too_large(length, self.most_bytes)
            self.length, self.validator, self.sink = length, tag, self.begin(length, tag)
        elif length != self.length:
            raise changed()
        other = not start and tag != self.validator
        if start != self.sink.offset or other:  # the whole file again: no ranges, or it is not the same any more
            if start:
                raise changed()
            self.sink.restart(tag)
        self.validator = tag
        self._read(answer, self.sink)

    def _read(self, answer: httpcore.Response, sink: Sink) -> None:
        buffer = bytearray()
        try:
            for chunk in answer.iter_stream():
                buffer += chunk
                if sink.offset + len(buffer) > self.length:
                    raise changed()
                if len(buffer) >= _PIECE:
                    sink.write(bytes(buffer))
                    buffer.clear()
        finally:  # what came of a transfer that was cut counts
            if buffer and sink.offset + len(buffer) <= self.length:
                sink.write(bytes(buffer))


def _extent(status: int, headers: Mapping[str, str]) -> tuple[int, int]:
    """Where the bytes of an answer begin in the file, and how long that is."""
    if headers.get("content-encoding", "identity") != "identity":
        raise BadInput("the server of the file sends it compressed", code="no_length", where="url")
    if status == HTTPStatus.PARTIAL_CONTENT:
        form = _RANGE.fullmatch(headers.get("content-range", ""))
        if form is None:
            raise changed()
        return int(form[1]), int(form[2])
    length = headers.get("content-length", "")
    if not (length.isascii() and length.isdigit() and len(length) < 19):
        raise BadInput("the server of the file does not say how long it is", code="no_length", where="url")
    return 0, int(length)


def _validator(headers: Mapping[str, str]) -> str:
    """What says that two answers are of the same file: a strong tag; without one it is fetched anew after a cut."""
    tag = headers.get("etag", "")
    return tag if tag.startswith('"') and len(tag) <= MAX_TAG else ""


def too_large(size: int, most: int) -> BadInput:
    """It has more bytes than it may."""
    return BadInput(f"the file has {size} bytes; at most {most} are taken", code="too_large", where="url")


def changed() -> BadInput:
    """What came first and what came later are not of one file."""
    return BadInput("the file changed while it was fetched", code="fetch_changed", where="url")


def took_too_long() -> BadInput:
    """The time for all of it is over."""
    return BadInput("fetching the file took longer than fetch_seconds", code="fetch_timeout", where="url")
