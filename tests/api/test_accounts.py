"""Every route below /v1 under every kind of caller: one table of scopes, and one of kinds of keys and sessions."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from datetime import timedelta

import pytest
from sqlalchemy import update

from api.auth import WRITE_HEADER
from store.account_models import ApiKey, Scope
from store.audit import AuditFilter, AuditLog
from store.keys import Keys
from tests.api.callers import ANY, FREE, HIDDEN, OF_AN_ACCOUNT, ROUTES, Headers, Place, key_id
from tests.api.conftest import Backend

pytestmark = pytest.mark.slow


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
        session.execute(update(ApiKey).where(ApiKey.id == key_id(key)).values(expires_at=past))
    return key


def _revoked(place: Place, scope: Scope) -> Headers:
    key = place.key(scope)
    Keys(place.backend.db).revoke(key_id(key))
    return key


def _rotated(place: Place, scope: Scope) -> Headers:
    key = place.key(scope)
    Keys(place.backend.db).rotate(key_id(key))
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
    Keys(place.backend.db).revoke(key_id(key))
    return session


def _ended_session(place: Place, scope: Scope) -> Headers:
    session = place.session(place.key(scope))
    assert place.client.delete("/v1/session", headers={**session, WRITE_HEADER: "1"}).status_code == 204
    return session


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
    view, key = Keys(place.backend.db).rotate(key_id(old))
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
