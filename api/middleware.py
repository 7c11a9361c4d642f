"""Around every request: a name for it, the time it took, headers of every answer, and no unknown query parameter."""

from __future__ import annotations

import re
import time
import uuid
from collections.abc import Iterator
from http import HTTPStatus

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute
from prometheus_client import CollectorRegistry, Counter, Histogram
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from api.auditing import Auditor
from api.auth import BEARER, caller, reader_or_link
from api.parameters import METADATA
from api.problems import FieldError, Refused, pointer
from core.metadata import is_metadata_name
from core.names import unknown_name

_USABLE = re.compile(r"[A-Za-z0-9._-]{1,64}")
_BUCKETS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 10.0, 60.0)

_ACTIVE = ("text/html", "image/svg+xml", "application/xhtml+xml")
"""Kinds of files that a browser runs."""
_POLICY = (
    "default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""For pages that are files of a result, such as the gallery: they show their own pictures and reach nothing else."""
_INTERNAL = int(HTTPStatus.INTERNAL_SERVER_ERROR)
_SHOWN = 64
"""Characters of an unknown name that are repeated in the answer."""


class RequestMetrics:
    """Counts and durations of requests, by route and not by path, so that ids make no new series."""

    def __init__(self, registry: CollectorRegistry) -> None:
        labels = ("method", "route", "status")
        self._requests = Counter("bladeatlas_http_requests", "requests answered", labels, registry=registry)
        self._seconds = Histogram(
            "bladeatlas_http_request_seconds",
            "time until the answer was through",
            ("method", "route"),
            buckets=_BUCKETS,
            registry=registry,
        )

    def note(self, scope: Scope, status: int, seconds: float) -> None:
        """Count one request."""
        route = getattr(scope.get("route"), "path", "none")
        method = scope["method"] if route != "none" else "any"
        self._requests.labels(method, route, str(status)).inc()
        self._seconds.labels(method, route).observe(seconds)


class RequestMiddleware:
    """Pure ASGI: streams pass through untouched."""

    def __init__(self, app: ASGIApp, metrics: RequestMetrics, auditor: Auditor) -> None:
        self._app = app
        self._metrics = metrics
        self._auditor = auditor

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Name the request, answer it, count it; what would change something is written down before its answer."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        name = _request_id(scope)
        scope.setdefault("state", {})["request_id"] = name
        started, status = time.monotonic(), 0
        audited = self._auditor.concerns(scope)

        async def named(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                if audited:
                    await self._auditor.note(scope, status)
                headers = MutableHeaders(scope=message)
                headers["X-Request-Id"] = name
                headers.setdefault("X-Content-Type-Options", "nosniff")
                headers.setdefault("Cache-Control", "no-cache")
                if headers.get("content-type", "").startswith(_ACTIVE):
                    headers.setdefault("Content-Security-Policy", _POLICY)
            await send(message)

        try:
            await self._app(scope, receive, named)
        except Exception:
            if audited and not status:  # answered above this, as an internal error
                await self._auditor.note(scope, _INTERNAL)
            raise
        finally:
            self._metrics.note(scope, status or _INTERNAL, time.monotonic() - started)


def _request_id(scope: Scope) -> str:
    """The client's own name for the request when it is harmless in a log, else a new one."""
    given = Headers(scope=scope).get("x-request-id", "")
    return given if _USABLE.fullmatch(given) else uuid.uuid4().hex


async def known_query(request: Request) -> None:
    """Dependency of the whole application: 422 for a query parameter that is not of the route that was found."""
    if not request.query_params:
        return
    route = request.scope["route"]
    assert isinstance(route, APIRoute)  # only these have dependencies
    known, needs_caller = _declared(route)
    unknown = [name for name in request.query_params if name not in known and not _is_metadata(name, known)]
    if not unknown:
        return
    if needs_caller:  # who may not ask at all is told that first
        await caller(request, await BEARER(request))
    errors = [
        FieldError(pointer=pointer(("query", name[:_SHOWN])), detail=_words(name[:_SHOWN], known)) for name in unknown
    ]
    where = f"query.{unknown[0][:_SHOWN]}"
    status = HTTPStatus.UNPROCESSABLE_ENTITY
    raise Refused(status, "unknown_parameter", errors[0].detail, where=where, errors=errors)


def _is_metadata(name: str, known: tuple[str, ...]) -> bool:
    """True for ``metadata.NAME`` where the route takes such filters: beside the declared ones any name may be asked."""
    if not name.startswith(METADATA) or not any(each.startswith(METADATA) for each in known):
        return False
    return is_metadata_name(name.removeprefix(METADATA))


def _words(name: str, known: tuple[str, ...]) -> str:
    return unknown_name("query parameter", name, known)


def _declared(route: APIRoute) -> tuple[tuple[str, ...], bool]:
    """Names of the route's query parameters, and whether it asks who calls."""
    dependants = list(_flat(route.dependant))
    names = tuple(dict.fromkeys(field.alias for one in dependants for field in one.query_params))
    return names, any(one.call in (caller, reader_or_link) for one in dependants)


def _flat(dependant: Dependant) -> Iterator[Dependant]:
    yield dependant
    for inner in dependant.dependencies:
        yield from _flat(inner)
