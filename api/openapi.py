"""OpenAPI 3.1 as it is served: what FastAPI derives, with errors as the problems that they are."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi

from api.problems import MEDIA_TYPE
from api.schemas import Parameters
from api.sending import CreateBody, Recorded

_BODIES = (Parameters, Recorded, CreateBody)
"""Bodies that routes read by themselves, so that FastAPI does not know them."""
_REFERENCE = "#/components/schemas/{model}"


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
            _mark_problems(operation["responses"])
    for name in ("HTTPValidationError", "ValidationError"):
        schemas.pop(name, None)
    return document


def _mark_problems(answers: dict[str, Any]) -> None:
    """Errors are problems, with their own media type; FastAPI's own form of 422 is never sent."""
    answers["default"] = answers.get("default", {"description": "any error"})
    for status, answer in answers.items():
        if status != "default" and status < "400":
            continue
        content = {"schema": {"$ref": _REFERENCE.format(model="Problem")}}
        answer["content"] = {MEDIA_TYPE: content}
