"""Inputs that lie in buckets which a setting names: fetched through the client of the artifact store's S3 server.

Every account may read what these buckets hold, so the artifact store's own part of a bucket is never one of them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, TypeVar

import fsspec
from tenacity import Retrying, retry_if_exception_type, stop_after_attempt

from core.errors import BadInput
from store.downloads import MAX_TAG, TRIES, Begun, Sink, changed, too_large, took_too_long
from store.outbound import MAX_URL, Unreachable

T = TypeVar("T")

SCHEME = "s3://"
_PIECE = 8 << 20
"""Bytes of one request."""
_PAUSE_S = 1.0
_SILENCE_S = 30


@dataclass(frozen=True)
class AllowedBuckets:
    """Buckets, or parts of buckets, that inputs may be fetched from: ``bucket`` or ``bucket/prefix``."""

    entries: tuple[str, ...]
    """Each with a slash at its end."""

    @classmethod
    def parse(cls, text: str) -> AllowedBuckets:
        """The list that a setting holds, separated by commas."""
        return cls(tuple(f"{part.strip().rstrip('/')}/" for part in text.split(",") if part.strip()))

    def place(self, url: str) -> str:
        """``bucket/key`` of a URL that is allowed.

        Raises:
            BadInput: `bad_url`; `bucket_not_allowed`, it is in none of them, or the list is empty.
        """
        place = url.removeprefix(SCHEME)
        bucket, _, path = place.partition("/")
        parts = path.split("/")
        # A server that keeps files in folders would take these for other places than S3 does.
        if not bucket or not path or len(url) > MAX_URL or not url.isprintable() or {"", ".", ".."} & set(parts):
            message = f"this is no file in a bucket: s3://bucket/key of at most {MAX_URL} characters"
            raise BadInput(message, code="bad_url", where="url")
        if not any(place.startswith(entry) for entry in self.entries):
            none = "this server fetches from none (input_buckets is empty)"
            said = "input_buckets has it not" if self.entries else none
            message = f"files are not fetched from the bucket '{bucket}': {said}"
            raise BadInput(message, code="bucket_not_allowed", where="url")
        return place


@dataclass(frozen=True)
class BucketInputs:
    """Fetches files of buckets."""

    buckets: AllowedBuckets
    options: Mapping[str, Any] = field(default_factory=dict, repr=False)
    """What fsspec must know to reach the server."""
    sleep: Callable[[float], None] = time.sleep

    def require(self, url: str) -> None:
        """Pass a URL that may be fetched; see `AllowedBuckets.place`."""
        self.buckets.place(url)

    def fetch(
        self, url: str, most_bytes: int, seconds: float, begin: Callable[[int, str], Sink], begun: Begun | None = None
    ) -> None:
        """Fetch a file as a whole, or what is missing of it, as `store.downloads.Downloads.fetch` does.

        Raises:
            BadInput: it may not be fetched from there, is not there or may not be read (`fetch_refused`), is too large
                (`too_large`), changes while it is fetched (`fetch_changed`), or takes too long (`fetch_timeout`).
            Unreachable: the server is away, again and again.
        """
        place, until = self.buckets.place(url), time.monotonic() + seconds
        files = self._files()
        size, tag = self._again(until, lambda: _identity(files, place))
        if size > most_bytes:
            raise too_large(size, most_bytes)
        sink = begin(size, tag) if begun is None else _resumed(begun, size, tag)
        while sink.offset < size:
            end = min(sink.offset + _PIECE, size)
            data = self._again(until, lambda end=end: files.cat_file(place, start=sink.offset, end=end))  # type: ignore[misc]
            if len(data) != end - sink.offset:
                raise changed()
            sink.write(data)
        if self._again(until, lambda: _identity(files, place)) != (size, tag):
            raise changed()  # its pieces may be of two files

    def _files(self) -> Any:
        config = {"connect_timeout": _SILENCE_S, "read_timeout": _SILENCE_S}
        told = {**self.options, "config_kwargs": {**config, **self.options.get("config_kwargs", {})}}
        return fsspec.filesystem("s3", use_listings_cache=False, skip_instance_cache=True, **told)

    def _again(self, until: float, ask: Callable[[], T]) -> T:
        """The answer to a request that may be sent again."""

        def once() -> T:
            if time.monotonic() >= until:
                raise took_too_long()
            with _said():
                return ask()

        policy = Retrying(
            retry=retry_if_exception_type(Unreachable),
            wait=lambda state: min(_PAUSE_S * 2**state.attempt_number, max(0.0, until - time.monotonic())),
            stop=stop_after_attempt(TRIES),
            sleep=self.sleep,
            reraise=True,
        )
        return policy(once)


def _identity(files: Any, place: str) -> tuple[int, str]:
    """Size and tag of a file as the server tells them now."""
    told = files.info(place, refresh=True)
    if told["type"] != "file":
        raise FileNotFoundError(place)
    tag = str(told.get("ETag", ""))
    return int(told["size"]), tag if len(tag) <= MAX_TAG else ""


def _resumed(begun: Begun, size: int, tag: str) -> Sink:
    """What takes the rest of a file; all of it when it is not surely the one that was begun."""
    if size != begun.length:
        raise changed()
    if not tag or tag != begun.tag:
        begun.sink.restart(tag)
    return begun.sink


@contextmanager
def _said() -> Iterator[None]:
    """The errors of the client in our words; its own may name the server or the key that it uses."""
    from botocore.exceptions import BotoCoreError  # with the first file: servers without buckets need none of it

    try:
        yield
    except FileNotFoundError:
        raise BadInput("there is no such file in the bucket", code="fetch_refused", where="url") from None
    except PermissionError:
        raise BadInput("the server may not read this file", code="fetch_refused", where="url") from None
    except (OSError, BotoCoreError) as error:
        raise Unreachable(f"the server of the bucket does not answer: {type(error).__name__}", where="url") from None
