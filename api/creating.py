"""The two ways to ask for an inspection: a form with the files, or JSON that names finished uploads."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import Request
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.concurrency import run_in_threadpool

from api.finding import is_id
from api.forms import FormReader, Part
from api.intake import Asked, LocalFile, invalid, parse_json, parse_parameters
from api.problems import FieldError, Refused, field_errors
from api.receiving import body_of, on_disk
from api.schemas import EXAMPLE_ID, Parameters
from api.services import Services
from core.fingerprint import digest_of_file

MAX_PARAMETERS_BYTES = 1 << 20
MAX_INLINE_BYTES = 8 << 20
"""Largest JSON body. Annotations that are larger come as an upload or in a form: parsed JSON takes much memory."""
_PARAMETERS_EXAMPLE: dict[str, Any] = {
    "preset": "draft",
    "options": {"matching.window": 8},
    "label": "engine 4, stage 2",
}


class CreateBody(BaseModel):
    """An inspection of uploads that are finished."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"example": {"video_upload": EXAMPLE_ID, "parameters": _PARAMETERS_EXAMPLE}},
    )

    video_upload: str = Field(description="id of the video's upload")
    annotations_upload: str | None = Field(None, description="id of the annotations' upload")
    annotations: dict[str, Any] | list[Any] | None = Field(
        None, description="the annotations themselves, in any JSON form that is read, up to 8 MiB"
    )
    parameters: Parameters = Parameters()


_BINARY = {"type": "string", "format": "binary"}
CREATE_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["video"],
                    "additionalProperties": False,
                    "properties": {
                        "video": {**_BINARY, "description": "the video; its content decides, not its declared type"},
                        "annotations": {**_BINARY, "description": "any file of docs/annotations.md; told by content"},
                        "parameters": {"$ref": "#/components/schemas/Parameters"},
                    },
                }
            },
            "application/json": {"schema": {"$ref": "#/components/schemas/CreateBody"}},
        },
    }
}
"""OpenAPI's description of both."""


@asynccontextmanager
async def asked_by_form(request: Request, services: Services, owner: str, key: str | None) -> AsyncIterator[Asked]:
    """Read a form to disk; its files live as long as the request."""
    settings = services.settings
    limits = {
        "video": settings.max_upload_bytes,
        "annotations": settings.max_annotations_bytes,
        "parameters": MAX_PARAMETERS_BYTES,
    }
    # Refused before the body is read: a client that asked with `Expect: 100-continue` need not send it.
    await run_in_threadpool(services.admission.look, owner)
    form = FormReader(services, limits)
    try:
        parts = await form.read(request.headers, owner, body_of(request))
        if "video" not in parts:
            raise invalid([FieldError(pointer="/video", detail="the part 'video' is missing")])
        parameters = parse_parameters(parts["parameters"].path.read_bytes()) if "parameters" in parts else Parameters()
        annotations = _file(parts["annotations"]) if "annotations" in parts else None
        yield Asked(owner, _file(parts["video"]), annotations, parameters, key)
    finally:
        form.discard()


def _file(part: Part) -> LocalFile:
    return LocalFile(part.path, part.sha256)


@asynccontextmanager
async def asked_by_json(request: Request, services: Services, owner: str, key: str | None) -> AsyncIterator[Asked]:
    """Find the uploads that a JSON body names."""
    data = bytearray()
    async for chunk in body_of(request):
        data += chunk
        if len(data) > MAX_INLINE_BYTES:
            detail = f"a JSON body may have {MAX_INLINE_BYTES} bytes; send larger annotations as an upload"
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "too_large", detail, where="body")
    body = await run_in_threadpool(_parse_body, bytes(data))
    video = await on_disk(partial(_upload, services, owner, body.video_upload, "video_upload"))
    inline = services.uploads.part()
    try:
        annotations = await on_disk(partial(_annotations, services, owner, body, inline))
        yield Asked(owner, video, annotations, body.parameters, key)
    finally:
        inline.unlink(missing_ok=True)


def _parse_body(data: bytes) -> CreateBody:
    value = parse_json(data, "body")
    try:
        body = CreateBody.model_validate(value)
    except ValidationError as error:
        raise invalid(field_errors(error.errors())) from None
    if body.annotations is not None and body.annotations_upload is not None:
        detail = "either annotations or annotations_upload"
        raise invalid([FieldError(pointer="/annotations_upload", detail=detail)])
    return body


def _upload(services: Services, owner: str, upload_id: str, field: str) -> LocalFile:
    """A finished upload of this owner; its hash is known, or made here once."""
    upload = services.uploads.find(upload_id, owner) if is_id(upload_id) else None
    if upload is None or upload.removed:
        raise invalid([FieldError(pointer=f"/{field}", detail="there is no such upload")])
    if not upload.complete:
        detail = f"the upload is not finished: {upload.offset} of {upload.length} bytes"
        raise invalid([FieldError(pointer=f"/{field}", detail=detail)])
    path = services.uploads.path(upload.id)
    digest = upload.sha256
    if digest is None:
        digest = digest_of_file(path)
        services.uploads.commit(upload.id, upload.offset, digest)
    return LocalFile(path, digest)


def _annotations(services: Services, owner: str, body: CreateBody, inline: Path) -> LocalFile | None:
    if body.annotations_upload is not None:
        return _upload(services, owner, body.annotations_upload, "annotations_upload")
    if body.annotations is None:
        return None
    inline.write_text(json.dumps(body.annotations, ensure_ascii=False), encoding="utf-8")
    return LocalFile(inline, digest_of_file(inline))
