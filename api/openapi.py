"""OpenAPI 3.1 as it is served: what FastAPI derives, with errors as the problems that they are.

Programs make clients of it, so it says what must be sent, gives every call a name of its own, and names the statuses
that any route may answer with.
"""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from fastapi.routing import APIRoute

from api.problems import MEDIA_TYPE
from api.schemas import Parameters
from api.sending import CreateBody, Recorded

_BODIES = (Parameters, Recorded, CreateBody)
"""Bodies that routes read by themselves, so that FastAPI does not know them."""
_REFERENCE = "#/components/schemas/{model}"
_MARK = "x-must-be-sent"
MUST_BE_SENT: dict[str, Any] = {_MARK: True}
"""Marks a header that a client must send although a route takes its absence, to answer with another status than 422."""
_OF_ANY_ROUTE = (HTTPStatus.MISDIRECTED_REQUEST, HTTPStatus.UNPROCESSABLE_ENTITY, HTTPStatus.SERVICE_UNAVAILABLE)
"""Another host is meant, a query parameter is unknown, the database is away."""


def name_of_call(route: APIRoute) -> str:
    """Names a call for programs: the module and the function that answer it."""
    return f"{route.endpoint.__module__.rsplit('.', 1)[-1]}_{route.name}"


def install(app: FastAPI) -> None:
    """Serve the finished document at ``/openapi.json``."""

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _finished(
                get_openapi(
                    title=app.title,
                    version=app.version,
                    summary=app.summary,
                    description=app.description,
                    routes=app.routes,
                    tags=app.openapi_tags,
                )
            )
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]  # FastAPI's documented way


def _finished(document: dict[str, Any]) -> dict[str, Any]:
    schemas = document["components"]["schemas"]
    for model in _BODIES:
        schema = model.model_json_schema(ref_template=_REFERENCE)
        schemas.update(schema.pop("$defs", {}))
        schemas[model.__name__] = schema
    for path in document["paths"].values():
        for operation in path.values():
            for status in _OF_ANY_ROUTE:
                operation["responses"].setdefault(str(status.value), {"description": status.phrase})
            _mark_problems(operation["responses"])
            for parameter in operation.get("parameters", ()):
                _state_presence(parameter)
    for name in ("HTTPValidationError", "ValidationError"):
        schemas.pop(name, None)
    return document


def _state_presence(parameter: dict[str, Any]) -> None:
    """A parameter is there or it is not: null, which a body can hold, cannot be sent in a header or a query."""
    schema = parameter["schema"]
    kinds = [kind for kind in schema.get("anyOf", ()) if kind != {"type": "null"}]
    if len(kinds) == 1:
        del schema["anyOf"]
        schema.update(kinds[0])
    if schema.pop(_MARK, False):
        parameter["required"] = True


def _mark_problems(answers: dict[str, Any]) -> None:
    """Errors are problems, with their own media type; FastAPI's own form of 422 is never sent."""
    answers["default"] = answers.get("default", {"description": "any error"})
    for status, answer in answers.items():
        if status != "default" and status < "400":
            continue
        content = {"schema": {"$ref": _REFERENCE.format(model="Problem")}}
        answer["content"] = {MEDIA_TYPE: content}
