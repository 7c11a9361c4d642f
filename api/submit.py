"""Submission: from what a request sent (`api.sending`) to an inspection.

The request is checked, its files are stored by content, and the inspection is written in one transaction and told of.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import Any

from fastapi import Request
from pydantic import ValidationError
from sqlalchemy.exc import IntegrityError
from starlette.concurrency import run_in_threadpool

from api.limits import require_space
from api.problems import FieldError, Refused, field_errors, pointer
from api.receiving import on_disk, while_there
from api.schemas import Parameters
from api.services import Services
from api.state import State
from core.errors import BadInput
from core.fingerprint import digest_of
from core.settings import Settings, make_settings
from core.videos import Recording
from store.accounts import Accounts
from store.admission import IdempotencyKeys, Place
from store.records import InputFiles


@dataclass(frozen=True)
class LocalFile:
    """A file on this machine that came with a request, and its content's name."""

    path: Path
    sha256: str


@dataclass(frozen=True)
class Sent:
    """A video that came with a request, and its annotations."""

    video: LocalFile
    annotations: LocalFile | None

    @property
    def recording(self) -> Recording:
        """Where they lie."""
        return Recording(self.video.path, self.annotations.path if self.annotations else None)

    def names(self) -> dict[str, str | None]:
        """Both by content."""
        return {"video": self.video.sha256, "annotations": self.annotations.sha256 if self.annotations else None}


@dataclass(frozen=True)
class Asked:
    """What a request asks for."""

    owner: str
    sent: tuple[Sent, ...]
    """Its videos in order."""
    parameters: Parameters
    idempotency_key: str | None

    def digest(self) -> str:
        """Name of the request by content, however it was sent."""
        parameters = self.parameters.model_dump(mode="json")
        if not self.parameters.priority:  # the name that the same request had before there were these
            del parameters["priority"]
        if not self.parameters.metadata:
            del parameters["metadata"]
        names = self.sent[0].names() if len(self.sent) == 1 else {"videos": [one.names() for one in self.sent]}
        return digest_of({**names, "parameters": parameters})


async def accept(state: State, asked: Asked, request: Request) -> str:
    """Make the inspection that was asked for, or find the one that the same request made before; its id.

    Raises:
        Refused: 409 while the same request is under way, 422 for parameters or a priority, 429 or 503 when too many
            wait.
        LimitReached: too many are active, or too many bytes are kept.
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
        await run_in_threadpool(require_priority, state.services, asked.owner, asked.parameters.priority)
        recordings = [one.recording for one in asked.sent]
        await while_there(request, state.prober.check(asked.owner, recordings, settings))
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


def require_priority(services: Services, owner: str, priority: int, where: str = "/parameters/priority") -> None:
    """422 for a priority above the highest of the account."""
    if not priority:
        return
    highest = Accounts(services.db).get(owner).max_priority
    if priority > highest:
        detail = f"priority {priority} is above {highest}, the highest of this account"
        errors = [FieldError(pointer=where, detail=detail)]
        status = HTTPStatus.UNPROCESSABLE_ENTITY
        raise Refused(status, "bad_parameters", detail, where="priority", errors=errors)


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
    files = [file for one in asked.sent for file in (one.video, one.annotations) if file is not None]
    size = sum(file.path.stat().st_size for file in files)
    with services.admission.place(asked.owner, size) as place:
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
                priority=asked.parameters.priority,
                input_bytes=place.input_bytes,
                reuse_account=services.reuse_account(asked.owner),
                label=asked.parameters.label,
                external_id=asked.parameters.external_id,
                metadata=asked.parameters.metadata,
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


def _store_inputs(services: Services, asked: Asked) -> list[InputFiles]:
    return [_store(services, one.video, one.annotations) for one in asked.sent]


def _store(services: Services, video: LocalFile, annotations: LocalFile | None) -> InputFiles:
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
