"""What a request to start an inspection sends: a form with the files, or JSON that names finished uploads."""

from __future__ import annotations

import json
from collections.abc import AsyncIterator, Mapping
from contextlib import ExitStack, asynccontextmanager
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import Request
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.concurrency import run_in_threadpool

from api.fetching import Fetches, Wanted
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
from store.outbound import MAX_URL
from store.settings import DeploymentSettings

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


_SHA256 = Field(None, pattern="^[0-9a-f]{64}$", description="what it must hash to, in hexadecimal")
_URL = (
    "where the server fetches it: an https URL of a host among `input_hosts`, or `s3://bucket/key` of a bucket among "
    "`input_buckets`"
)


class Recorded(BaseModel):
    """A video that is an upload or lies at a URL, and its annotations."""

    model_config = ConfigDict(extra="forbid")

    video_upload: str | None = Field(None, description="id of the video's upload")
    video_url: str | None = Field(None, max_length=MAX_URL, description=_URL)
    video_sha256: str | None = _SHA256
    annotations_upload: str | None = Field(None, description="id of the annotations' upload")
    annotations_url: str | None = Field(None, max_length=MAX_URL, description=_URL)
    annotations_sha256: str | None = _SHA256
    annotations: dict[str, Any] | list[Any] | None = Field(
        None, description="the annotations themselves, in any JSON form that is read, up to 8 MiB in all"
    )

    def require_one_of_each(self, pointer: str) -> None:
        """422 unless there is one video and at most one of annotations, and each hash belongs to a URL."""
        videos = {"video_upload": self.video_upload, "video_url": self.video_url}
        notes = {
            "annotations": self.annotations,
            "annotations_upload": self.annotations_upload,
            "annotations_url": self.annotations_url,
        }
        hashes = {"video": self.video_sha256, "annotations": self.annotations_sha256}
        urls = {"video": self.video_url, "annotations": self.annotations_url}
        if not any(value is not None for value in videos.values()):
            raise invalid(
                [FieldError(pointer=f"{pointer}/video_upload", detail="Field required, or video_url, videos")]
            )
        for given in (videos, notes):
            named = [name for name, value in given.items() if value is not None]
            if len(named) > 1:
                detail = f"either {named[0]} or {named[1]}"
                raise invalid([FieldError(pointer=f"{pointer}/{named[1]}", detail=detail)])
        for name, sha256 in hashes.items():
            if sha256 is not None and urls[name] is None:
                raise invalid([FieldError(pointer=f"{pointer}/{name}_sha256", detail=f"it is for {name}_url")])

    def wanted(self, pointer: str, settings: DeploymentSettings) -> list[Wanted]:
        """What is to be fetched."""
        found = []
        if self.video_url is not None:
            most = settings.max_upload_bytes
            found.append(Wanted(self.video_url, self.video_sha256, most, f"{pointer}/video_url"))
        if self.annotations_url is not None:
            most = settings.max_annotations_bytes
            found.append(Wanted(self.annotations_url, self.annotations_sha256, most, f"{pointer}/annotations_url"))
        return found

    def fetched(self, pointer: str, uploads: Mapping[str, str]) -> Recorded:
        """The same with uploads instead of URLs, by the pointers to these."""
        return Recorded(
            video_upload=uploads.get(f"{pointer}/video_url", self.video_upload),
            annotations_upload=uploads.get(f"{pointer}/annotations_url", self.annotations_upload),
            annotations=self.annotations,
        )


class CreateBody(Recorded):
    """An inspection of uploads that are finished or of files at URLs: of one video, or of several in `videos`."""

    model_config = ConfigDict(
        extra="forbid",
        json_schema_extra={"example": {"video_upload": EXAMPLE_ID, "parameters": PARAMETERS_EXAMPLE}},
    )

    videos: list[Recorded] | None = Field(
        None,
        min_length=1,
        max_length=MAX_VIDEOS,
        description="instead of a single one: several videos of one inspection, in order",
    )
    parameters: Parameters = Parameters()

    def recorded(self) -> list[tuple[str, Recorded]]:
        """Its videos, each with the JSON pointer to it.

        Raises:
            Refused: 422, it names none, or both forms, or a video or annotations twice.
        """
        alone = Recorded.model_construct(**{name: getattr(self, name) for name in Recorded.model_fields})
        found = [("", alone)]
        if self.videos is not None:
            if any(getattr(alone, name) is not None for name in Recorded.model_fields):
                raise invalid(
                    [FieldError(pointer="/videos", detail="either videos, or video_upload and what is with it")]
                )
            found = [(f"/videos/{number}", one) for number, one in enumerate(self.videos)]
        for pointer, one in found:
            one.require_one_of_each(pointer)
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
async def asked_by_json(
    request: Request, services: Services, fetches: Fetches, owner: str, key: str | None
) -> AsyncIterator[Asked]:
    """Find the uploads that a JSON body names, and fetch what it names by URL; that is let go of with the block."""
    data = bytearray()
    async for chunk in body_of(request):
        data += chunk
        if len(data) > MAX_INLINE_BYTES:
            detail = f"a JSON body may have {MAX_INLINE_BYTES} bytes; send larger annotations as an upload"
            raise Refused(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, "too_large", detail, where="body")
    body = await run_in_threadpool(_parse_body, bytes(data))
    recorded = body.recorded()
    wanted = [file for pointer, one in recorded for file in one.wanted(pointer, services.settings)]
    if wanted:
        found = await fetches.uploads(owner, wanted)
        uploads = dict(zip((file.pointer for file in wanted), found, strict=True))
        recorded = [(pointer, one.fetched(pointer, uploads)) for pointer, one in recorded]
    with ExitStack() as inline:
        sent = [await on_disk(partial(_recorded, services, owner, pointer, one, inline)) for pointer, one in recorded]
        _require_sum([one.video for one in sent], "video", services.settings.max_upload_bytes)
        notes = [one.annotations for one in sent if one.annotations is not None]
        _require_sum(notes, "annotations", services.settings.max_upload_bytes)
        yield Asked(owner, tuple(sent), body.parameters, key)
    if wanted:
        await fetches.done(owner, wanted)


def _parse_body(data: bytes) -> CreateBody:
    value = parse_json(data, "body")
    try:
        return CreateBody.model_validate(value)
    except ValidationError as error:
        raise invalid(field_errors(error.errors())) from None


def _recorded(services: Services, owner: str, pointer: str, one: Recorded, inline: ExitStack) -> Sent:
    """A video and its annotations as files; those that were in the body are removed with `inline`."""
    video = _upload(services, owner, one.video_upload or "", f"{pointer}/video_upload")
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
