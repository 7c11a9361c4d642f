"""What is told of the row of blades begins an attempt that takes over everything else."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from tests.api.conftest import Backend


def over(backend: Backend, options: dict[str, Any]) -> str:
    """An inspection that ended, and was asked for these options."""
    one = backend.create("one", options=options, parameters={"preset": "default", "options": options})
    backend.work(one)
    backend.publish(one)
    return one


def told(client: TestClient, one: str, body: dict[str, Any]) -> Any:
    return client.patch(f"/v1/inspections/{one}/row", json=body)


def test_what_is_told_is_an_option_of_the_next_attempt(backend: Backend, client: TestClient) -> None:
    one = over(backend, {"timeline.radius_fraction": 0.05})
    answer = told(client, one, {"count": 64, "edge_a": "leading", "scale": {"points": [1, 2, 3, 4], "length_mm": 5.0}})
    assert answer.status_code == 202, answer.text
    body = answer.json()
    assert (body["state"], body["attempt"]) == ("running", 2)
    scale = {"scale.points": [1, 2, 3, 4], "scale.length_mm": 5}
    kept = {"timeline.radius_fraction": 0.05, "row.count": 64, "row.edge_a": "leading", **scale}
    assert body["parameters"]["options"] == kept
    settings = backend.services.inspections.get(one).settings
    assert (settings["row"]["count"], settings["scale"]["length_mm"]) == (64, 5.0)
    assert told(client, one, {"count": 60}).status_code == 409, "it is active"


def test_null_takes_back_and_what_is_not_named_stays(backend: Backend, client: TestClient) -> None:
    one = over(backend, {"row.count": 64, "row.edge_a": "leading"})
    answer = told(client, one, {"edge_a": None, "direction": "reversed"})
    assert answer.json()["parameters"]["options"] == {"row.count": 64, "row.direction": "reversed"}


def test_limits_of_the_shop_are_told_alike(backend: Backend, client: TestClient) -> None:
    one = over(backend, {"row.count": 64})
    answer = told(client, one, {"limits": "length_mm\n2\n"})
    assert answer.status_code == 202, answer.text
    assert answer.json()["parameters"]["options"] == {"row.count": 64, "limits.table": "length_mm\n2\n"}


@pytest.mark.parametrize(
    "body",
    [
        {},
        {"limits": "length_mm\nmany\n"},
        {"count": 3},
        {"blades": 64},
        {"zero_blade": 2},
        {"edge_a": "upper"},
        {"radius_mm": -1.0},
        {"scale": {"length_mm": 3.0}},
    ],
)
def test_what_a_row_cannot_be_told_changes_nothing(backend: Backend, client: TestClient, body: dict[str, Any]) -> None:
    one = backend.finished("one")
    assert told(client, one, body).status_code == 422
    assert client.get(f"/v1/inspections/{one}").json()["attempt"] == 1
