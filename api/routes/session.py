"""Sessions of browsers: a key becomes a cookie for a while."""

from __future__ import annotations

from datetime import datetime
from http import HTTPStatus
from typing import Any

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field
from starlette.concurrency import run_in_threadpool

from api.auth import BEARER, COOKIE, AnyCaller
from api.prefix import prefix_of
from api.problems import Refused, responses
from api.state import state_of
from store.account_models import Scope
from store.web_sessions import SESSION_LENGTH

router = APIRouter(prefix="/v1/session", tags=["accounts"])

_EXAMPLE: dict[str, Any] = {"account": "default", "scopes": ["read", "submit"], "expires_at": "2026-05-04T21:30:02Z"}


class Session(BaseModel):
    """In whose name requests are made, and what they may do."""

    model_config = ConfigDict(json_schema_extra={"example": _EXAMPLE})

    account: str = Field(description="id of the account")
    scopes: list[Scope]
    expires_at: datetime | None = Field(description="when a session that was just begun ends; null otherwise")


@router.post("", status_code=201, summary="Begin a session", responses=responses(401, 409, 503))
async def begin(request: Request, response: Response, caller: AnyCaller) -> Session:
    """Take the key of `Authorization` and answer with a cookie for 12 hours, or until the key ends.

    The cookie is HttpOnly and SameSite=Strict. Reads work with it alone; changes also need the header
    `X-BladeAtlas-Write: 1`.
    """
    if not caller.key_id:
        detail = "no API key was made yet, so this machine needs no session"
        raise Refused(HTTPStatus.CONFLICT, "no_keys", detail)
    if await BEARER(request) is None:
        detail = "a session begins with an API key: Authorization: Bearer KEY"
        raise Refused(HTTPStatus.UNAUTHORIZED, "unauthorized", detail, headers={"WWW-Authenticate": "Bearer"})
    cookie, until = await run_in_threadpool(state_of(request).sessions.begin, caller.key_id)
    response.set_cookie(
        COOKIE,
        cookie,
        max_age=int(SESSION_LENGTH.total_seconds()),
        path=_path(request),
        secure=request.url.scheme == "https",
        httponly=True,
        samesite="strict",
    )
    response.headers["Cache-Control"] = "no-store"
    return Session(account=caller.owner, scopes=_scopes(caller), expires_at=until)


@router.get("", summary="Say who asks", responses=responses(401, 503))
def look(caller: AnyCaller) -> Session:
    """The account and the scopes of the key or session that the request was made with."""
    return Session(account=caller.owner, scopes=_scopes(caller), expires_at=None)


@router.delete("", status_code=204, response_class=Response, summary="End the session", responses=responses(401, 503))
def end(request: Request, caller: AnyCaller) -> Response:
    """End the session of the cookie and take the cookie back; without one nothing happens."""
    if COOKIE in request.cookies:
        state_of(request).sessions.end(request.cookies[COOKIE])
    answer = Response(status_code=HTTPStatus.NO_CONTENT)
    answer.delete_cookie(COOKIE, path=_path(request), httponly=True, samesite="strict")
    return answer


def _path(request: Request) -> str:
    """Below which the cookie is sent: behind a prefix nobody else on this host gets it."""
    return prefix_of(request.scope) or "/"


def _scopes(caller: AnyCaller) -> list[Scope]:
    return [scope for scope in Scope if scope in caller.scopes]
