"""Who calls: an account, by one of its keys, or, as long as no key was ever made, whoever calls from this machine.

A browser that showed a key once goes on with a cookie. A cookie comes along without anybody's will, so it counts only
in requests of the server's own pages, and for changes only beside a header that no foreign page can add.
"""

from __future__ import annotations

import re
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from http import HTTPStatus
from typing import Annotated

from fastapi import Depends, Query, Request
from fastapi.security import HTTPAuthorizationCredentials, HTTPBearer
from starlette.concurrency import run_in_threadpool

from api.prefix import own_path
from api.problems import Refused
from api.state import State, state_of
from api.threads import WHOSE
from api.trust import is_loopback_address, is_own_site
from store.account_models import DEFAULT_ACCOUNT, USUAL_SCOPES, Scope
from store.keys import KeyView, utc_now
from store.links import Links, Signature

BEARER = HTTPBearer(
    auto_error=False, description="API key from `bladeatlas keys create`. Without any key the server serves loopback."
)
COOKIE = "bladeatlas_session"
WRITE_HEADER = "X-BladeAtlas-Write"
"""Any value of it will do: a page of another origin cannot send it without being allowed to."""
READS = ("GET", "HEAD", "OPTIONS")
_LINKED = re.compile(r"/v1/inspections/([0-9a-f]{32})/(.+)", re.DOTALL)
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
    """The caller of a request.

    Raises:
        Refused: 401 for a missing key or session, and for one that is not valid; 403 for a session that a foreign page
            uses, or that changes something without the header for it.
        LimitReached: the account, or all together, ask too often.
    """
    state = state_of(request)
    found = await _identified(request, state, credentials)
    request.state.caller = found  # for the audit log, also of requests that are refused below
    WHOSE.set(found.owner)
    if not state.rate.spend(found.owner):
        await run_in_threadpool(state.rate.spend_slowly, found.owner)
    return found


async def _identified(request: Request, state: State, credentials: HTTPAuthorizationCredentials | None) -> Caller:
    ring = state.keys
    if state.services.settings.no_auth and credentials is None and COOKIE not in request.cookies:
        return Caller(DEFAULT_ACCOUNT, "", frozenset(USUAL_SCOPES))
    if not ring.fresh:
        await run_in_threadpool(ring.refresh)
    if not ring.ever_made and credentials is None:
        if _is_loopback(request):
            return Caller(DEFAULT_ACCOUNT, "", frozenset(Scope))
        raise _unauthorized(
            "no API key was made yet, so only this machine is served; make one with `bladeatlas keys create`"
        )
    if credentials is not None:
        key = _valid(ring.find(credentials.credentials), "this API key is not valid")
    elif COOKIE in request.cookies:
        key_id = await run_in_threadpool(state.sessions.find, request.cookies[COOKIE])
        key = _valid(ring.by_id(key_id or ""), "this session is over")
        _require_own_will(request)
    else:
        raise _unauthorized("an API key is needed: Authorization: Bearer KEY")
    if ring.unnoted(key.id):
        await run_in_threadpool(ring.keys.note_use, key.id)
    return Caller(key.account_id, key.id, frozenset(key.scopes))


async def reader_or_link(
    request: Request,
    credentials: Annotated[HTTPAuthorizationCredentials | None, Depends(BEARER)],
    expires: Annotated[int | None, Query(ge=0, le=1 << 40, description="of a signed link")] = None,
    signature: Annotated[str | None, Query(max_length=64, description="of a signed link")] = None,
) -> Caller:
    """The caller with the scope `read`, or the account whose link this is; 403 for a link that is not good."""
    if signature is None and expires is None:
        found = await caller(request, credentials)
        found.require(Scope.READ)
        return found
    state, linked = state_of(request), _LINKED.fullmatch(own_path(request.scope))
    owner = None
    if linked is not None and signature is not None and expires is not None and signature.isascii():
        links, given = Links(state.services.db), Signature(expires, signature)
        owner = await run_in_threadpool(links.owner, linked[1], linked[2], given)
    WHOSE.set(owner or "")
    if owner is None:
        detail = "this link is not good, or its time is over, or its account ended its links"
        raise Refused(HTTPStatus.FORBIDDEN, "bad_link", detail, where="signature")
    if not state.rate.spend(owner):
        await run_in_threadpool(state.rate.spend_slowly, owner)
    return Caller(owner, "", frozenset({Scope.READ}))


def _require_own_will(request: Request) -> None:
    """403 for a request with a cookie that a foreign page may have made a browser send."""
    if not is_own_site(request):
        detail = "a session is for pages of this server; use a key from elsewhere"
        raise Refused(HTTPStatus.FORBIDDEN, "cross_site", detail, where="Origin")
    if request.method not in READS and WRITE_HEADER not in request.headers:
        detail = f"with a session a change needs the header {WRITE_HEADER}: 1"
        raise Refused(HTTPStatus.FORBIDDEN, "missing_header", detail, where=WRITE_HEADER)


def _valid(key: KeyView | None, otherwise: str) -> KeyView:
    if key is None:
        raise _unauthorized(otherwise)
    ended = key.ended(utc_now())
    if ended is not None:
        raise _unauthorized(f"this API key {ended}")
    return key


def _unauthorized(detail: str) -> Refused:
    return Refused(HTTPStatus.UNAUTHORIZED, "unauthorized", detail, headers=_CHALLENGE)


def _is_loopback(request: Request) -> bool:
    host = request.client.host if request.client else ""
    return host in ("localhost", "") or is_loopback_address(host)  # "": a socket of this machine


def requires(scope: Scope) -> Callable[[Caller], Awaitable[Caller]]:
    """A dependency: the caller, who has this scope."""

    async def check(found: Annotated[Caller, Depends(caller)]) -> Caller:  # a plain function would take a thread
        found.require(scope)
        return found

    return check


Reader = Annotated[Caller, Depends(requires(Scope.READ))]
"""Parameter of a route that shows what the caller's account has, or what concerns everybody."""
LinkReader = Annotated[Caller, Depends(reader_or_link)]
"""Parameter of a route that also signed links open."""
Submitter = Annotated[Caller, Depends(requires(Scope.SUBMIT))]
"""Parameter of a route that sends, starts, stops or deletes something of the caller's account."""
Reviewer = Annotated[Caller, Depends(requires(Scope.REVIEW))]
"""Parameter of a route that says something of findings of the caller's account."""
Manager = Annotated[Caller, Depends(requires(Scope.MANAGE))]
"""Parameter of a route about how the caller's account is connected to others."""
Administrator = Annotated[Caller, Depends(requires(Scope.ADMIN))]
"""Parameter of a route about all accounts."""
AnyCaller = Annotated[Caller, Depends(caller)]
"""Parameter of a route for any valid key."""
