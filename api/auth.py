"""Who calls: an account, by one of its keys, or, as long as no key was ever made, whoever calls from this machine."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from starlette.concurrency import run_in_threadpool

from api.problems import Refused
from api.state import State, state_of
from api.trust import is_loopback_address
from store.account_models import DEFAULT_ACCOUNT, Scope
from store.keys import KeyView, utc_now

BEARER = HTTPBearer(
    auto_error=False, description="API key from `bladeatlas keys create`. Without any key the server serves loopback."
)
_CHALLENGE = {"WWW-Authenticate": "Bearer"}


@dataclass(frozen=True)
class Caller:
    """Who asks: only what belongs to the same account is shown."""

    owner: str
    """Id of the account."""
    key_id: str
    """Empty for this machine without a key."""
    scopes: frozenset[Scope]

    def require(self, scope: Scope) -> None:
        """403 unless the caller has this scope."""
        if scope not in self.scopes:
            detail = f"this needs a key with the scope '{scope}'; yours has {', '.join(sorted(self.scopes))}"
            raise Refused(HTTPStatus.FORBIDDEN, "missing_scope", detail, where="Authorization")


async def caller(
    request: Request, credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(BEARER)]
) -> Caller:
    """The caller of a request; 401 for a missing key and for one that is not valid."""
    state: State = state_of(request)
    ring = state.keys
    if not ring.fresh:
        await run_in_threadpool(ring.refresh)
    if not ring.ever_made and credentials is None:
        if _is_loopback(request):
            return Caller(DEFAULT_ACCOUNT, "", frozenset(Scope))
        raise _unauthorized(
            "no API key was made yet, so only this machine is served; make one with `bladeatlas keys create`"
        )
    if credentials is None:
        raise _unauthorized("an API key is needed: Authorization: Bearer KEY")
    key = _valid(ring.find(credentials.credentials))
    if ring.unnoted(key.id):
        await run_in_threadpool(ring.keys.note_use, key.id)
    return Caller(key.account_id, key.id, frozenset(key.scopes))


def _valid(key: KeyView | None) -> KeyView:
    if key is None:
        raise _unauthorized("this API key is not valid")
    ended = key.ended(utc_now())
    if ended is not None:
        raise _unauthorized(f"this API key {ended}")
    return key


def _unauthorized(detail: str) -> Refused:
    return Refused(HTTPStatus.UNAUTHORIZED, "unauthorized", detail, headers=_CHALLENGE)


def _is_loopback(request: Request) -> bool:
    host = request.client.host if request.client else ""
    return host in ("localhost", "") or is_loopback_address(host)  # "": a socket of this machine


def requires(scope: Scope) -> Callable[[Caller], Caller]:
    """A dependency: the caller, who has this scope."""

    def check(found: Annotated[Caller, Depends(caller)]) -> Caller:
        found.require(scope)
        return found

    return check


Reader = Annotated[Caller, Depends(requires(Scope.READ))]
"""Parameter of a route that shows what the caller's account has, or what concerns everybody."""
Submitter = Annotated[Caller, Depends(requires(Scope.SUBMIT))]
"""Parameter of a route that sends, starts, stops or deletes something of the caller's account."""
Manager = Annotated[Caller, Depends(requires(Scope.MANAGE))]
"""Parameter of a route about keys of the caller's account."""
Administrator = Annotated[Caller, Depends(requires(Scope.ADMIN))]
"""Parameter of a route about all accounts."""
