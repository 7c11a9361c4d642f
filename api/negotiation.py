"""Negotiation: tables as JSON or CSV, conditional requests and ranges (RFC 9110, in the part that downloads need)."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated, Any, Literal

from fastapi import Query, Request
from fastapi.responses import Response

from api.problems import Refused
from core.report.csv_form import csv_line

_ONE_RANGE = re.compile(r"bytes=\s*(\d{0,19})\s*-\s*(\d{0,19})\s*")
CSV = "text/csv; charset=utf-8"
_ENCODER = json.JSONEncoder(allow_nan=False, ensure_ascii=False)
Format = Annotated[
    Literal["json", "csv"] | None, Query(description="wins over `Accept`; without both it is JSON", examples=["csv"])
]
CSV_RESPONSE: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/csv": {"schema": {"type": "string"}, "example": "id,label\r\n0,dent\r\n"}}}
}
"""For `responses=`: the table may also come as CSV."""


def matches(header: str | None, etag: str) -> bool:
    """True when an ``If-None-Match`` names this tag; weak comparison, as for reading."""
    if header is None:
        return False
    tags = (tag.strip().removeprefix("W/") for tag in header.split(","))
    return header.strip() == "*" or etag in tags


def accepts_gzip(header: str | None) -> bool:
    """Whether an ``Accept-Encoding`` takes gzip; without the header nothing is assumed."""
    for entry in (header or "").split(","):
        name, *parameters = (part.strip().lower() for part in entry.split(";"))
        if name in ("gzip", "x-gzip"):
            return not any(part.startswith("q=") and not part[2:].strip("0.") for part in parameters)
    return False


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


def wants_csv(request: Request, asked: str | None) -> bool:
    """True when CSV was asked for by `?format=` or is the better of the two by `Accept`."""
    if asked is not None:
        return asked == "csv"
    accept = request.headers.get("accept", "")
    return _quality(accept, "text/csv") > _quality(accept, "application/json")


def _quality(accept: str, media_type: str) -> float:
    """Weight of a media type in an Accept header: the most exact entry that covers it; 0 = not wanted."""
    major = media_type.split("/", maxsplit=1)[0]
    found: dict[str, float] = {}
    for entry in accept.split(","):
        name, *parameters = (part.strip() for part in entry.split(";"))
        weights = [parameter[2:] for parameter in parameters if parameter.startswith("q=")]
        try:
            found[name.lower()] = float(weights[0]) if weights else 1.0
        except ValueError:
            found[name.lower()] = 0.0
    return next((found[name] for name in (media_type, f"{major}/*", "*/*") if name in found), 0.0)


class TableForm:
    """How the rows of a table are written: as an array of objects, or as CSV with these columns.

    `flat` makes rows of CSV from what JSON shows nested.
    """

    def __init__(
        self,
        columns: Sequence[str],
        *,
        as_csv: bool,
        flat: Callable[[Mapping[str, Any]], Mapping[str, Any]] = lambda row: row,
    ) -> None:
        self._columns, self._as_csv, self._flat = columns, as_csv, flat
        self.media_type = CSV if as_csv else "application/json"

    def begin(self) -> bytes:
        """What stands before the first row."""
        return _csv([self._columns]) if self._as_csv else b"["

    def rows(self, rows: Iterable[Mapping[str, Any]], *, first: bool) -> bytes:
        """Some rows; `first`: none was written before."""
        if self._as_csv:
            return _csv([row.get(name) for name in self._columns] for row in map(self._flat, rows))
        texts = [_ENCODER.encode(dict(row)) for row in rows]
        before = ("\n" if first else ",\n") if texts else ""
        return (before + ",\n".join(texts)).encode("utf-8", "replace")

    def end(self) -> bytes:
        """What stands behind the last row."""
        return b"" if self._as_csv else b"\n]\n"


def table(request: Request, asked: str | None, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> Response:
    """A table that is small enough for one piece."""
    form = TableForm(columns, as_csv=wants_csv(request, asked))
    body = form.begin() + form.rows(rows, first=True) + form.end()
    return Response(body, media_type=form.media_type, headers={"Vary": "Accept"})


def _csv(rows: Iterable[Sequence[Any]]) -> bytes:
    return "".join(map(csv_line, rows)).encode("utf-8", "replace")
