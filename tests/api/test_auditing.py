"""What of many requests comes into the audit log, and what happens when it cannot be written."""

from __future__ import annotations

import asyncio
from typing import Any

import pytest
from sqlalchemy.exc import OperationalError

from api.auditing import Auditor
from api.auth import Caller
from store.account_models import Scope
from store.audit import AuditFilter, AuditLog, AuditView
from tests.api.conftest import TUS, Backend, client_of


class Clock:
    """Time as the test says it is."""

    now = 0.0

    def __call__(self) -> float:
        return self.now


def request(code: str, who: str = "", path: str = "/v1/uploads", method: str = "POST") -> dict[str, Any]:
    """A request as the server knows it when it is about to answer."""
    state: dict[str, Any] = {"request_id": "r", "problem_code": code}
    if who:
        state["caller"] = Caller(who, "k", frozenset(Scope))
    return {"type": "http", "method": method, "path": path, "state": state}


def entries(log: AuditLog) -> list[AuditView]:
    """Oldest first."""
    return list(log.page(AuditFilter(), 100).entries)[::-1]


@pytest.mark.parametrize(
    ("who", "code", "status"),
    [("", "unauthorized", 401), ("me", "too_many_requests_of_owner", 429), ("me", "too_many_uploads", 429)],
)
def test_of_many_alike_the_next_entry_says_how_many(backend: Backend, who: str, code: str, status: int) -> None:
    log, clock = AuditLog(backend.db), Clock()
    auditor = Auditor(log, clock)
    for moment in (0, 1, 2, 59, 61, 62, 200):
        clock.now = moment
        asyncio.run(auditor.note(request(code, who, path=f"/v1/uploads/{moment}"), status))
    assert [(entry.target, entry.times) for entry in entries(log)] == [
        ("/v1/uploads/0", 1),
        ("/v1/uploads/61", 4),
        ("/v1/uploads/200", 2),
    ]
    asyncio.run(auditor.note(request("another", who), status))
    assert entries(log)[-1].code == "another", "another kind has its own first"


def test_what_somebody_known_asks_has_an_entry_each(backend: Backend) -> None:
    auditor = Auditor(AuditLog(backend.db), Clock())
    for _ in range(3):
        asyncio.run(auditor.note(request("not_found", "me"), 404))
    assert [(entry.account_id, entry.key_id, entry.times) for entry in entries(auditor.log)] == [("me", "k", 1)] * 3


@pytest.mark.parametrize(
    ("method", "path", "concerned"),
    [
        ("POST", "/v1/uploads", True),
        ("DELETE", "/v1/nowhere", True),
        ("GET", "/v1/uploads", False),
        ("BREW", "/v1/uploads", False),
        ("POST", "/metrics", False),
    ],
)
def test_only_changes_are_written_down(backend: Backend, method: str, path: str, concerned: bool) -> None:
    assert Auditor(AuditLog(backend.db)).concerns(request("", method=method, path=path)) == concerned


def test_an_answer_does_not_wait_for_a_log_that_cannot_be_written(
    backend: Backend, monkeypatch: pytest.MonkeyPatch
) -> None:
    def away(*_: object) -> None:
        raise OperationalError("INSERT", {}, Exception("away"))

    monkeypatch.setattr(AuditLog, "write", away)
    answer = client_of(backend).post("/v1/uploads", headers={**TUS, "Upload-Length": "1"})
    assert answer.status_code == 201


def test_an_internal_error_is_written_down(backend: Backend, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("broken")

    monkeypatch.setattr("store.uploads.Uploads.create", broken)
    answer = client_of(backend).post("/v1/uploads", headers={**TUS, "Upload-Length": "1"})
    assert answer.status_code == 500
    assert [(entry.account_id, entry.status) for entry in entries(AuditLog(backend.db))] == [("default", 500)]
