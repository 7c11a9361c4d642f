"""Which requests are answered at all: those that were sent to this server by its name, and not by a foreign page.

While no key was ever made, whoever reaches the server may do anything, and a browser on this machine reaches it for
every page that it shows: directly, or after a foreign name was made to mean 127.0.0.1. So the name must be one of
this machine, and the browser must not say that another site asks. With keys a foreign page has none to send; which
names the server goes by is a setting then.
"""

from __future__ import annotations

import ipaddress
import re
from dataclasses import dataclass
from http import HTTPStatus

from fastapi import Request
from sqlalchemy.exc import SQLAlchemyError
from starlette.concurrency import run_in_threadpool
from starlette.types import ASGIApp, Receive, Scope, Send

from api.prefix import own_path
from api.problems import Refused, answer
from store.keys import KeyRing

_HOST = re.compile(r"(\[[0-9A-Fa-f:.]+\]|[A-Za-z0-9._-]+)(?::(\d{1,5}))?")
_ORIGIN = re.compile(r"(https?)://(.+)")
_PORTS = {"http": "80", "https": "443"}
_OWN_SITE = ("same-origin", "none")
"""What a browser says of requests that the server's own pages or the user make; programs say nothing."""
_FOR_ANYBODY = "/healthz"
"""Says only that the process lives, to load balancers that know it by its address."""


@dataclass(frozen=True)
class HostName:
    """The name and the port of a `Host` header, or of an origin."""

    name: str
    port: str | None

    @staticmethod
    def parse(text: str) -> HostName | None:
        """None for what is no host."""
        found = _HOST.fullmatch(text)
        return HostName(found[1].lower().strip("[]"), found[2]) if found else None

    @property
    def is_address(self) -> bool:
        """True for an address, which no name server gives another meaning."""
        try:
            ipaddress.ip_address(self.name)
        except ValueError:
            return False
        return True

    @property
    def is_loopback(self) -> bool:
        """True for names that mean this machine whatever a name server says."""
        return self.name == "localhost" or is_loopback_address(self.name)


def is_loopback_address(text: str) -> bool:
    """True for 127.0.0.0/8 and ::1."""
    try:
        return ipaddress.ip_address(text).is_loopback
    except ValueError:
        return False


class TrustMiddleware:
    """Refuses other names with 421 and, without keys, other sites with 403; nothing of the request is done then."""

    def __init__(self, app: ASGIApp, keys: KeyRing, trusted_hosts: frozenset[str], *, no_auth: bool = False) -> None:
        self._app, self._keys, self._trusted, self._no_auth = app, keys, trusted_hosts, no_auth

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Look at the headers and pass the request on."""
        if scope["type"] == "http" and own_path(scope) != _FOR_ANYBODY:
            request = Request(scope)
            try:
                await self._require_trust(request)
            except (Refused, SQLAlchemyError) as error:
                await answer(request, error)(scope, receive, send)
                return
        await self._app(scope, receive, send)

    async def _require_trust(self, request: Request) -> None:
        host = _host_of(request)
        local, own = host is not None and host.is_loopback, is_own_site(request)
        if local and own:
            return  # fine with and without keys, so the database need not be asked
        if self._no_auth:
            self._require_no_foreign_page(host, own)
            return
        if not self._keys.fresh:
            await run_in_threadpool(self._keys.refresh)
        if not self._keys.ever_made:
            if not local:
                raise _misdirected("without API keys the server answers only to names of this machine")
            detail = "without API keys the server answers no page of another site"
            raise Refused(HTTPStatus.FORBIDDEN, "cross_site", detail, where="Origin")
        if self._trusted and not local and (host is None or host.name not in self._trusted):
            raise _misdirected("the server does not go by this name")

    def _require_no_foreign_page(self, host: HostName | None, own: bool) -> None:
        """Who needs no key must not be a browser that a foreign page makes ask, be it by a name that was rebound."""
        if host is None or not (host.is_loopback or host.is_address or host.name in self._trusted):
            raise _misdirected("without keys the server answers to addresses and to the names in trusted_hosts")
        if not own:
            detail = "without keys the server answers no page of another site"
            raise Refused(HTTPStatus.FORBIDDEN, "cross_site", detail, where="Origin")


def _misdirected(detail: str) -> Refused:
    return Refused(HTTPStatus.MISDIRECTED_REQUEST, "untrusted_host", detail, where="Host")


def _host_of(request: Request) -> HostName | None:
    """None when it is missing, given twice or no name."""
    given = request.headers.getlist("host")
    return HostName.parse(given[0]) if len(given) == 1 else None


def is_own_site(request: Request) -> bool:
    """True unless the browser says that a page of another site, or of another port, asks."""
    host = _host_of(request)
    if any(site not in _OWN_SITE for site in request.headers.getlist("sec-fetch-site")):
        return False
    return all(_is_own_origin(origin, host) for origin in request.headers.getlist("origin"))


def _is_own_origin(origin: str, host: HostName | None) -> bool:
    found = _ORIGIN.fullmatch(origin)
    page = HostName.parse(found[2]) if found else None
    if found is None or page is None or host is None:
        return False
    usual = _PORTS[found[1]]
    return (page.name, page.port or usual) == (host.name, host.port or usual)
