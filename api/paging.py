"""Tables in pages: one page for who asks with `limit`, else all of them, each read while none is being sent.

No connection to the database is open while bytes go to a client: who asks for a large table and does not read it
holds one page in memory and nothing else.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Mapping
from dataclasses import dataclass
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import Depends, Header, Query, Request
from fastapi.responses import Response, StreamingResponse
from sqlalchemy.exc import SQLAlchemyError
from starlette.types import Send

from api.negotiation import CSV_RESPONSE, Format, TableForm, matches
from api.problems import log, responses
from api.threads import LimitedThreads
from core.errors import BladeAtlasError
from core.fingerprint import digest_of
from core.versions import program_version
from store.db import Database
from store.tables import Page, Position, RowFilter, Table, read_page, table_version

_PIECE = 500
"""Rows of a page that nobody asked for: what one reader has in memory."""
_MAX_LIMIT = 5000

_in_turn = LimitedThreads(1).run
"""Pages behind the first are made one at a time: however many read large tables, others get their share of time."""

TABLE_RESPONSES: dict[int | str, dict[str, Any]] = {
    200: {
        **CSV_RESPONSE[200],
        "headers": {
            "ETag": {"description": "names these rows in this form", "schema": {"type": "string"}},
            "Link": {"description": "`rel=next`: the next page, with `limit`", "schema": {"type": "string"}},
        },
    },
    304: {"description": "not changed since `If-None-Match`"},
    **responses(400, 401, 404, 409, 410, 422, 503),
}
"""For `responses=` of a route that answers with `paged`."""


@dataclass(frozen=True)
class Asked:
    """How a table is asked for."""

    format: Format = None
    limit: Annotated[int | None, Query(ge=1, le=_MAX_LIMIT, description="rows on a page; all without")] = None
    cursor: Annotated[str | None, Query(max_length=1000, description="of the `Link` of the page before")] = None
    if_none_match: Annotated[str | None, Header(description="an `ETag` that was seen before")] = None


AskedFor = Annotated[Asked, Depends()]
"""Parameter of a route that answers with `paged`."""


@dataclass(frozen=True)
class Source:
    """The rows that were asked for."""

    db: Database
    inspection_id: str
    table: Table
    chosen: RowFilter

    def page(self, limit: int, after: Position | None) -> Page:
        """Some of them; `TableChanged` when they are not those that `after` belongs to any more."""
        return read_page(self.db, self.inspection_id, self.table, self.chosen, limit, after)

    def tag(self) -> object:
        """What else than the version of the table the rows depend on."""
        return None


def paged(request: Request, source: Source, form: TableForm, asked: Asked) -> Response:
    """One page with a `Link` to the next, or all rows, page by page."""
    after = None if asked.cursor is None else Position.from_cursor(source.table, asked.cursor)
    tag = source.tag()  # before the rows: newer rows under an older tag are only asked for again
    if asked.if_none_match is not None:
        version = table_version(source.db, source.inspection_id, source.table)
        headers = _headers(request, source, form, (version, tag))
        if matches(asked.if_none_match, headers["ETag"]):
            return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    # The first page is read before the status is sent: a database that is away is a 503 and no torso.
    first = source.page(asked.limit or _PIECE, after)
    headers = _headers(request, source, form, (first.version, tag))
    if asked.limit is not None and first.next is not None:
        headers["Link"] = next_link(request, first.next.to_cursor(source.table))
    if asked.limit is not None or first.next is None:
        body = form.begin() + form.rows(first.rows, first=True) + form.end()
        return Response(body, headers=headers, media_type=form.media_type)
    begin = form.begin() + form.rows(first.rows, first=True)
    return _Pages(_all(source, form, begin, first.next), headers=headers, media_type=form.media_type)


def next_link(request: Request, cursor: str) -> str:
    """The header `Link` that names the next page of a list."""
    target = request.url.include_query_params(cursor=cursor)
    return f'<{target.path}?{target.query}>; rel="next"'


async def _all(source: Source, form: TableForm, begin: bytes, after: Position) -> AsyncIterator[bytes]:
    """Everything, `begin` being what was made already."""
    yield begin
    position: Position | None = after
    while position is not None:
        piece, position = await _in_turn(partial(_piece, source, form, position))
        yield piece
    yield form.end()


def _piece(source: Source, form: TableForm, after: Position) -> tuple[bytes, Position | None]:
    page = source.page(_PIECE, after)
    return form.rows(page.rows, first=False), page.next


def _headers(request: Request, source: Source, form: TableForm, version: tuple[int, object]) -> dict[str, str]:
    """A strong tag: rows of one version, asked for in one way, are written to the same bytes by one program."""
    asked: Mapping[str, Any] = {
        "program": program_version(),
        "inspection": source.inspection_id,
        "table": source.table.name,
        "version": version,
        "form": form.media_type,
        "query": sorted(request.query_params.multi_items()),
    }
    return {"ETag": f'"{digest_of(asked)[:32]}"', "Vary": "Accept"}


class _Pages(StreamingResponse):
    """An answer that is cut off when its next page cannot be had: without its end a client knows that it is torn."""

    async def stream_response(self, send: Send) -> None:
        """Send; the end is left out when a page is missing, and the server closes the connection then."""
        try:
            await super().stream_response(send)
        except (BladeAtlasError, SQLAlchemyError) as error:
            log.warning("table_cut_off", error=type(error).__name__)
