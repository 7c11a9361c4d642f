"""The document that clients are made from, and that the service keeps to it whatever it is asked."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
import schemathesis
from fastapi import FastAPI
from fastapi.testclient import TestClient
from hypothesis import HealthCheck, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.core.result import Ok
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from api.app import create_app
from api.problems import MEDIA_TYPE
from store.account_models import Scope
from store.keys import Keys
from tests.api.conftest import Backend
from tests.api.test_results import ROWS

_CHECKS = (not_a_server_error, content_type_conformance, response_schema_conformance, status_code_conformance)
schemathesis.serializer.alias("application/offset+octet-stream", "application/octet-stream")
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


@dataclass
class Asked:
    """An application, an inspection in it, and a key that may see it."""

    app: FastAPI
    inspection_id: str
    headers: dict[str, str]


@pytest.fixture
def asked(backend: Backend, unprobed: None) -> Asked:
    key = Keys(backend.db).create("generated requests", scopes=tuple(Scope))[1]
    files = {"quality.json": b'{"verdict": "ok", "flags": []}', "mapping/timeline.csv": b"event_id\r\n"}
    one = backend.finished("one", files, **ROWS)
    return Asked(create_app(backend.services), one, {"Authorization": f"Bearer {key}"})


def test_whatever_is_asked_the_answer_keeps_to_the_document(asked: Asked) -> None:
    """Generated requests to every route; half of them about an inspection that there is."""
    schema = schemathesis.openapi.from_asgi("/openapi.json", asked.app)
    found = list(schema.get_all_operations())
    operations = [one.ok() for one in found if isinstance(one, Ok)]
    assert len(operations) == len(found), "the document has no mistake"
    assert len(operations) > 30
    statuses: set[int] = set()
    for operation in operations:
        _ask(operation, asked, statuses)
    assert {200, 202, 204, 404, 412, 422} <= statuses, "what is generated is neither all right nor all wrong"


def _ask(operation: Any, asked: Asked, statuses: set[int]) -> None:
    @settings(max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), derandomize=True, database=None)
    @given(case=operation.as_strategy())
    def ask(case: schemathesis.Case[Any]) -> None:
        if len(str(case.path_parameters.get("inspection_id", "x"))) % 2 == 0:
            case.path_parameters["inspection_id"] = asked.inspection_id
        statuses.add(case.call_and_validate(checks=list(_CHECKS), headers=asked.headers).status_code)

    ask()
