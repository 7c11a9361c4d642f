"""Names that no route knows are refused on every route, with the name that was meant."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from api.problems import MEDIA_TYPE
from store.keys import Keys
from tests.api.conftest import TUS, Backend, client_of
from tests.api.test_submit import form

ID = "0" * 32
HIDDEN = [
    ("HEAD", "/v1/inspections/{inspection_id}/artifacts/{path}"),
    ("OPTIONS", "/v1/uploads/{upload_id}"),
    ("GET", "/docs"),
    ("GET", "/redoc"),
    ("GET", "/openapi.json"),
]


def routes(client: TestClient) -> list[tuple[str, str, list[str]]]:
    """Method, path and names of the query parameters of every route, those outside the document too."""
    found: list[tuple[str, str, list[str]]] = [(method, path, []) for method, path in HIDDEN]
    for path, methods in client.get("/openapi.json").json()["paths"].items():
        for method, operation in methods.items():
            names = [one["name"] for one in operation.get("parameters", ()) if one["in"] == "query"]
            found.append((method.upper(), path, names))
    return found


def fill(path: str) -> str:
    for name in ("inspection_id", "upload_id"):
        path = path.replace(f"{{{name}}}", ID)
    return path.replace("{index}", "1").replace("{name}", "draft").replace("{path}", "quality.json")


def test_unknown_query_parameters_are_refused_on_every_route(client: TestClient) -> None:
    tried = routes(client)
    assert len(tried) > 35
    for method, path, names in tried:
        answer = client.request(method, fill(path), params={"zzz": "1", **dict.fromkeys(names, "1")}, headers=TUS)
        assert answer.status_code == 422, (method, path)
        assert answer.headers["content-type"] == MEDIA_TYPE
        if method != "HEAD":
            body: dict[str, Any] = answer.json()
            assert body["code"] == "unknown_parameter", (method, path)
            assert [error["pointer"] for error in body["errors"]] == ["/query/zzz"]


def test_the_nearest_name_is_told(client: TestClient) -> None:
    told = 0
    for method, path, names in routes(client):
        for name in names:
            if name.startswith("metadata."):
                continue  # any name may stand behind it
            wrong = name[:-1] + name[-1] * 2
            answer = client.request(method, fill(path), params={wrong: "1"}, headers=TUS)
            assert f"unknown query parameter '{wrong}'; did you mean '{name}'?" in answer.json()["detail"]
            told += 1
    assert told > 30


@pytest.mark.parametrize("query", ["lable=dent", "min_confidance=0.999", "%00=1", "limit=5&limti=5", "a/b~c=1", "=1"])
def test_a_misspelt_filter_chooses_nothing(backend: Backend, client: TestClient, query: str) -> None:
    one = backend.finished("one")
    assert client.get(f"/v1/inspections/{one}/detections?{query}").json()["code"] == "unknown_parameter"


def test_who_may_not_ask_is_told_that_first(backend: Backend) -> None:
    Keys(backend.db).create("inspector")
    assert client_of(backend).get("/v1/inspections?lable=x").status_code == 401
    assert client_of(backend).get("/healthz?lable=x").status_code == 422


def test_unknown_parts_of_a_form_are_refused_with_the_nearest_name(client: TestClient) -> None:
    content = form(('Content-Disposition: form-data; name="annotation"', b"{}"))
    headers = {"Content-Type": "multipart/form-data; boundary=b"}
    answer = client.post("/v1/inspections", content=content, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (422, "bad_part")
    assert answer.json()["detail"] == "unknown part 'annotation'; did you mean 'annotations'?"
