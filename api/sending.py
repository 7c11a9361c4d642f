"""What a request to start an inspection sends: a form with the files, or JSON that names finished uploads."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator
from contextlib import ExitStack, asynccontextmanager
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import Request
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.concurrency import run_in_threadpool

from api.finding import is_id
from api.forms import FormReader, Part
from api.problems import FieldError, Refused, field_errors
from api.receiving import body_of, on_disk
from api.schemas import EXAMPLE_ID, PARAMETERS_EXAMPLE, Parameters
from api.services import Services
from api.submit import Asked, LocalFile, Sent, invalid, parse_json, parse_parameters
from core.calibration.documents import MAX_BYTES
from core.calibration.files import parse_calibration
from core.errors import BadInput
from core.fingerprint import digest_of_file
from core.videos import MAX_VIDEOS

MAX_PARAMETERS_BYTES = 1 << 20
MAX_INLINE_BYTES = 8 << 20
"""Largest JSON body. Annotations that are larger come as an upload or in a form: parsed JSON takes much memory."""
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
                        "video": {
                            "type": "array",
                            "items": _BINARY,
                            "minItems": 1,
                            "maxItems": MAX_VIDEOS,
                            "description": "the video; its content decides, not its declared type. The part may be "
                            "repeated: several videos are of one inspection, in order",
                        },
                        "annotations": {
                            "type": "array",
                            "items": _BINARY,
                            "maxItems": MAX_VIDEOS,
                            "description": "any file of docs/annotations.md; told by content. Of several videos one "
                            "each, in the same order; an empty part for a video without",
                        },
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


class Recorded(BaseModel):
    """A video whose upload is finished, and its annotations."""

    model_config = ConfigDict(extra="forbid")

    video_upload: str = Field(description="id of the video's upload")
    annotations_upload: str | None = Field(None, description="id of the annotations' upload")
    annotations: dict[str, Any] | list[Any] | None = Field(
        None, description="the annotations themselves, in any JSON form that is read, up to 8 MiB in all"
    )


class CreateBody(BaseModel):
    """An inspection of uploads that are finished: of one video, or of several that `videos` lists."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"example": {"video_upload": EXAMPLE_ID, "parameters": PARAMETERS_EXAMPLE}},
    )

    video_upload: str | None = Field(None, description="id of the video's upload")
    annotations_upload: str | None = Field(None, description="id of the annotations' upload")
    annotations: dict[str, Any] | list[Any] | None = Field(
        None, description="the annotations themselves, in any JSON form that is read, up to 8 MiB"
    )
    videos: list[Recorded] | None = Field(
        None,
        min_length=1,
        max_length=MAX_VIDEOS,
        description="instead of the three above: several videos of one inspection, in order",
    )
    parameters: Parameters = Parameters()

    def recorded(self) -> list[tuple[str, Recorded]]:
        """Its videos, each with the JSON pointer to it.

        Raises:
            Refused: 422, it names none, or both forms, or annotations twice.
        """
        alone = (self.video_upload, self.annotations_upload, self.annotations)
        if self.videos is not None:
            if any(value is not None for value in alone):
                raise invalid(
                    [FieldError(pointer="/videos", detail="either videos, or video_upload and what is with it")]
                )
            found = [(f"/videos/{number}", one) for number, one in enumerate(self.videos)]
        elif self.video_upload is None:
            raise invalid([FieldError(pointer="/video_upload", detail="Field required, or videos")])
        else:
            upload, notes, inline = self.video_upload, self.annotations_upload, self.annotations
            found = [("", Recorded(video_upload=upload, annotations_upload=notes, annotations=inline))]
        for pointer, one in found:
            if one.annotations is not None and one.annotations_upload is not None:
                detail = "either annotations or annotations_upload"
                raise invalid([FieldError(pointer=f"{pointer}/annotations_upload", detail=detail)])
        return found


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
    form = FormReader(services, limits, {"video": MAX_VIDEOS, "annotations": MAX_VIDEOS})
    try:
        await form.read(request.headers, owner, body_of(request))
        given = form.named("parameters")
        parameters = parse_parameters(given[0].path.read_bytes()) if given else Parameters()
        calibration = form.named("calibration")
        if calibration:
            parameters = await on_disk(partial(_calibrated, parameters, calibration[0].path))
        yield Asked(owner, _sent(form.named("video"), form.named("annotations")), parameters, key)
    finally:
        form.discard()


def _calibrated(parameters: Parameters, path: Path) -> Parameters:
    """The parameters with the options that a calibration file stands for; options that are named count before them."""
    try:
        told = parse_calibration(path.read_bytes(), "calibration").options()
    except BadInput as error:
        raise invalid([FieldError(pointer="/calibration", detail=error.message)]) from None
    return parameters.model_copy(update={"options": {**told, **parameters.options}})


def _sent(videos: list[Part], annotations: list[Part]) -> tuple[Sent, ...]:
    """Videos with the annotations that came at the same place among theirs.

    Raises:
        Refused: 422, no video, or another number of annotations than of videos.
    """
    if not videos:
        raise invalid([FieldError(pointer="/video", detail="the part 'video' is missing")])
    if annotations and len(annotations) != len(videos):
        detail = (
            f"{len(annotations)} parts 'annotations' for {len(videos)} parts 'video'; send one for each, in the same "
            "order, and an empty one for a video without"
        )
        raise invalid([FieldError(pointer="/annotations", detail=detail)])
    notes = [_file(part) if part.size or len(videos) == 1 else None for part in annotations]
    return tuple(Sent(_file(video), note) for video, note in zip(videos, notes or [None] * len(videos), strict=True))


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
    with ExitStack() as inline:
        sent = [
            await on_disk(partial(_recorded, services, owner, pointer, one, inline)) for pointer, one in body.recorded()
        ]
        _require_sum([one.video for one in sent], "video", services.settings.max_upload_bytes)
        notes = [one.annotations for one in sent if one.annotations is not None]
        _require_sum(notes, "annotations", services.settings.max_upload_bytes)
        yield Asked(owner, tuple(sent), body.parameters, key)


def _parse_body(data: bytes) -> CreateBody:
    value = parse_json(data, "body")
    try:
        return CreateBody.model_validate(value)
    except ValidationError as error:
        raise invalid(field_errors(error.errors())) from None


def _recorded(services: Services, owner: str, pointer: str, one: Recorded, inline: ExitStack) -> Sent:
    """A video and its annotations as files; those that were in the body are removed with `inline`."""
    video = _upload(services, owner, one.video_upload, f"{pointer}/video_upload")
    if one.annotations_upload is not None:
        return Sent(video, _upload(services, owner, one.annotations_upload, f"{pointer}/annotations_upload"))
    if one.annotations is None:
        return Sent(video, None)
    path: Path = services.uploads.part()
    inline.callback(path.unlink, missing_ok=True)
    path.write_text(json.dumps(one.annotations, ensure_ascii=False), encoding="utf-8")
    return Sent(video, LocalFile(path, digest_of_file(path)))


def _require_sum(files: list[LocalFile], what: str, limit: int) -> None:
    """What one file may have, several may have together."""
    size = sum(file.path.stat().st_size for file in files)
    if len(files) > 1 and size > limit:
        detail = f"'{what}' may have at most {limit} bytes in all"
        raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "too_large", detail, where="videos")


def _upload(services: Services, owner: str, upload_id: str, pointer: str) -> LocalFile:
    """A finished upload of this owner; its hash is known, or made here once."""
    upload = services.uploads.find(upload_id, owner) if is_id(upload_id) else None
    if upload is None or upload.removed:
        raise invalid([FieldError(pointer=pointer, detail="there is no such upload")])
    if not upload.complete:
        detail = f"the upload is not finished: {upload.offset} of {upload.length} bytes"
        raise invalid([FieldError(pointer=pointer, detail=detail)])
    path = services.uploads.path(upload.id)
    digest = upload.sha256
    if digest is None:
        digest = digest_of_file(path)
        services.uploads.commit(upload.id, upload.offset, digest)
    return LocalFile(path, digest)
