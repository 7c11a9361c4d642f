"""Every route below /v1 under every kind of caller: one table of scopes, and one of kinds of keys and sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from datetime import timedelta
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from api.auth import COOKIE, WRITE_HEADER
from store.account_models import ApiKey, Scope
from store.accounts import Accounts
from store.audit import AuditFilter, AuditLog
from store.keys import Keys
from tests.api.conftest import TUS, Backend, client_of
from tests.api.test_results import ROWS

ANY = None
"""Any valid key will do."""
_ONE = "/v1/inspections/{inspection_id}"
ROUTES: dict[tuple[str, str], Scope | None] = {
    ("GET", "/metrics"): Scope.READ,
    ("GET", "/v1/system"): Scope.READ,
    ("GET", "/v1/options"): Scope.READ,
    ("GET", "/v1/schemas/annotations.json"): Scope.READ,
    ("GET", "/v1/presets"): Scope.READ,
    ("GET", "/v1/presets/{name}"): Scope.READ,
    ("GET", "/v1/limits"): Scope.READ,
    ("GET", "/v1/inspections"): Scope.READ,
    ("GET", _ONE): Scope.READ,
    ("GET", f"{_ONE}/stages"): Scope.READ,
    ("GET", f"{_ONE}/logs"): Scope.READ,
    ("GET", f"{_ONE}/cases"): Scope.READ,
    ("GET", f"{_ONE}/cases/{{name}}"): Scope.READ,
    ("GET", f"{_ONE}/metrics"): Scope.READ,
    ("GET", f"{_ONE}/quality"): Scope.READ,
    ("GET", f"{_ONE}/detections"): Scope.READ,
    ("GET", f"{_ONE}/timeline"): Scope.READ,
    ("GET", f"{_ONE}/defects"): Scope.READ,
    ("GET", f"{_ONE}/artifacts"): Scope.READ,
    ("GET", f"{_ONE}/artifacts/{{path}}"): Scope.READ,
    ("HEAD", f"{_ONE}/artifacts/{{path}}"): Scope.READ,
    ("GET", f"{_ONE}/archive.zip"): Scope.READ,
    ("GET", f"{_ONE}/frames/{{index}}.jpg"): Scope.READ,
    ("POST", "/v1/uploads"): Scope.SUBMIT,
    ("HEAD", "/v1/uploads/{upload_id}"): Scope.SUBMIT,
    ("PATCH", "/v1/uploads/{upload_id}"): Scope.SUBMIT,
    ("POST", "/v1/inspections"): Scope.SUBMIT,
    ("POST", f"{_ONE}/retry"): Scope.SUBMIT,
    ("POST", f"{_ONE}/cancel"): Scope.SUBMIT,
    ("GET", "/v1/session"): ANY,
    ("POST", "/v1/session"): ANY,
    ("GET", "/v1/keys"): Scope.MANAGE,
    ("POST", "/v1/keys"): Scope.MANAGE,
    ("POST", "/v1/keys/{key_id}/rotate"): Scope.MANAGE,
    ("GET", "/v1/accounts/{account_id}"): Scope.READ,
    ("GET", "/v1/accounts"): Scope.ADMIN,
    ("POST", "/v1/accounts"): Scope.ADMIN,
    ("PATCH", "/v1/accounts/{account_id}"): Scope.ADMIN,
    ("GET", "/v1/audit"): Scope.ADMIN,
    # What takes away what the others need comes last.
    ("DELETE", "/v1/uploads/{upload_id}"): Scope.SUBMIT,
    ("DELETE", _ONE): Scope.SUBMIT,
    ("DELETE", "/v1/keys/{key_id}"): Scope.MANAGE,
    ("DELETE", "/v1/session"): ANY,
    ("DELETE", "/v1/accounts/{account_id}"): Scope.MANAGE,
}
FREE = {("OPTIONS", "/v1/uploads")}
"""Says what the server can do, to whoever asks."""
HIDDEN = {("HEAD", f"{_ONE}/artifacts/{{path}}")}
"""Not in the description of the API."""
OF_AN_ACCOUNT = ("{inspection_id}", "{upload_id}", "{key_id}", "{account_id}")
BODIES: dict[tuple[str, str], dict[str, Any]] = {
    ("POST", "/v1/inspections"): {"json": {"video_upload": "0" * 32}},
    ("POST", "/v1/keys"): {"json": {"name": "another", "scopes": ["manage"]}},
    ("POST", "/v1/accounts"): {"json": {"id": "new"}},
    ("PATCH", "/v1/accounts/{account_id}"): {"json": {"name": "renamed"}},
    ("POST", "/v1/uploads"): {"headers": {"Upload-Length": "3"}},
    ("PATCH", "/v1/uploads/{upload_id}"): {
        "content": b"abc",
        "headers": {"Upload-Offset": "0", "Content-Type": "application/offset+octet-stream"},
    },
}
UPLOADS = "/v1/uploads"
Headers = dict[str, str]


@dataclass
class Place:
    """A server with one thing of every kind that belongs to the account `mine`."""

    backend: Backend
    client: TestClient = field(init=False)
    names: dict[str, str] = field(init=False)

    def __post_init__(self) -> None:
        self.client = client_of(self.backend)
        application: Any = self.client.app
        application.state.bladeatlas.keys.fresh_s = 0.0  # keys are made and ended behind the server's back
        self.key(Scope.READ)
        files = {"quality.json": b'{"flags": []}', "summary.json": b"{}"}
        spare = Keys(self.backend.db).create("spare", "mine", [Scope.MANAGE])[0].id
        self.names = {
            "inspection_id": self.backend.finished("one", files, owner="mine", **ROWS),
            "upload_id": self.backend.services.uploads.create("mine", 3, {}).id,
            "key_id": spare,
            "account_id": "mine",
            "name": "draft",
            "path": "quality.json",
            "index": "0",
        }

    def key(self, *scopes: Scope, account: str = "mine", **more: Any) -> Headers:
        return self.backend.key(account, *scopes, **more)

    def ask(self, route: tuple[str, str], headers: Headers) -> tuple[int, str]:
        """Status and code of the answer."""
        method, template = route
        more = BODIES.get(route, {})
        sent = {**(TUS if template.startswith(UPLOADS) else {}), **more.get("headers", {}), **headers}
        rest = {name: value for name, value in more.items() if name != "headers"}
        answer = self.client.request(method, template.format(**self.names), headers=sent, **rest)
        is_problem = answer.headers.get("content-type", "").startswith("application/problem")
        return answer.status_code, answer.json()["code"] if is_problem and answer.content else ""

    def everywhere(self, headers: Callable[[Scope | None], Headers]) -> dict[tuple[str, str], tuple[int, str]]:
        """What every route answers to headers that are chosen by the scope that it needs."""
        return {route: self.ask(route, headers(scope)) for route, scope in ROUTES.items()}

    def session(self, key: Headers) -> Headers:
        """Headers of a browser that showed this key; as the page that the server itself sent."""
        answer = self.client.post("/v1/session", headers=key)
        assert answer.status_code == 201, answer.text
        said = answer.headers["set-cookie"].lower()
        assert all(word in said for word in ("httponly", "samesite=strict", "path=/", "max-age=43200"))
        self.client.cookies.clear()
        return {"Cookie": f"{COOKIE}={answer.cookies[COOKIE]}", "Origin": "http://127.0.0.1"}


@pytest.fixture
def place(backend: Backend) -> Place:
    return Place(backend)


def keys_by_scope(place: Place, account: str = "mine") -> dict[Scope | None, Headers]:
    """One key for each scope that has nothing but that, and one for where any will do."""
    return {scope: place.key(scope or Scope.REVIEW, account=account) for scope in (*Scope, None)}


def test_the_table_has_every_route(place: Place) -> None:
    document = place.client.get("/openapi.json").json()
    described = {
        (method.upper(), path)
        for path, methods in document["paths"].items()
        for method in methods
        if path.startswith("/v1/") or path == "/metrics"
    }
    assert described - FREE == set(ROUTES) - HIDDEN


def test_the_right_key_opens_every_route(place: Place) -> None:
    keys = keys_by_scope(place)
    found = place.everywhere(keys.__getitem__)
    assert {route: one for route, one in found.items() if one[0] in (401, 403, 429, 500)} == {}
    done = [route for route, one in found.items() if one[0] < 300]
    assert len(done) > 35, "most find what they name"
    _require_audit(place, found)


def test_another_account_finds_nothing_of_it(place: Place) -> None:
    theirs = keys_by_scope(place, "theirs")
    found = place.everywhere(theirs.__getitem__)
    named = [
        route for route in ROUTES if any(name in route[1] for name in OF_AN_ACCOUNT) and ROUTES[route] != Scope.ADMIN
    ]
    assert {found[route][0] for route in named} == {404}
    listed = place.client.get("/v1/inspections", headers=theirs[Scope.READ]).json()
    assert listed["inspections"] == []
    keys = place.client.get("/v1/keys", headers=theirs[Scope.MANAGE]).json()["keys"]
    assert {key["account"] for key in keys} == {"theirs"}
    for ask in ({"params": {"account": "mine"}}, {"json": {"name": "x", "account": "mine"}}):
        method = "POST" if "json" in ask else "GET"
        assert place.client.request(method, "/v1/keys", headers=theirs[Scope.MANAGE], **ask).status_code == 404


def test_a_key_without_the_scope_may_not(place: Place) -> None:
    def lacking(scope: Scope | None) -> Headers:
        return place.key(*(one for one in Scope if one not in (scope, Scope.ADMIN)))

    found = place.everywhere(lacking)
    needing = {route: one for route, one in found.items() if ROUTES[route] is not ANY and route[0] != "HEAD"}
    assert set(needing.values()) == {(403, "missing_scope")}
    assert {one[0] for route, one in found.items() if route[0] == "HEAD"} == {403}
    _require_audit(place, found)


def _expired(place: Place, scope: Scope) -> Headers:
    key = place.key(scope)
    with place.backend.db.write() as session:
        past = place.backend.db.now(session) - timedelta(seconds=1)
        session.execute(update(ApiKey).where(ApiKey.id == _id(key)).values(expires_at=past))
    return key


def _revoked(place: Place, scope: Scope) -> Headers:
    key = place.key(scope)
    Keys(place.backend.db).revoke(_id(key))
    return key


def _rotated(place: Place, scope: Scope) -> Headers:
    key = place.key(scope)
    Keys(place.backend.db).rotate(_id(key))
    return key


def _last_revoked(place: Place, scope: Scope) -> Headers:
    """No key is left at all."""
    key = place.key(scope)
    for view in Keys(place.backend.db).all():
        Keys(place.backend.db).revoke(view.id)
    return key


def _none(place: Place, scope: Scope) -> Headers:
    return {}


def _session_of_a_revoked_key(place: Place, scope: Scope) -> Headers:
    key = place.key(scope)
    session = place.session(key)
    Keys(place.backend.db).revoke(_id(key))
    return session


def _ended_session(place: Place, scope: Scope) -> Headers:
    session = place.session(place.key(scope))
    assert place.client.delete("/v1/session", headers={**session, WRITE_HEADER: "1"}).status_code == 204
    return session


def _id(key: Headers) -> str:
    return key["Authorization"].split("_")[1]


@pytest.mark.parametrize(
    "make",
    [_none, _expired, _revoked, _rotated, _last_revoked, _session_of_a_revoked_key, _ended_session],
)
def test_who_has_no_valid_key_is_told_so_everywhere(place: Place, make: Callable[[Place, Scope], Headers]) -> None:
    before = _count(place)
    headers = make(place, Scope.READ)
    found = place.everywhere(lambda _: headers)
    assert {one[0] for one in found.values()} == {401}
    written = _count(place) - before
    writes = [route for route in ROUTES if route[0] not in ("GET", "HEAD")]
    assert written[""] == len(writes), "one entry for each kind of refused change"


def test_a_rotated_key_loses_nothing(place: Place) -> None:
    old = place.key(Scope.READ, Scope.SUBMIT)
    view, key = Keys(place.backend.db).rotate(_id(old))
    new = {"Authorization": f"Bearer {key}"}
    assert view.scopes == (Scope.READ, Scope.SUBMIT)
    one = f"/v1/inspections/{place.names['inspection_id']}"
    assert place.client.get(one, headers=new).status_code == 200
    Keys(place.backend.db).revoke(view.id)
    other = place.key(Scope.SUBMIT)
    assert place.client.delete(one, headers=other).status_code == 204, "what a revoked key made its account deletes"


def test_a_session_reads_and_writes_with_the_header(place: Place) -> None:
    keys = keys_by_scope(place)
    sessions = {scope: place.session(key) for scope, key in keys.items()}
    ends = {"DELETE"}
    bare = {route: place.ask(route, sessions[scope]) for route, scope in ROUTES.items() if route[0] != "DELETE"}
    for route, (status, code) in bare.items():
        if route[0] in ("GET", "HEAD"):
            assert status not in (401, 403), route
        else:
            assert (status, code) == (403, "missing_header"), route
    marked = {scope: {**session, WRITE_HEADER: "1"} for scope, session in sessions.items()}
    for route, scope in ROUTES.items():
        if route == ("POST", "/v1/session"):
            assert place.ask(route, marked[scope]) == (401, "unauthorized"), (
                "a session begins with a key, not a session"
            )
        elif route[0] not in ("GET", "HEAD") and (route[0] not in ends or "session" not in route[1]):
            assert place.ask(route, marked[scope])[0] not in (401, 403), route


FOREIGN = [
    {"Origin": "https://evil.example"},
    {"Origin": "http://127.0.0.1:3000"},
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site"},
]


@pytest.mark.parametrize("foreign", FOREIGN)
def test_a_page_of_another_origin_cannot_use_a_session(place: Place, foreign: Headers) -> None:
    session = place.session(place.key(*(scope for scope in Scope)))
    found = place.everywhere(lambda _: {**session, WRITE_HEADER: "1", **foreign})
    assert {one[0] for one in found.values()} == {403}
    assert {one[1] for route, one in found.items() if route[0] != "HEAD"} == {"cross_site"}


def test_no_key_makes_one_that_may_more(place: Place) -> None:
    manager = place.key(Scope.MANAGE, Scope.READ)
    for scopes, status in ((["read"], 201), (["read", "submit"], 403), (["admin"], 403)):
        answer = place.client.post("/v1/keys", headers=manager, json={"name": "x", "scopes": scopes})
        assert answer.status_code == status, scopes
    admin = _id(place.key(Scope.ADMIN))
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
        place.client.post("/v1/uploads?token=abc", headers={**writer, **TUS, "Upload-Length": "1"})
        place.client.post("/v1/uploads", headers={**writer, **TUS, "Upload-Length": "1"})
    seen = list(_pages(place.client, admin))
    assert len(seen) == 10
    assert [entry["id"] for entry in seen] == sorted((entry["id"] for entry in seen), reverse=True)
    assert Counter((entry["status"], entry["code"]) for entry in seen) == {(422, "unknown_parameter"): 5, (201, ""): 5}
    assert {(entry["account_id"], entry["key_id"], entry["action"]) for entry in seen} == {
        ("mine", _id(writer), "POST /v1/uploads")
    }
    assert not any("abc" in str(entry) or writer["Authorization"][50:] in str(entry) for entry in seen)
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


def _count(place: Place) -> Counter[str]:
    """Requests that the log stands for, by account."""
    found: Counter[str] = Counter()
    for entry in AuditLog(place.backend.db).page(AuditFilter(), 1000).entries:
        found[entry.account_id] += entry.times
    return found


def _require_audit(place: Place, found: dict[tuple[str, str], tuple[int, str]]) -> None:
    """Every accepted and refused change is in the log with its outcome, and nothing else."""
    entries = AuditLog(place.backend.db).page(AuditFilter("mine"), 1000).entries
    logged = Counter((entry.action, entry.status, entry.code) for entry in entries)
    asked = Counter(
        (f"{method} {path}", *outcome) for (method, path), outcome in found.items() if method not in ("GET", "HEAD")
    )
    assert logged == asked
