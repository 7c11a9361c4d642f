"""Metadata and the other names of an inspection: given, found, changed, and refused when they are too large."""

from __future__ import annotations

import json
from typing import Any

import pytest
from fastapi.testclient import TestClient

from store.account_models import Scope
from store.accounts import Accounts
from tests.api.conftest import Backend, client_of

ENGINE = {"engine_type": "CFM56", "engine_serial": "V12345", "module": "HPT", "bore_hole": "S3"}


def send(client: TestClient, parameters: dict[str, Any], **headers: str) -> Any:
    files = {"video": b"v", "parameters": json.dumps(parameters).encode()}
    return client.post("/v1/inspections", files=files, headers=headers)


def ids(client: TestClient, query: str) -> list[str]:
    answer = client.get(f"/v1/inspections?{query}")
    assert answer.status_code == 200, answer.text
    return [one["id"] for one in answer.json()["inspections"]]


@pytest.mark.usefixtures("unprobed")
def test_metadata_is_shown_and_chooses(backend: Backend, client: TestClient) -> None:
    one = send(client, {"metadata": {**ENGINE, "inspector": ""}}).json()
    assert one["metadata"] == ENGINE, "an empty text is no entry"
    other = send(client, {"metadata": {"engine_serial": "V99", "module": "HPT"}}).json()["id"]
    assert ids(client, "metadata.engine_serial=V12345") == [one["id"]]
    assert ids(client, "metadata.module=HPT") == [other, one["id"]]
    assert ids(client, "metadata.module=HPT&metadata.bore_hole=S3") == [one["id"]], "free names too, and all of them"
    assert ids(client, "metadata.engine_serial=V1234") == []
    for query in ("metadata.Engine=1", "metadata.=1", "metadat=1", "metadata=1"):
        assert client.get(f"/v1/inspections?{query}").json()["code"] == "unknown_parameter", query
    assert client.get(f"/v1/inspections/{other}?metadata.module=HPT").status_code == 422, "not a filter of that route"
    assert client.get("/v1/inspections?metadata.x=%00").status_code == 422
    assert client.get(f"/v1/inspections?metadata.x={'y' * 257}").status_code == 422


@pytest.mark.usefixtures("unprobed")
def test_a_key_names_the_metadata_too(client: TestClient) -> None:
    first = send(client, {"metadata": ENGINE}, **{"Idempotency-Key": "k"})
    assert send(client, {"metadata": ENGINE}, **{"Idempotency-Key": "k"}).json()["id"] == first.json()["id"]
    assert send(client, {"metadata": {"module": "LPT"}}, **{"Idempotency-Key": "k"}).status_code == 422


@pytest.mark.usefixtures("unprobed")
@pytest.mark.parametrize(
    "metadata",
    [
        {"Engine": "1"},
        {"a\n": "1"},
        {"": "1"},
        {"a" * 65: "1"},
        {"a": "x" * 257},
        {"a": 1},
        {"a": None},
        {"a": {"b": "c"}},
        {f"n{i}": "1" for i in range(33)},
        ["a"],
    ],
)
def test_metadata_is_bounded(client: TestClient, metadata: Any) -> None:
    answer = send(client, {"metadata": metadata})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["pointer"].startswith("/parameters/metadata")


def test_names_change_one_by_one(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one")
    url = f"/v1/inspections/{one}"
    before = client.get(url)
    after = client.patch(url, json={"label": "row 3", "metadata": {"module": "HPT", "position": "B2"}})
    assert after.status_code == 200, after.text
    assert after.headers["ETag"] != before.headers["ETag"]
    body = client.patch(url, json={"external_id": "WO-1", "metadata": {"position": None, "stage": "2"}}).json()
    assert (body["label"], body["external_id"]) == ("row 3", "WO-1")
    assert body["metadata"] == {"module": "HPT", "stage": "2"}
    assert client.get(url).json()["metadata"] == body["metadata"]
    assert body["state"] == "succeeded"
    assert ids(client, "metadata.stage=2&label=row%203") == [one]
    assert ids(client, "metadata.position=B2") == []


def test_changes_are_refused_as_a_whole(backend: Backend, client: TestClient) -> None:
    one = backend.create("one", metadata={f"n{i}": "1" for i in range(30)})
    url = f"/v1/inspections/{one}"
    for body in ({"lable": "x"}, {"metadata": {"A": "x"}}, {"label": 3}, {"priority": 10}, {"label": "x\0"}):
        assert client.patch(url, json=body).status_code == 422, body
    many = client.patch(url, json={"label": "x", "metadata": {"more1": "1", "more2": "1", "more3": "1"}})
    assert (many.status_code, many.json()["code"]) == (422, "too_much_metadata")
    assert client.get(url).json()["label"] == ""
    swapped = {"n0": None, "more1": "1", "more2": "1", "more3": "1"}
    assert len(client.patch(url, json={"metadata": swapped}).json()["metadata"]) == 32


def test_a_change_is_for_the_account_with_its_priority(backend: Backend) -> None:
    one, client = backend.create("one", owner="shop"), client_of(backend)
    own, foreign, reader = backend.key("shop"), backend.key("other"), backend.key("shop", Scope.READ)
    url = f"/v1/inspections/{one}"
    assert client.patch(url, json={"label": "x"}, headers=foreign).status_code == 404
    assert client.patch(url, json={"label": "x"}, headers=reader).status_code == 403
    Accounts(backend.db).change("shop", max_priority=3)
    refused = client.patch(url, json={"priority": 9}, headers=own)
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/priority")
    assert client.patch(url, json={"priority": 3}, headers=own).json()["priority"] == 3


def test_a_retry_replaces_the_metadata_that_it_names(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one")
    client.patch(f"/v1/inspections/{one}", json={"metadata": {"module": "HPT", "stage": "2"}})
    again = client.post(f"/v1/inspections/{one}/retry", json={"parameters": {"metadata": {"module": "LPT"}}})
    assert again.json()["metadata"] == {"module": "LPT"}
