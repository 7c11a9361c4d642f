"""Who calls: the owner of an API key, or, as long as no key was ever made, whoever calls from this machine."""

from __future__ import annotations

from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from starlette.concurrency import run_in_threadpool

from api.problems import Refused
from api.state import State, state_of
from api.trust import is_loopback_address

BEARER = HTTPBearer(
    auto_error=False, description="API key from `bladeatlas keys create`. Without any key the server serves loopback."
)
_CHALLENGE = {"WWW-Authenticate": "Bearer"}


@dataclass(frozen=True)
class Caller:
    """Who asks: only what belongs to the same owner is shown."""

    owner: str
    """Id of the API key; empty without keys."""


async def caller(
    request: Request, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(BEARER)]
) -> Caller:
    """The caller of a request; 401 for a missing or unknown key."""
    state: State = state_of(request)
    ring = state.keys
    if not ring.fresh:
        await run_in_threadpool(ring.refresh)
    if not ring.ever_made and credentials is None:
        if _is_loopback(request):
            return Caller("")
        detail = "no API key was made yet, so only this machine is served; make one with `bladeatlas keys create`"
        raise Refused(HTTPStatus.UNAUTHORIZED, "unauthorized", detail, headers=_CHALLENGE)
    owner = ring.owner(credentials.credentials) if credentials is not None else None
    if owner is None:
        detail = "this API key is not valid" if credentials else "an API key is needed: Authorization: Bearer KEY"
        raise Refused(HTTPStatus.UNAUTHORIZED, "unauthorized", detail, headers=_CHALLENGE)
    if ring.unnoted(owner):
        await run_in_threadpool(ring.keys.note_use, owner)
    return Caller(owner)


def _is_loopback(request: Request) -> bool:
    host = request.client.host if request.client else ""
    return host in ("localhost", "") or is_loopback_address(host)  # "": a socket of this machine


CallerOf = Annotated[Caller, Depends(caller)]
"""Parameter of every route below ``/v1``."""
