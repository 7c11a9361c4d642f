"""Query parameters that a route does not declare are refused: a misspelt filter must not choose everything."""

from __future__ import annotations

from collections.abc import Iterator
from http import HTTPStatus

from fastapi import Request
from fastapi.dependencies.models import Dependant
from fastapi.routing import APIRoute

from api.auth import BEARER, caller
from api.problems import FieldError, Refused, pointer
from core.names import unknown_name

_SHOWN = 64
"""Characters of an unknown name that are repeated in the answer."""


async def known_query(request: Request) -> None:
    """Dependency of the whole application: 422 for a query parameter that is not of the route that was found."""
    if not request.query_params:
        return
    route = request.scope["route"]
    assert isinstance(route, APIRoute)  # only these have dependencies
    known, needs_caller = _declared(route)
    unknown = [name for name in request.query_params if name not in known]
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


def _words(name: str, known: tuple[str, ...]) -> str:
    return unknown_name("query parameter", name, known)


def _declared(route: APIRoute) -> tuple[tuple[str, ...], bool]:
    """Names of the route's query parameters, and whether it asks who calls."""
    dependants = list(_flat(route.dependant))
    names = tuple(dict.fromkeys(field.alias for one in dependants for field in one.query_params))
    return names, any(one.call is caller for one in dependants)


def _flat(dependant: Dependant) -> Iterator[Dependant]:
    yield dependant
    for inner in dependant.dependencies:
        yield from _flat(inner)
