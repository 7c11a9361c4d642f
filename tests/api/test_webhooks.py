"""Webhooks over HTTP: made, rotated, tested and removed by who manages the account, and by nobody else."""

from __future__ import annotations

from ipaddress import ip_network
from typing import Any

import pytest
from fastapi.testclient import TestClient

from store.account_data import AccountData
from store.account_models import Scope
from store.deliveries import Deliveries, Outcome
from store.webhooks import Webhooks
from tests.api.conftest import Backend, client_of

PUBLIC = "https://192.0.0.9/hook"
"""A public address at which nobody is."""


@pytest.fixture
def manager(backend: Backend) -> dict[str, str]:
    return backend.key("shop", Scope.MANAGE, Scope.READ, Scope.SUBMIT)


def make(client: TestClient, manager: dict[str, str], **body: Any) -> dict[str, Any]:
    answer = client.post("/v1/webhooks", headers=manager, json={"url": PUBLIC, **body})
    assert answer.status_code == 201, answer.text
    assert answer.headers["Cache-Control"] == "no-store"
    made: dict[str, Any] = answer.json()
    return made


def test_a_secret_is_shown_once(backend: Backend, client: TestClient, manager: dict[str, str]) -> None:
    made = make(client, manager, description="planning", types=["inspection.failed"])
    secret = made.pop("secret")
    assert secret.startswith("whsec_")
    one = f"/v1/webhooks/{made['id']}"
    assert client.get(one, headers=manager).json() == made
    rotated = client.post(f"{one}/rotate", headers=manager)
    assert rotated.status_code == 201
    assert rotated.json()["secret"] != secret
    assert rotated.json()["old_secret_until"] is not None
    assert client.post(f"{one}/rotate", headers=manager, json={"keep_hours": 1}).status_code == 409
    assert client.post(f"{one}/rotate", headers=manager, json={"keep_hours": 0}).json()["old_secret_until"] is None
    listed = client.get("/v1/webhooks", headers=manager)
    assert [entry["id"] for entry in listed.json()["webhooks"]] == [made["id"]]
    exported = AccountData(backend.db, "shop").record()
    assert [entry["id"] for entry in exported["webhooks"]] == [made["id"]]
    assert "whsec_" not in listed.text + str(exported)
    assert client.delete(one, headers=manager).status_code == 204
    assert client.get(one, headers=manager).status_code == 404


def test_deliveries_are_listed_in_pages_and_sent_again(
    backend: Backend, client: TestClient, manager: dict[str, str]
) -> None:
    made = make(client, manager)
    one = f"/v1/webhooks/{made['id']}"
    tests = [client.post(f"{one}/test", headers=manager).json() for _ in range(3)]
    assert {entry["type"] for entry in tests} == {"webhook.test"}
    backend.finished("one", owner="shop")
    deliveries = Deliveries(Webhooks(backend.db))
    turn = deliveries.begin_turn()
    assert turn is not None
    while (message := deliveries.next(turn)) is not None:
        assert deliveries.note(turn, message, Outcome(200))
    seen: list[dict[str, Any]] = []
    path = f"{one}/deliveries?limit=4"
    while path:
        answer = client.get(path, headers=manager)
        seen += answer.json()["deliveries"]
        path = answer.links["next"]["url"] if "next" in answer.links else ""
    assert len({entry["id"] for entry in seen}) == len(seen) > 4
    assert {entry["state"] for entry in seen} == {"delivered"}
    assert {entry["number"] for entry in seen} - {None} == {
        event["number"] for event in client.get("/v1/events?after=0", headers=manager).json()["events"]
    }
    again = client.post(f"{one}/deliveries/{seen[0]['id']}/redeliver", headers=manager)
    assert (again.status_code, again.json()["state"], again.json()["attempts"]) == (202, "pending", 0)
    pending = client.get(f"{one}/deliveries", params={"state": "pending"}, headers=manager).json()
    assert [entry["id"] for entry in pending["deliveries"]] == [seen[0]["id"]]
    assert client.get(f"{one}/deliveries?cursor=x", headers=manager).status_code == 400
    assert client.post(f"{one}/deliveries/{'0' * 32}/redeliver", headers=manager).status_code == 404


def test_another_account_finds_nothing(backend: Backend, client: TestClient, manager: dict[str, str]) -> None:
    other = backend.key("other", Scope.MANAGE)
    one = f"/v1/webhooks/{make(client, manager)['id']}"
    delivery = client.post(f"{one}/test", headers=manager).json()["id"]
    assert client.get("/v1/webhooks", headers=other).json() == {"webhooks": []}
    for method, path in (
        *(("GET", one), ("DELETE", one), ("POST", f"{one}/rotate"), ("POST", f"{one}/test")),
        *(("GET", f"{one}/deliveries"), ("POST", f"{one}/deliveries/{delivery}/redeliver")),
    ):
        assert client.request(method, path, headers=other).status_code == 404, path
    others = make(client, other)["id"]
    mixed = f"/v1/webhooks/{others}/deliveries/{delivery}/redeliver"
    assert client.post(mixed, headers=other).status_code == 404
    AccountData(backend.db, "shop").delete(backend.services.plan)
    assert [view.id for view in Webhooks(backend.db).all()] == [others]


@pytest.mark.parametrize(
    ("url", "code"),
    [
        ("https://127.0.0.1/", "private_address"),
        ("https://localhost/", "private_address"),
        ("https://2130706433/", "private_address"),
        ("https://0x7f.1/", "private_address"),
        ("https://10.0.0.1/", "private_address"),
        ("https://169.254.169.254/latest/meta-data", "private_address"),
        ("https://100.64.0.1/", "private_address"),
        ("https://0.0.0.0/", "private_address"),
        ("https://224.0.0.1/", "private_address"),
        ("https://[::1]/", "private_address"),
        ("https://[::ffff:127.0.0.1]/", "private_address"),
        ("https://[64:ff9b::7f00:1]/", "private_address"),
        ("https://[2002:7f00:1::]/", "private_address"),
        ("https://[fd00::1]/", "private_address"),
        ("https://[fe80::1]/", "private_address"),
        ("http://192.0.0.9/", "insecure_url"),
        ("https://there.is.no.such.host.invalid/", "unknown_host"),
        ("ftp://192.0.0.9/", "bad_url"),
        ("https://user:word@192.0.0.9/", "bad_url"),
        ("https://192.0.0.9/#part", "bad_url"),
        ("https://192.0.0.9:99999/", "bad_url"),
        ("https://192.0.0.9\\@127.0.0.1/", "bad_url"),
        ("https://192.0.0.9/a b", "bad_url"),
        ("https:///path", "bad_url"),
        ("nothing", "bad_url"),
    ],
)
def test_addresses_that_are_refused(client: TestClient, manager: dict[str, str], url: str, code: str) -> None:
    answer = client.post("/v1/webhooks", headers=manager, json={"url": url})
    assert (answer.status_code, answer.json()["code"]) == (422, code)


def test_a_setting_allows_networks(backend: Backend, manager: dict[str, str]) -> None:
    settings = {"outbound_networks": "127.0.0.0/8, fd00::/8"}
    assert backend.with_settings(**settings).services.settings.allowed_networks() == (
        *(ip_network("127.0.0.0/8"), ip_network("fd00::/8")),
    )
    client = client_of(backend.with_settings(**settings, max_webhooks_per_owner=2))
    make(client, manager, url="http://127.0.0.5:8080/hook")
    make(client, manager, url="https://[fd00::1]/hook")
    answer = client.post("/v1/webhooks", headers=manager, json={"url": PUBLIC})
    assert (answer.status_code, answer.json()["code"]) == (429, "too_many_webhooks_of_owner")
    assert client.post("/v1/webhooks", headers=manager, json={"url": "https://10.0.0.1/"}).status_code == 422


def test_what_a_webhook_cannot_be(client: TestClient, manager: dict[str, str]) -> None:
    for body in ({}, {"url": PUBLIC, "types": ["inspection.lost"]}, {"url": PUBLIC, "secret": "mine"}):
        assert client.post("/v1/webhooks", headers=manager, json=body).status_code == 422, body
