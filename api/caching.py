"""Conditional requests and ranges (RFC 9110), in the part of them that downloads need."""

from __future__ import annotations

import re
from dataclasses import dataclass
from http import HTTPStatus

from api.problems import Refused

_ONE_RANGE = re.compile(r"bytes=\s*(\d{0,19})\s*-\s*(\d{0,19})\s*")


def matches(header: str | None, etag: str) -> bool:
    """True when an ``If-None-Match`` names this tag; weak comparison, as for reading."""
    if header is None:
        return False
    tags = (tag.strip().removeprefix("W/") for tag in header.split(","))
    return header.strip() == "*" or etag in tags


@dataclass(frozen=True)
class Span:
    """Bytes `start` to `stop` (exclusive) of a file."""

    start: int
    stop: int


def wanted_span(header: str | None, if_range: str | None, etag: str, size: int) -> Span | None:
    """The part of a file that is asked for; None = the whole.

    Several ranges at once, another unit, or an ``If-Range`` that names another file are answered with the
    whole file, as RFC 9110 allows.

    Raises:
        Refused: 416 for a range that begins behind the end.
    """
    found = _ONE_RANGE.fullmatch(header) if header else None
    if found is None or (if_range is not None and if_range.strip() != etag):
        return None
    first, last = found[1], found[2]
    if not first and not last:
        return None
    if not first:
        start, stop = max(0, size - int(last)), size
    else:
        start, stop = int(first), min(size, int(last) + 1 if last else size)
        if last and int(last) < start:
            return None
    if start >= size or start >= stop:
        headers = {"Content-Range": f"bytes */{size}"}
        detail = f"the file has {size} bytes"
        raise Refused(HTTPStatus.REQUESTED_RANGE_NOT_SATISFIABLE, "range", detail, where="Range", headers=headers)
    return Span(start, stop)
