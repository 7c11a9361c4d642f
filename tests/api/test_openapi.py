"""The document that clients are made from, and that an answer which does not keep to it is found."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import pytest
import schemathesis
from fastapi import FastAPI
from fastapi.responses import JSONResponse
from fastapi.testclient import TestClient

from api.problems import MEDIA_TYPE
from bench.service.generated import PATIENCE_S, Asked, ask_all, calls_of

_METHODS = ("get", "post", "patch", "delete", "head", "options")


def operations(document: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            assert method in _METHODS
            yield path, method, operation


@pytest.fixture
def document(client: TestClient) -> dict[str, Any]:
    found: dict[str, Any] = client.get("/openapi.json").json()
    return found


def test_every_route_is_described(document: dict[str, Any]) -> None:
    assert document["openapi"].startswith("3.1")
    names = [operation["operationId"] for _, _, operation in operations(document)]
    assert len(names) == len(set(names))
    for path, method, operation in operations(document):
        assert operation["summary"], (path, method)
        default = operation["responses"]["default"]["content"]
        assert default == {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
        for status, answer in operation["responses"].items():
            if status.startswith(("4", "5")):
                assert set(answer["content"]) == {MEDIA_TYPE}, (path, status)
        if method != "options" and (path.startswith("/v1/") or path == "/metrics"):
            assert operation["security"] == [{"HTTPBearer": []}], path


def test_every_answer_has_an_example(document: dict[str, Any]) -> None:
    schemas = document["components"]["schemas"]
    for path, method, operation in operations(document):
        for status, answer in operation["responses"].items():
            schema = answer.get("content", {}).get("application/json", {}).get("schema")
            if schema is None or not status.startswith("2"):
                continue
            reference = schema.get("$ref") or schema.get("items", {}).get("$ref") or ""
            model = schemas[reference.rsplit("/", 1)[-1]]
            if "items" in model:
                model = schemas[model["items"]["$ref"].rsplit("/", 1)[-1]]
            has_example = "example" in model or all(
                "default" in p or "const" in p for p in model["properties"].values()
            )
            assert has_example, (path, method)


def test_references_resolve(document: dict[str, Any]) -> None:
    def walk(value: Any) -> Iterator[str]:
        if isinstance(value, dict):
            if isinstance(value.get("$ref"), str):
                yield value["$ref"]
            for inner in value.values():
                yield from walk(inner)
        elif isinstance(value, list):
            for inner in value:
                yield from walk(inner)

    for reference in set(walk(document)):
        assert reference.removeprefix("#/components/schemas/") in document["components"]["schemas"]


def always(status: int) -> Callable[[], JSONResponse]:
    def answer() -> JSONResponse:
        return JSONResponse(None, status)

    return answer


def test_what_the_document_does_not_say_is_found() -> None:
    app = FastAPI(responses={"default": {"description": "any error"}})
    for name, status in {"good": 200, "undescribed": 418, "broken": 503}.items():
        app.get(f"/{name}", responses={503: {"description": "away"}})(always(status))
    asked = Asked({}, "")
    ask_all(calls_of(schemathesis.openapi.from_asgi("/openapi.json", app, timeout=PATIENCE_S)), asked, 1, 0)
    assert asked.statuses == {200: 1, 418: 1, 503: 1}
    assert sorted(wrong.split(":")[0] for wrong in asked.wrong) == ["GET /broken", "GET /undescribed"]
