"""Errors as `application/problem+json` (RFC 9457). The only place that knows HTTP statuses of errors."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict, Field
from sqlalchemy.exc import DBAPIError, InterfaceError, OperationalError, SQLAlchemyError
from sqlalchemy.exc import TimeoutError as PoolTimeout
from starlette.exceptions import HTTPException

from core.errors import BadInput, BladeAtlasError, Cancelled, DiskFull, NoReconstruction, ResourceError
from store.admission import LimitReached
from store.json_log import logger
from store.uploads import UploadLocked

MEDIA_TYPE = "application/problem+json"
_STATUS: tuple[tuple[type[BladeAtlasError], HTTPStatus], ...] = (
    (BadInput, HTTPStatus.UNPROCESSABLE_ENTITY),
    (UploadLocked, HTTPStatus.LOCKED),
    (LimitReached, HTTPStatus.TOO_MANY_REQUESTS),
    (NoReconstruction, HTTPStatus.CONFLICT),
    (Cancelled, HTTPStatus.CONFLICT),
    (DiskFull, HTTPStatus.INSUFFICIENT_STORAGE),
    (ResourceError, HTTPStatus.SERVICE_UNAVAILABLE),
)
_BY_CODE = {
    "conflict": HTTPStatus.CONFLICT,
    "unknown_account": HTTPStatus.NOT_FOUND,
    "unknown_key": HTTPStatus.NOT_FOUND,
    "unknown_webhook": HTTPStatus.NOT_FOUND,
    "unknown_delivery": HTTPStatus.NOT_FOUND,
    "table_changed": HTTPStatus.CONFLICT,
    "stale_revision": HTTPStatus.CONFLICT,
    "bad_cursor": HTTPStatus.BAD_REQUEST,
}
_RETRYABLE = {
    HTTPStatus.LOCKED,
    HTTPStatus.TOO_MANY_REQUESTS,
    HTTPStatus.SERVICE_UNAVAILABLE,
    HTTPStatus.INSUFFICIENT_STORAGE,
}
_WAIT_S = {
    HTTPStatus.LOCKED: "1",
    HTTPStatus.TOO_MANY_REQUESTS: "30",
    HTTPStatus.SERVICE_UNAVAILABLE: "5",
    HTTPStatus.INSUFFICIENT_STORAGE: "60",
}
_Handler = Callable[[Request, Exception], JSONResponse]
_UNREACHABLE = "the database does not answer"

log = logger("bladeatlas.api")


class FieldError(BaseModel):
    """One place in the request that is wrong."""

    pointer: str = Field(description="JSON pointer (RFC 6901) into the body, or into `/query`, `/path`, `/header`")
    detail: str = Field(description="what is wrong with it")


class Problem(BaseModel):
    """One error: what kind, in words, and where."""

    model_config = ConfigDict(
        json_schema_serialization_defaults_required=True,
        json_schema_extra={
            "example": {
                "type": "about:blank",
                "title": "Unprocessable Entity",
                "status": 422,
                "detail": "unknown preset 'fast'; known: default, thesis, draft",
                "instance": "/v1/presets/fast",
                "code": "bad_input",
                "where": "preset",
                "request_id": "5f0c9cf5c9a14ab1a2c2e6b0c8a4b1de",
                "retryable": False,
                "errors": [],
            }
        },
    )

    type: str = Field("about:blank", description="kind of problem; the `code` tells more")
    title: str = Field(description="the status in words")
    status: int = Field(description="HTTP status")
    detail: str = Field(description="what happened, in one sentence")
    instance: str = Field(description="path of the request")
    code: str = Field(description="stable code for programs")
    where: str = Field("", description="the field, option or place in a file that is wrong")
    request_id: str = Field("", description="names this request in the server's log")
    retryable: bool = Field(False, description="the same request may succeed later")
    errors: list[FieldError] = Field([], description="every place that is wrong, where there are several")


class Refused(Exception):
    """A request that HTTP itself has a status for: no such thing, gone, too large, not yet."""

    def __init__(
        self,
        status: HTTPStatus,
        code: str,
        detail: str,
        *,
        where: str = "",
        headers: Mapping[str, str] | None = None,
        errors: Sequence[FieldError] = (),
        retryable: bool | None = None,
    ) -> None:
        super().__init__(detail)
        self.status, self.code, self.detail, self.where = status, code, detail, where
        self.headers, self.errors = dict(headers or {}), list(errors)
        self.retryable = status in _RETRYABLE if retryable is None else retryable


def not_found(what: str) -> Refused:
    """404: there is no such thing, or it belongs to another account."""
    return Refused(HTTPStatus.NOT_FOUND, "not_found", f"there is no such {what}")


def install(app: FastAPI) -> None:
    """Answer every error of `app` as a problem."""
    kinds = (OperationalError, InterfaceError, PoolTimeout, DBAPIError)
    handlers: dict[type[Exception], _Handler] = {
        BladeAtlasError: _expected,
        Refused: _refused,
        RequestValidationError: _invalid,
        HTTPException: _http,
        **dict.fromkeys(kinds, _database),
        Exception: _unexpected,
    }
    for kind, handler in handlers.items():
        app.add_exception_handler(kind, partial(_at_once, handler))


async def _at_once(handler: _Handler, request: Request, error: Exception) -> JSONResponse:
    """The handler's answer on the event loop: a plain function would take one of the threads, all of which may wait."""
    return handler(request, error)


def answer(request: Request, error: Refused | SQLAlchemyError) -> JSONResponse:
    """The answer to a request that is refused before any route sees it."""
    return _refused(request, error) if isinstance(error, Refused) else _database(request, error)


def responses(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """OpenAPI's entries for the problems that a route may answer with.

    Who has to say who asks (401) may also be somebody who may not do this (403), or asks too often (429).
    """
    also = {403, 429} if 401 in statuses else set()
    return {
        status: {"model": Problem, "description": HTTPStatus(status).phrase} for status in sorted(also.union(statuses))
    }


def status_of(error: BladeAtlasError) -> HTTPStatus:
    """HTTP status of an expected error."""
    if isinstance(error, BadInput) and error.code in _BY_CODE:
        return _BY_CODE[error.code]
    return next((status for kind, status in _STATUS if isinstance(error, kind)), HTTPStatus.INTERNAL_SERVER_ERROR)


def field_errors(errors: Sequence[Any], below: str = "") -> list[FieldError]:
    """What pydantic found, with JSON pointers."""
    return [FieldError(pointer=below + pointer(error["loc"]), detail=str(error["msg"])) for error in errors]


def pointer(parts: Sequence[Any]) -> str:
    """JSON pointer of a path of keys and indices."""
    return "".join("/" + str(part).replace("~", "~0").replace("/", "~1") for part in parts)


def _expected(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, BladeAtlasError)  # registered for this class only
    status = status_of(error)
    headers = _later(status)
    if isinstance(error, LimitReached) and error.retry_after_s is not None:
        headers["Retry-After"] = str(error.retry_after_s)
    return _respond(request, Refused(status, error.code, error.message, where=error.where, headers=headers))


def _refused(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, Refused)  # registered for this class only
    error.headers = {**_later(error.status), **error.headers}
    return _respond(request, error)


def _invalid(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)  # registered for this class only
    found = error.errors()
    first = found[0]
    if first["loc"][0] == "path":  # an id that does not parse names nothing
        return _respond(request, not_found("thing"))
    where = ".".join(str(part) for part in first["loc"])
    errors = [FieldError(pointer=pointer(_without_body(each["loc"])), detail=str(each["msg"])) for each in found]
    status = HTTPStatus.UNPROCESSABLE_ENTITY
    return _respond(request, Refused(status, "bad_request", str(first["msg"]), where=where, errors=errors))


def _without_body(parts: Sequence[Any]) -> Sequence[Any]:
    return parts[1:] if parts and parts[0] == "body" else parts


def _http(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)  # registered for this class only
    status = HTTPStatus(error.status_code)
    return _respond(request, Refused(status, status.name.lower(), str(error.detail), headers=error.headers))


def _database(request: Request, error: Exception) -> JSONResponse:
    """The database is away: the client may come back. Its words may name hosts, so they stay in the log."""
    lost = isinstance(error, OperationalError | InterfaceError | PoolTimeout)
    if not lost and not (isinstance(error, DBAPIError) and error.connection_invalidated):
        return _unexpected(request, error)
    log.warning("database_unreachable", request_id=request_id(request), error=type(error).__name__)
    status = HTTPStatus.SERVICE_UNAVAILABLE
    return _respond(request, Refused(status, "database_unreachable", _UNREACHABLE, headers=_later(status)))


def _unexpected(request: Request, error: Exception) -> JSONResponse:
    # The cause goes to the log of the server, never to the client.
    log.error("unexpected_error", request_id=request_id(request), path=request.url.path, exc_info=error)
    return _respond(request, Refused(HTTPStatus.INTERNAL_SERVER_ERROR, "internal", "an internal error happened"))


def _later(status: HTTPStatus) -> dict[str, str]:
    return {"Retry-After": _WAIT_S[status]} if status in _WAIT_S else {}


def request_id(request: Request) -> str:
    """The request's name; empty before the middleware gave it one."""
    return str(getattr(request.state, "request_id", ""))


def _respond(request: Request, refused: Refused) -> JSONResponse:
    problem = Problem(
        type="about:blank",
        title=refused.status.phrase,
        status=refused.status.value,
        detail=refused.detail,
        instance=request.url.path,
        code=refused.code,
        where=refused.where,
        request_id=request_id(request),
        retryable=refused.retryable,
        errors=refused.errors,
    )
    request.state.problem_code = problem.code  # for the audit log
    # "ignore": a path or a value may hold what is no character, and an error must still be told.
    body = problem.model_dump_json().encode("utf-8", "ignore")
    headers = {"X-Request-Id": problem.request_id, **refused.headers}
    response = JSONResponse(None, refused.status.value, headers=headers, media_type=MEDIA_TYPE)
    response.body = body
    response.headers["Content-Length"] = str(len(body))
    return response
