"""Errors as `application/problem+json` (RFC 9457). The only place that knows HTTP statuses of errors."""

from __future__ import annotations

from http import HTTPStatus

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from pydantic import BaseModel, ConfigDict, Field
from starlette.exceptions import HTTPException

from core.errors import BadInput, BladeAtlasError, Cancelled, DiskFull, NoReconstruction, ResourceError

MEDIA_TYPE = "application/problem+json"
_STATUS: tuple[tuple[type[BladeAtlasError], HTTPStatus], ...] = (
    (BadInput, HTTPStatus.UNPROCESSABLE_ENTITY),
    (NoReconstruction, HTTPStatus.CONFLICT),
    (Cancelled, HTTPStatus.CONFLICT),
    (DiskFull, HTTPStatus.INSUFFICIENT_STORAGE),
    (ResourceError, HTTPStatus.SERVICE_UNAVAILABLE),
)


class Problem(BaseModel):
    """One error: what kind, in words, and where."""

    model_config = ConfigDict(
        json_schema_extra={
            "example": {
                "type": "about:blank",
                "title": "Unprocessable Content",
                "status": 422,
                "detail": "unknown preset 'fast'; known: default, thesis, draft",
                "instance": "/v1/presets/fast",
                "code": "bad_input",
                "where": "preset",
            }
        }
    )

    type: str = Field("about:blank", description="kind of problem; the `code` tells more")
    title: str = Field(description="the status in words")
    status: int = Field(description="HTTP status")
    detail: str = Field(description="what happened, in one sentence")
    instance: str = Field(description="path of the request")
    code: str = Field(description="stable code for programs")
    where: str = Field("", description="the field, option or place in a file that is wrong")


def install(app: FastAPI) -> None:
    """Answer every error of `app` as a problem."""
    app.add_exception_handler(BladeAtlasError, _expected)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(HTTPException, _http)
    app.add_exception_handler(Exception, _unexpected)


def status_of(error: BladeAtlasError) -> HTTPStatus:
    """HTTP status of an expected error."""
    return next((status for kind, status in _STATUS if isinstance(error, kind)), HTTPStatus.INTERNAL_SERVER_ERROR)


def _expected(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, BladeAtlasError)  # registered for this class only
    return _respond(request, status_of(error), error.message, error.code, error.where)


def _invalid(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, RequestValidationError)  # registered for this class only
    first = error.errors()[0]
    where = ".".join(str(part) for part in first["loc"])
    return _respond(request, HTTPStatus.UNPROCESSABLE_ENTITY, str(first["msg"]), "bad_request", where)


def _http(request: Request, error: Exception) -> JSONResponse:
    assert isinstance(error, HTTPException)  # registered for this class only
    status = HTTPStatus(error.status_code)
    return _respond(request, status, str(error.detail), status.name.lower(), headers=dict(error.headers or {}))


def _unexpected(request: Request, error: Exception) -> JSONResponse:
    # The cause goes to the log of the server, never to the client.
    return _respond(request, HTTPStatus.INTERNAL_SERVER_ERROR, "an internal error happened", "internal")


def _respond(
    request: Request,
    status: HTTPStatus,
    detail: str,
    code: str,
    where: str = "",
    headers: dict[str, str] | None = None,
) -> JSONResponse:
    problem = Problem(
        type="about:blank",
        title=status.phrase,
        status=status.value,
        detail=detail,
        instance=request.url.path,
        code=code,
        where=where,
    )
    return JSONResponse(problem.model_dump(), status.value, headers=headers, media_type=MEDIA_TYPE)
