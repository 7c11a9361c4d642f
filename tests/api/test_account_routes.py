"""What keys, accounts and the audit log answer with."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi.testclient import TestClient

from store.account_models import Scope
from store.accounts import Accounts
from store.models import Inspection
from tests.api.callers import Headers, Place, key_id
from tests.api.conftest import TUS, Backend


@pytest.fixture
def place(backend: Backend) -> Place:
    return Place(backend)


def test_no_key_makes_one_that_may_more(place: Place) -> None:
    manager = place.key(Scope.MANAGE, Scope.READ)
    for scopes, status in ((["read"], 201), (["read", "submit"], 403), (["admin"], 403)):
        answer = place.client.post("/v1/keys", headers=manager, json={"name": "x", "scopes": scopes})
        assert answer.status_code == status, scopes
    admin = key_id(place.key(Scope.ADMIN))
    assert place.client.post(f"/v1/keys/{admin}/rotate", headers=manager).status_code == 403
    made = place.client.post("/v1/keys", headers=manager, json={"name": "x", "scopes": ["read"]}).json()
    bearer = {"Authorization": f"Bearer {made['key']}"}
    assert place.client.get("/v1/session", headers=bearer).json()["account"] == "mine"
    listed = place.client.get("/v1/keys", headers=manager).text
    assert made["key"] not in listed
    assert made["key"].rsplit("_", 1)[1] not in listed


def test_an_administrator_makes_accounts_and_their_keys(place: Place) -> None:
    admin = place.key(Scope.ADMIN, account="default")
    limits = {"id": "shop", "max_active": 2, "max_priority": 4, "retention_days": 7}
    assert place.client.post("/v1/accounts", headers=admin, json=limits).status_code == 201
    assert place.client.post("/v1/accounts", headers=admin, json=limits).status_code == 409
    wanted = {"name": "station", "account": "shop", "scopes": ["read", "submit"]}
    made = place.client.post("/v1/keys", headers=admin, json=wanted)
    shop = {"Authorization": f"Bearer {made.json()['key']}"}
    told = place.client.get("/v1/limits", headers=shop).json()
    assert (told["max_active_per_owner"], told["retention_days"]) == (2, 7)
    place.client.patch("/v1/accounts/shop", headers=admin, json={"max_active": None, "name": "The shop"})
    account = place.client.get("/v1/accounts/shop", headers=shop).json()
    assert (account["name"], account["max_active"], account["max_priority"]) == ("The shop", None, 4)
    upload = place.backend.services.uploads.create("shop", 0, {})
    body = {"video_upload": upload.id, "parameters": {"priority": 5}}
    refused = place.client.post("/v1/inspections", headers=shop, json=body)
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/parameters/priority")


def test_an_account_is_deleted_with_all_that_it_has(place: Place) -> None:
    manager, reader = place.key(Scope.MANAGE), place.key(Scope.READ, account="default")
    kept = place.backend.finished("kept")
    running = place.backend.create("running", owner="mine", label="secret")
    assert place.client.delete("/v1/accounts/mine", headers=manager).status_code == 204
    assert place.client.get("/v1/session", headers=manager).status_code == 401
    assert place.client.get(f"/v1/inspections/{kept}", headers=reader).status_code == 200
    view = Accounts(place.backend.db).get("mine")
    assert view.closed_at is not None
    inspection = place.backend.services.inspections.get(running)
    assert (inspection.state, inspection.label) == ("cancelled", "")
    upload = place.backend.services.uploads.find(place.names["upload_id"], "mine")
    assert upload is not None
    assert upload.removed
    admin = place.key(Scope.ADMIN, account="default")
    again = place.client.post("/v1/keys", headers=admin, json={"name": "x", "account": "mine"})
    assert again.status_code == 409


@pytest.mark.usefixtures("unprobed")
def test_the_files_that_came_are_kept_bytes_of_the_account(place: Place) -> None:
    Accounts(place.backend.db).change("mine", max_kept_bytes=3000)
    key, video = place.key(Scope.SUBMIT), {"video": ("v.mp4", bytes(2000))}
    made = place.client.post("/v1/inspections", headers=key, files=video)
    assert made.status_code == 202, made.text
    refused = place.client.post("/v1/inspections", headers=key, files=video)
    problem = refused.json()
    assert (refused.status_code, problem["code"]) == (429, "too_many_kept_bytes_of_owner")
    assert problem["where"] == "max_kept_bytes_per_owner"
    assert refused.headers["Retry-After"]
    with place.backend.db.read() as session:
        row = session.get_one(Inspection, made.json()["id"])
    assert (row.owner, row.input_bytes, row.reuse_account) == ("mine", 2000, "mine")
    other = place.client.post("/v1/inspections", headers=place.key(Scope.SUBMIT, account="default"), files=video)
    with place.backend.db.read() as session:
        assert session.get_one(Inspection, other.json()["id"]).reuse_account == "", "default shares"


def test_requests_beyond_the_rate_are_told_when_to_come_back(place: Place) -> None:
    key = place.key(Scope.READ)
    Accounts(place.backend.db).change("mine", max_requests_per_minute=3)
    found = [place.client.get("/v1/system", headers=key) for _ in range(8)]
    refused = [answer for answer in found if answer.status_code == 429]
    assert 2 <= len(refused) <= 5, "a minute may begin in between"
    problem = refused[0].json()
    assert (problem["code"], problem["where"]) == ("too_many_requests_of_owner", "max_requests_per_minute_per_owner")
    assert 1 <= int(refused[0].headers["Retry-After"]) <= 61


def test_the_log_has_pages_and_no_secrets(place: Place) -> None:
    admin, writer = place.key(Scope.ADMIN, account="default"), place.key(Scope.SUBMIT)
    for _ in range(5):
        place.client.post("/v1/uploads?token=zyx", headers={**writer, **TUS, "Upload-Length": "1"})
        place.client.post("/v1/uploads", headers={**writer, **TUS, "Upload-Length": "1"})
    seen = list(_pages(place.client, admin))
    assert len(seen) == 10
    assert [entry["id"] for entry in seen] == sorted((entry["id"] for entry in seen), reverse=True)
    assert Counter((entry["status"], entry["code"]) for entry in seen) == {(422, "unknown_parameter"): 5, (201, ""): 5}
    assert {(entry["account_id"], entry["key_id"], entry["action"]) for entry in seen} == {
        ("mine", key_id(writer), "POST /v1/uploads")
    }
    assert not any("zyx" in str(entry) or writer["Authorization"][50:] in str(entry) for entry in seen)
    text = place.client.get("/v1/audit?format=csv&limit=2&account=mine", headers=admin).text.splitlines()
    assert len(text) == 3
    assert text[0].startswith("id,at,account_id,key_id,action,target,status,code")
    assert place.client.get("/v1/audit?cursor=x", headers=admin).status_code == 400


def _pages(client: TestClient, headers: Headers) -> Iterator[dict[str, Any]]:
    url = "/v1/audit?limit=3"
    while url:
        answer = client.get(url, headers=headers)
        yield from answer.json()["entries"]
        url = answer.links.get("next", {}).get("url", "")
