"""Submission: from a form or from JSON that names finished uploads to an inspection.

The request is checked, its files are stored by content, and the inspection is written in one transaction and told of.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import Request
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from sqlalchemy.exc import IntegrityError
from starlette.concurrency import run_in_threadpool

from api.finding import is_id
from api.forms import FormReader, Part
from api.limits import require_space
from api.problems import FieldError, Refused, field_errors, pointer
from api.receiving import body_of, on_disk, while_there
from api.schemas import EXAMPLE_ID, Parameters
from api.services import Services
from api.state import State
from core.calibration.documents import MAX_BYTES
from core.calibration.files import parse_calibration
from core.errors import BadInput
from core.fingerprint import digest_of, digest_of_file
from core.settings import Settings, make_settings
from store.admission import IdempotencyKeys, Place
from store.records import InputFiles

MAX_PARAMETERS_BYTES = 1 << 20
MAX_INLINE_BYTES = 8 << 20
"""Largest JSON body. Annotations that are larger come as an upload or in a form: parsed JSON takes much memory."""
_PARAMETERS_EXAMPLE: dict[str, Any] = {
    "preset": "draft",
    "options": {"matching.window": 8},
    "label": "engine 4, stage 2",
}
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
                        "calibration": {**_BINARY, "description": "the lens: a file of docs/calibration.md"},
                        "parameters": {"$ref": "#/components/schemas/Parameters"},
                    },
                }
            },
            "application/json": {"schema": {"$ref": "#/components/schemas/CreateBody"}},
        },
    }
}
"""OpenAPI's description of both."""


@dataclass(frozen=True)
class LocalFile:
    """A file on this machine that came with a request, and its content's name."""

    path: Path
    sha256: str


@dataclass(frozen=True)
class Asked:
    """What a request asks for."""

    owner: str
    video: LocalFile
    annotations: LocalFile | None
    parameters: Parameters
    idempotency_key: str | None

    def digest(self) -> str:
        """Name of the request by content, however it was sent."""
        return digest_of(
            {
                "video": self.video.sha256,
                "annotations": self.annotations.sha256 if self.annotations else None,
                "parameters": self.parameters.model_dump(mode="json"),
            }
        )


async def accept(state: State, asked: Asked, request: Request) -> str:
    """Make the inspection that was asked for, or find the one that the same request made before; its id.

    Raises:
        Refused: 409 while the same request is under way, 422 for parameters, 429 or 503 when too many wait.
        LimitReached: too many are active.
        BadInput: the input cannot be used, or the key was used with another body.
        DiskFull: the disk has reached its reserve.
    """
    settings = settings_of(asked.parameters)
    with _under_way(state, asked):
        known = await run_in_threadpool(_known, state.services, asked)
        if known is not None:
            return known
        await run_in_threadpool(state.services.admission.look, asked.owner)
        require_space(state.services)
        annotations = asked.annotations.path if asked.annotations else None
        await while_there(request, state.prober.check(asked.owner, asked.video.path, annotations, settings))
        return await on_disk(partial(_create, state.services, asked, settings))


def settings_of(parameters: Parameters) -> Settings:
    """The settings that parameters mean; 422 names the option."""
    try:
        return make_settings(parameters.preset, parameters.options)
    except BadInput as error:
        parts = ("preset",) if error.where == "preset" else ("options", error.where)
        errors = [FieldError(pointer=pointer(("parameters", *parts)), detail=error.message)]
        status = HTTPStatus.UNPROCESSABLE_ENTITY
        raise Refused(status, "bad_parameters", error.message, where=error.where, errors=errors) from None


def parse_parameters(data: bytes) -> Parameters:
    """Parameters from the text of a form; 422 for what is none."""
    value = parse_json(data, "parameters")
    try:
        return Parameters.model_validate(value)
    except ValidationError as error:
        raise invalid(field_errors(error.errors(), "/parameters")) from None


def parse_json(data: bytes, where: str) -> Any:
    """A JSON value without what no database can keep; 400 for what is no JSON."""
    try:
        value = json.loads(data, parse_constant=_refuse_constant)
        text = json.dumps(value, ensure_ascii=False)
        text.encode()
    except (ValueError, RecursionError):
        raise Refused(HTTPStatus.BAD_REQUEST, "bad_json", f"'{where}' is not valid JSON", where=where) from None
    if "\\u0000" in text:
        raise Refused(HTTPStatus.BAD_REQUEST, "bad_json", f"'{where}' holds the character NUL", where=where)
    return value


def invalid(errors: list[FieldError]) -> Refused:
    """422 that names every place."""
    first = errors[0]
    detail = f"{first.pointer}: {first.detail}"
    return Refused(HTTPStatus.UNPROCESSABLE_ENTITY, "bad_request", detail, where=first.pointer, errors=errors)


def _refuse_constant(text: str) -> float:
    raise ValueError(f"{text} is not a finite number")


@contextmanager
def _under_way(state: State, asked: Asked) -> Iterator[None]:
    """Of two equal requests at once the second is told to come back; other processes are the database's matter."""
    if asked.idempotency_key is None:
        yield
        return
    mark = (asked.owner, asked.idempotency_key)
    if mark in state.in_flight:
        detail = "the same request is under way; ask again for its answer"
        raise Refused(
            HTTPStatus.CONFLICT,
            "in_flight",
            detail,
            where="Idempotency-Key",
            headers={"Retry-After": "2"},
            retryable=True,
        )
    state.in_flight.add(mark)
    try:
        yield
    finally:
        state.in_flight.discard(mark)


def _known(services: Services, asked: Asked) -> str | None:
    if asked.idempotency_key is None:
        return None
    return IdempotencyKeys(services.db).find(asked.owner, asked.idempotency_key, asked.digest())


def _create(services: Services, asked: Asked, settings: Settings) -> str:
    with services.admission.place(asked.owner) as place:
        return _create_in(services, asked, settings, place)


def _create_in(services: Services, asked: Asked, settings: Settings, place: Place) -> str:
    inspection_id = uuid.uuid4().hex
    stored = _store_inputs(services, asked)
    try:
        with services.db.write() as session:
            place.use(session)
            if asked.idempotency_key is not None:
                keys = IdempotencyKeys(services.db)
                keys.add(session, asked.owner, asked.idempotency_key, asked.digest(), inspection_id)
            services.inspections.create_in(
                session,
                inspection_id,
                stored,
                settings,
                "",
                owner=asked.owner,
                label=asked.parameters.label,
                external_id=asked.parameters.external_id,
                parameters={"preset": asked.parameters.preset, "options": asked.parameters.options},
            )
    except IntegrityError:
        # Another process answered the same request in this moment: its answer is ours.
        known = _known(services, asked)
        if known is None:
            raise
        return known
    # A sweeper that saw no inspection with this input a moment ago may have removed it: now one is there.
    _store_inputs(services, asked)
    services.wake(inspection_id)
    return inspection_id


def _store_inputs(services: Services, asked: Asked) -> InputFiles:
    video, annotations = asked.video, asked.annotations
    key = f"inputs/{video.sha256}/video"
    _adopt(services, key, video.path)
    if annotations is None:
        return InputFiles(key, video.sha256, None, None)
    notes = f"inputs/{annotations.sha256}/annotations"
    _adopt(services, notes, annotations.path)
    return InputFiles(key, video.sha256, notes, annotations.sha256)


def _adopt(services: Services, key: str, path: Path) -> None:
    if not services.artifacts.exists(key):
        services.artifacts.adopt(key, path)


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


@asynccontextmanager
async def asked_by_form(request: Request, services: Services, owner: str, key: str | None) -> AsyncIterator[Asked]:
    """Read a form to disk; its files live as long as the request."""
    settings = services.settings
    limits = {
        "video": settings.max_upload_bytes,
        "annotations": settings.max_annotations_bytes,
        "calibration": MAX_BYTES,
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
        if "calibration" in parts:
            parameters = await on_disk(partial(_calibrated, parameters, parts["calibration"].path))
        annotations = _file(parts["annotations"]) if "annotations" in parts else None
        yield Asked(owner, _file(parts["video"]), annotations, parameters, key)
    finally:
        form.discard()


def _calibrated(parameters: Parameters, path: Path) -> Parameters:
    """The parameters with the options that a calibration file stands for; options that are named count before them."""
    try:
        told = parse_calibration(path.read_bytes(), "calibration").options()
    except BadInput as error:
        raise invalid([FieldError(pointer="/calibration", detail=error.message)]) from None
    return parameters.model_copy(update={"options": {**told, **parameters.options}})


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
