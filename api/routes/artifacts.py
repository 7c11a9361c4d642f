"""Files of an inspection: one by one with ranges, or all in one archive."""

from __future__ import annotations

import base64
import fnmatch
from collections.abc import Iterator
from datetime import datetime
from http import HTTPStatus
from pathlib import PurePosixPath
from typing import Annotated, Any
from urllib.parse import quote

from fastapi import APIRouter, Header, Query, Request, Response
from fastapi.responses import StreamingResponse
from pydantic import BaseModel, ConfigDict, Field
from zipstream import ZipStream

from api.auth import LinkReader, Reader
from api.finding import find_inspection
from api.negotiation import Span, matches, wanted_span
from api.problems import not_found, responses
from api.routes.tables import not_ready
from api.services import Services
from api.state import state_of
from store.files import ArtifactStore
from store.publishing import ArtifactRows, ArtifactView

router = APIRouter(prefix="/v1/inspections/{inspection_id}", tags=["results"])

_CHUNK = 1 << 20
_EXAMPLE: dict[str, Any] = {
    "path": "mapping/mesh_defects.ply",
    "size": 48120311,
    "sha256": "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08",
    "media_type": "application/octet-stream",
    "created_at": "2026-05-04T09:41:10Z",
    "link": "/v1/inspections/0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1/artifacts/mapping/mesh_defects.ply",
}
_BINARY_SCHEMA = {"type": "string", "format": "binary"}
_BINARY = {"content": {"application/octet-stream": {"schema": _BINARY_SCHEMA}}}


class ArtifactItem(BaseModel):
    """One file."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    path: str = Field(description="name of the contract, docs/outputs.md")
    size: int = Field(description="bytes")
    sha256: str
    media_type: str
    created_at: datetime
    link: str


class Artifacts(BaseModel):
    """Every file of an inspection, by path."""

    model_config = ConfigDict(json_schema_extra={"example": {"artifacts": [_EXAMPLE]}})

    artifacts: list[ArtifactItem]


@router.get("/artifacts", summary="List the files", responses=responses(401, 404, 410, 503))
def listing(request: Request, caller: Reader, inspection_id: str) -> Artifacts:
    """Size, SHA-256 and media type of every published file; empty until the inspection is over."""
    services = state_of(request).services
    find_inspection(services, inspection_id, caller.owner)
    views = ArtifactRows(services.db).all(inspection_id)
    return Artifacts(artifacts=[_item(services, inspection_id, view) for view in views])


def _item(services: Services, inspection_id: str, view: ArtifactView) -> ArtifactItem:
    return ArtifactItem(
        path=view.path,
        size=view.size,
        sha256=view.sha256,
        media_type=view.media_type,
        created_at=view.created_at,
        link=services.link(f"/v1/inspections/{inspection_id}/artifacts/{quote(view.path)}"),
    )


@router.get(
    "/artifacts/{path:path}",
    summary="Fetch a file",
    response_class=StreamingResponse,
    responses={
        200: {"description": "the file", **_BINARY},
        206: {"description": "the part that `Range` asks for", **_BINARY},
        304: {"description": "it is the file that `If-None-Match` names"},
        **responses(401, 404, 409, 410, 416, 503),
    },
)
@router.head("/artifacts/{path:path}", summary="Size and hash of a file", include_in_schema=False)
def fetch(
    request: Request,
    caller: LinkReader,
    inspection_id: str,
    path: str,
    range: Annotated[str | None, Header(description="one range of bytes", examples=["bytes=1048576-"])] = None,
    if_range: Annotated[str | None, Header(description="the `ETag` that the range belongs to")] = None,
    if_none_match: Annotated[str | None, Header(description="an `ETag` that is at hand")] = None,
) -> Response:
    """The file; its strong `ETag` is its SHA-256, so a part that came before a cut is known to belong to the rest."""
    services = state_of(request).services
    view = find_file(services, inspection_id, caller.owner, path)
    etag = f'"{view.sha256}"'
    headers = {"ETag": etag, "Accept-Ranges": "bytes", "Repr-Digest": _repr_digest(view.sha256)}
    if matches(if_none_match, etag):
        return Response(status_code=HTTPStatus.NOT_MODIFIED, headers=headers)
    span = wanted_span(range, if_range, etag, view.size)
    return _stream(services.artifacts, view, span, headers, head=request.method == "HEAD")


def find_file(services: Services, inspection_id: str, owner: str, path: str) -> ArtifactView:
    """A published file of an inspection of this owner; otherwise the answer that says what is missing.

    It is found by its exact name in the table: whatever else a path may say, it names no file.
    """
    row = find_inspection(services, inspection_id, owner)
    view = ArtifactRows(services.db).find(inspection_id, path) if "\0" not in path else None
    if view is None:
        raise not_ready(row, "file")
    return view


def _stream(
    store: ArtifactStore, view: ArtifactView, span: Span | None, headers: dict[str, str], *, head: bool
) -> Response:
    part = span or Span(0, view.size)
    name = PurePosixPath(view.path).name
    headers["Content-Length"] = str(part.stop - part.start)
    headers["Content-Disposition"] = f"inline; filename*=UTF-8''{quote(name)}"
    if span is not None:
        headers["Content-Range"] = f"bytes {span.start}-{span.stop - 1}/{view.size}"
    status = HTTPStatus.OK if span is None else HTTPStatus.PARTIAL_CONTENT
    if head:
        return Response(status_code=status, headers=headers, media_type=view.media_type)
    if not store.exists(view.key):
        raise not_found("file")
    return StreamingResponse(stream_bytes(store, view.key, part), status, headers, view.media_type)


def stream_bytes(store: ArtifactStore, key: str, span: Span) -> Iterator[bytes]:
    """A part of a stored file, a chunk in memory at a time."""
    left = span.stop - span.start
    with store.open(key) as stream:
        stream.seek(span.start)
        while left > 0 and (chunk := stream.read(min(_CHUNK, left))):
            left -= len(chunk)
            yield chunk


def _repr_digest(sha256: str) -> str:
    """RFC 9530: the hash of the whole file, whatever part of it is sent."""
    return f"sha-256=:{base64.b64encode(bytes.fromhex(sha256)).decode()}:"


@router.get(
    "/archive.zip",
    summary="Fetch files as one archive",
    response_class=StreamingResponse,
    responses={
        200: {
            "description": "ZIP, not compressed, so that its length is known",
            "content": {"application/zip": {"schema": _BINARY_SCHEMA}},
        },
        **responses(401, 404, 409, 410, 422, 503),
    },
)
def archive(
    request: Request,
    caller: Reader,
    inspection_id: str,
    include: Annotated[
        list[str] | None,
        Query(description="patterns of paths, e.g. `mapping/*`; all files without", examples=[["mapping/*"]]),
    ] = None,
) -> Response:
    """Made while it is sent: nothing is staged on disk."""
    services = state_of(request).services
    row = find_inspection(services, inspection_id, caller.owner)
    views = [view for view in ArtifactRows(services.db).all(inspection_id) if _included(view.path, include)]
    if not views:
        raise not_ready(row, "file of that pattern" if include else "file")
    archived = ZipStream(sized=True)
    for view in views:
        archived.add(stream_bytes(services.artifacts, view.key, Span(0, view.size)), view.path, size=view.size)
    headers = {
        "Content-Length": str(len(archived)),
        "Content-Disposition": f'attachment; filename="{inspection_id}.zip"',
    }
    return StreamingResponse(iter(archived), headers=headers, media_type="application/zip")


def _included(path: str, patterns: list[str] | None) -> bool:
    return not patterns or any(fnmatch.fnmatchcase(path, pattern) for pattern in patterns)
