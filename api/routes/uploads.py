"""Resumable uploads: tus 1.0.0 with creation and termination (https://tus.io/protocols/resumable-upload)."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Callable, Mapping
from contextlib import suppress
from datetime import datetime
from email.utils import format_datetime
from functools import partial
from http import HTTPStatus
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Header, Query, Request, Response
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy.orm import Session
from starlette.concurrency import run_in_threadpool

from api.auth import Reader, Submitter
from api.finding import is_id
from api.openapi import MUST_BE_SENT
from api.paging import next_link
from api.parameters import OneOf
from api.problems import Refused, not_found, responses
from api.receiving import on_disk, receive_patch
from api.services import Services
from api.state import state_of
from store.files import input_key
from store.housekeeping import Retention
from store.uploads import UploadFile, UploadState, UploadView

VERSION = "1.0.0"
_CONTENT_TYPE = "application/offset+octet-stream"
_MAX_METADATA = 8192
_LARGEST = 1 << 62
_CHECKSUM = re.compile(r"sha256 ([A-Za-z0-9+/]{43}=)")
_SHA256_BYTES = 32


async def speaks_tus(
    request: Request,
    tus_resumable: Annotated[
        str | None,
        Header(description="version of the protocol: 1.0.0", examples=[VERSION], json_schema_extra=MUST_BE_SENT),
    ] = None,
) -> None:
    """412 unless the client speaks our version; nothing of the request is processed then."""
    if tus_resumable != VERSION:
        detail = f"this server speaks tus {VERSION}; say so in the header Tus-Resumable"
        raise Refused(HTTPStatus.PRECONDITION_FAILED, "tus_version", detail, headers={"Tus-Version": VERSION})


router = APIRouter(prefix="/v1/uploads", tags=["uploads"])
_TUS = [Depends(speaks_tus)]
_UNTIL: dict[str, Any] = {
    "Upload-Expires": {"schema": {"type": "string"}, "example": "Thu, 07 May 2026 09:30:02 GMT"},
}
_EXAMPLE: dict[str, Any] = {"headers": {"Upload-Offset": {"schema": {"type": "integer"}, "example": 5242880}, **_UNTIL}}
_State = Annotated[str, OneOf(UploadState)]
_ITEM: dict[str, Any] = {
    "id": "0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1",
    "state": "open",
    "length": 13107200,
    "offset": 5242880,
    "metadata": {"filename": "turbine.mp4"},
    "sha256": None,
    "created_at": "2026-05-04T09:30:02Z",
    "updated_at": "2026-05-04T09:31:40Z",
    "expires_at": "2026-05-07T09:30:02Z",
    "link": "/v1/uploads/0b6f1e0c3f7d4f0f9a52f7f4f1f0a6c1",
}


class UploadItem(BaseModel):
    """An upload of the account."""

    model_config = ConfigDict(json_schema_extra={"example": _ITEM})

    id: str
    state: _State
    length: int = Field(description="size of the whole file in bytes")
    offset: int = Field(description="bytes that are safe; sending goes on from here")
    metadata: dict[str, str] = Field(description="`Upload-Metadata`, decoded")
    sha256: str | None = Field(description="of the whole file; null until it is known")
    created_at: datetime
    updated_at: datetime
    expires_at: datetime | None = Field(description="it is removed then, finished or not; null = never")
    link: str = Field(description="where the bytes are sent")


class UploadList(BaseModel):
    """One page of uploads, newest first."""

    model_config = ConfigDict(json_schema_extra={"example": {"uploads": [_ITEM], "next_cursor": None}})

    uploads: list[UploadItem]
    next_cursor: str | None = Field(description="`cursor` of the next page; null on the last. Also in `Link: rel=next`")


@router.options("", status_code=204, summary="What this server can do", response_class=Response)
@router.options(
    "/{upload_id}", status_code=204, summary="What this server can do", include_in_schema=False, response_class=Response
)
def capabilities(request: Request) -> Response:
    """Version, extensions and the largest upload."""
    return _answer(
        HTTPStatus.NO_CONTENT,
        {
            "Tus-Version": VERSION,
            "Tus-Extension": "creation,expiration,termination",
            "Tus-Max-Size": str(state_of(request).services.settings.max_upload_bytes),
        },
    )


@router.get("", summary="List uploads", responses=responses(400, 401, 422, 503))
def listing(
    request: Request,
    response: Response,
    caller: Reader,
    state: Annotated[_State | None, Query(description="only these")] = None,
    limit: Annotated[int, Query(ge=1, le=200, description="uploads on a page")] = 50,
    cursor: Annotated[str | None, Query(max_length=500, description="`next_cursor` of the page before")] = None,
) -> UploadList:
    """The account's uploads that were neither given up nor have expired, newest first. No header of tus is needed."""
    chosen = None if state is None else UploadState(state)
    services = state_of(request).services
    page = services.uploads.page(caller.owner, chosen, limit, cursor)
    if page.cursor is not None:
        response.headers["Link"] = next_link(request, page.cursor)
    return UploadList(
        uploads=[_item(services, view) for view in page.uploads if not view.removed], next_cursor=page.cursor
    )


def _item(services: Services, upload: UploadView) -> UploadItem:
    return UploadItem(
        id=upload.id,
        state=upload.state,
        length=upload.length,
        offset=upload.offset,
        metadata={name: str(value) for name, value in upload.metadata.items()},
        sha256=upload.sha256,
        created_at=upload.created_at,
        updated_at=upload.updated_at,
        expires_at=upload.expires_at,
        link=services.link(f"{router.prefix}/{upload.id}"),
    )


@router.post(
    "",
    status_code=201,
    summary="Begin an upload",
    response_class=Response,
    dependencies=_TUS,
    responses={
        200: {
            "description": "this account sent the file of this checksum before: `Location` is its finished upload",
            "headers": _UNTIL,
        },
        201: {"description": "made; `Location` is where to send the bytes", "headers": _UNTIL},
        **responses(400, 401, 412, 413, 429, 507),
    },
)
async def create(
    request: Request,
    caller: Submitter,
    upload_length: Annotated[
        str | None,
        Header(description="size of the file in bytes", examples=["13107200"], json_schema_extra=MUST_BE_SENT),
    ] = None,
    upload_metadata: Annotated[
        str | None, Header(description="`name base64,name base64`", examples=["filename dHVyYmluZS5tcDQ="])
    ] = None,
    upload_checksum: Annotated[
        str | None,
        Header(
            description="`sha256 base64` of the whole file: one that this account sent before need not be sent again",
            examples=["sha256 n4bQgYhMfWWaL+qgxVrQFaO/TxsrC4Is0V1sFbDwCgg="],
        ),
    ] = None,
) -> Response:
    """Make an upload of a known size; 413 and 507 when the server or its disk do not take it, 429 beyond a limit."""
    services = state_of(request).services
    length = _number(upload_length, "Upload-Length")
    if length > services.settings.max_upload_bytes:
        detail = f"at most {services.settings.max_upload_bytes} bytes are taken"
        raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "too_large", detail, where="Upload-Length")
    metadata = _metadata(upload_metadata or "")
    admit = partial(services.admission.admit_upload, owner=caller.owner, size=length)
    if upload_checksum is not None:
        sha256 = _sha256(upload_checksum)
        known = await on_disk(partial(_sent_before, services, caller.owner, length, sha256, metadata, admit))
        if known is not None:
            return _answer(HTTPStatus.OK, _place(services, known))
    upload = await on_disk(partial(_begin, services, caller.owner, length, metadata, admit))
    return _answer(HTTPStatus.CREATED, _place(services, upload))


def _begin(
    services: Services, owner: str, length: int, metadata: Mapping[str, str], admit: Callable[[Session], None]
) -> UploadView:
    """A new upload; who has too many open is refused before a file is made and without waiting for who writes."""
    services.admission.look_upload(owner)
    return services.uploads.create(owner, length, metadata, admit)


def _place(services: Services, upload: UploadView) -> dict[str, str]:
    place = services.link(f"{router.prefix}/{upload.id}")
    return {"Location": place, "Upload-Offset": str(upload.offset), **_expiry(upload)}


def _sent_before(
    services: Services,
    owner: str,
    length: int,
    sha256: str,
    metadata: Mapping[str, str],
    admit: Callable[[Session], None],
) -> UploadView | None:
    """A finished upload of a file that this account sent before, be it as an upload or in a form; None without any.

    What others sent is not looked at, so an answer says nothing about it.
    """
    known = services.uploads.find_content(owner, length, sha256)
    folder = services.artifacts.folder
    if known is not None or folder is None or not Retention(services.db).has_input(owner, sha256):
        return known
    for role in ("video", "annotations"):
        path = folder / input_key(sha256, role)
        with suppress(OSError):  # removed in this moment, or on another disk: then it is sent once more
            if path.stat().st_size == length:
                return services.uploads.create_from(path, sha256, owner, metadata, admit)
    return None


@router.head(
    "/{upload_id}",
    summary="How much has arrived",
    response_class=Response,
    dependencies=_TUS,
    responses={200: {"description": "`Upload-Offset` bytes are safe", **_EXAMPLE}, **responses(401, 404, 410, 412)},
)
def offset(request: Request, caller: Submitter, upload_id: str) -> Response:
    """The offset to go on from: what was committed and is on disk."""
    upload = _find(request, upload_id, caller.owner)
    headers = {"Upload-Offset": str(upload.offset), "Upload-Length": str(upload.length), "Cache-Control": "no-store"}
    headers |= _expiry(upload)
    if upload.metadata:
        headers["Upload-Metadata"] = _encoded(upload.metadata)
    return _answer(HTTPStatus.OK, headers)


@router.patch(
    "/{upload_id}",
    status_code=204,
    summary="Send bytes",
    response_class=Response,
    dependencies=_TUS,
    responses={
        204: {"description": "`Upload-Offset` bytes are safe", **_EXAMPLE},
        **responses(400, 401, 404, 409, 410, 412, 413, 415, 423, 507),
    },
    openapi_extra={
        "requestBody": {
            "required": True,
            "content": {_CONTENT_TYPE: {"schema": {"type": "string", "format": "binary"}}},
        }
    },
)
async def send(
    request: Request,
    caller: Submitter,
    upload_id: str,
    upload_offset: Annotated[
        str | None,
        Header(description="where these bytes begin", examples=["0"], json_schema_extra=MUST_BE_SENT),
    ] = None,
) -> Response:
    """Append at the offset. What arrived of a request that was cut off is kept."""
    if request.headers.get("content-type", "").split(";")[0].strip().lower() != _CONTENT_TYPE:
        detail = f"the content type must be {_CONTENT_TYPE}"
        raise Refused(HTTPStatus.UNSUPPORTED_MEDIA_TYPE, "content_type", detail, where="Content-Type")
    declared = _number(upload_offset, "Upload-Offset")
    upload = await run_in_threadpool(_find, request, upload_id, caller.owner)
    reached = await receive_patch(request, state_of(request), upload, declared)
    return _answer(HTTPStatus.NO_CONTENT, {"Upload-Offset": str(reached), **_expiry(upload)})


@router.delete(
    "/{upload_id}",
    status_code=204,
    summary="Give an upload up",
    response_class=Response,
    dependencies=_TUS,
    responses=responses(401, 404, 410, 412, 423),
)
def terminate(request: Request, caller: Submitter, upload_id: str) -> Response:
    """Remove an upload and its bytes; inspections that were made from it keep theirs."""
    state = state_of(request)
    upload = _find(request, upload_id, caller.owner)
    uploads = state.services.uploads
    with UploadFile(uploads.path(upload.id), state.digests):  # 423 while somebody writes
        uploads.remove(upload.id)
    return _answer(HTTPStatus.NO_CONTENT, {})


def _find(request: Request, upload_id: str, owner: str) -> UploadView:
    if not is_id(upload_id):
        raise not_found("upload")
    upload = state_of(request).services.uploads.find(upload_id, owner)
    if upload is None:
        raise not_found("upload")
    if upload.removed:
        raise Refused(HTTPStatus.GONE, "gone", "this upload was removed")
    return upload


def _expiry(upload: UploadView) -> dict[str, str]:
    """tus's header of the extension `expiration`; nothing for an upload that does not expire."""
    return {} if upload.expires_at is None else {"Upload-Expires": format_datetime(upload.expires_at, usegmt=True)}


def _number(text: str | None, header: str) -> int:
    if text is None or not (text.isascii() and text.isdigit() and len(text) < 20) or int(text) > _LARGEST:
        raise Refused(HTTPStatus.BAD_REQUEST, "bad_header", f"{header} must be a whole number of bytes", where=header)
    return int(text)


def _sha256(text: str) -> str:
    """The hash of ``sha256 base64`` in hexadecimal; 400 for what is not of this form."""
    form = _CHECKSUM.fullmatch(text)
    digest = base64.b64decode(form[1]) if form else b""
    if len(digest) != _SHA256_BYTES:
        detail = "Upload-Checksum must be `sha256 base64value`"
        raise Refused(HTTPStatus.BAD_REQUEST, "bad_header", detail, where="Upload-Checksum")
    return digest.hex()


def _metadata(text: str) -> dict[str, str]:
    """``key base64,key base64`` as texts; 400 for what is not of this form."""
    found: dict[str, str] = {}
    try:
        if len(text) > _MAX_METADATA or not text.isascii():
            raise ValueError("too long")
        for pair in filter(None, (part.strip() for part in text.split(","))):
            key, _, value = pair.partition(" ")
            if not key or key in found:
                raise ValueError(key)
            found[key] = base64.b64decode(value, validate=True).decode("utf-8", "replace")
    except (ValueError, binascii.Error):
        detail = "Upload-Metadata must be `key base64value` pairs, separated by commas"
        raise Refused(HTTPStatus.BAD_REQUEST, "bad_header", detail, where="Upload-Metadata") from None
    return found


def _encoded(metadata: Mapping[str, Any]) -> str:
    pairs = ((key, base64.b64encode(str(value).encode()).decode()) for key, value in metadata.items())
    return ",".join(f"{key} {value}".rstrip() for key, value in pairs)


def _answer(status: HTTPStatus, headers: Mapping[str, str]) -> Response:
    return Response(status_code=status, headers={"Tus-Resumable": VERSION, **headers})
