"""Tables as JSON or CSV, whichever is asked for, streamed row by row."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Annotated, Any, Literal

from fastapi import Query, Request
from fastapi.responses import Response, StreamingResponse

from core.report.csv_form import csv_line

CSV = "text/csv; charset=utf-8"
_PIECE = 1 << 16

Format = Annotated[
    Literal["json", "csv"] | None, Query(description="wins over `Accept`; without both it is JSON", examples=["csv"])
]
CSV_RESPONSE: dict[int | str, dict[str, Any]] = {
    200: {"content": {"text/csv": {"schema": {"type": "string"}, "example": "id,label\r\n0,dent\r\n"}}}
}
"""For `responses=`: the table may also come as CSV."""


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


def table(request: Request, asked: str | None, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> Response:
    """Rows as an array of objects, or as CSV with these columns."""
    as_csv = wants_csv(request, asked)
    pieces = _joined(_csv(columns, rows) if as_csv else _json(rows))
    # The first piece is made before the status is sent, so that a database that is away is a 503 and no torso.
    first = next(pieces)
    headers = {"Vary": "Accept"}
    return StreamingResponse(chain([first], pieces), media_type=CSV if as_csv else "application/json", headers=headers)


def _json(rows: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    yield "["
    for number, row in enumerate(rows):
        yield (",\n" if number else "\n") + json.dumps(dict(row), allow_nan=False, ensure_ascii=False)
    yield "\n]\n"


def _csv(columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    yield csv_line(columns)
    for row in rows:
        yield csv_line([row.get(name) for name in columns])


def _joined(texts: Iterator[str]) -> Iterator[bytes]:
    """Pieces worth a write."""
    buffer: list[str] = []
    size = 0
    for text in texts:
        buffer.append(text)
        size += len(text)
        if size >= _PIECE:
            yield "".join(buffer).encode("utf-8", "replace")
            buffer, size = [], 0
    yield "".join(buffer).encode("utf-8", "replace")
