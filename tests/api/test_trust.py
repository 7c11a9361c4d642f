"""What is answered at all: a table of requests over real HTTP, each kind to many routes."""

from __future__ import annotations

import socket
from collections.abc import Callable
from urllib.parse import urlsplit

import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from sqlalchemy.exc import OperationalError

from api.app import create_app
from api.problems import MEDIA_TYPE
from store.keys import Keys
from tests.api.conftest import Backend, client_of

ID = "0" * 32
ROUTES = [
    ("GET", "/v1/inspections"),
    ("POST", "/v1/inspections"),
    ("GET", f"/v1/inspections/{ID}"),
    ("DELETE", f"/v1/inspections/{ID}"),
    ("POST", f"/v1/inspections/{ID}/cancel"),
    ("GET", f"/v1/inspections/{ID}/artifacts/quality.json"),
    ("HEAD", f"/v1/inspections/{ID}/artifacts/quality.json"),
    ("OPTIONS", "/v1/uploads"),
    ("POST", "/v1/uploads"),
    ("PATCH", f"/v1/uploads/{ID}"),
    ("GET", "/v1/options"),
    ("GET", "/readyz"),
    ("GET", "/metrics"),
    ("GET", "/docs"),
    ("GET", "/openapi.json"),
    ("GET", "/nowhere"),
]
PORT = "{port}"
"""Stands for the server's."""
REFUSED = [
    (421, {"Host": "evil.example"}),
    (421, {"Host": f"evil.example:{PORT}"}),
    (421, {"Host": "127.0.0.1.evil.example"}),
    (421, {"Host": "localhost.evil.example"}),
    (421, {"Host": "10.0.0.7"}),
    (421, {"Host": "[2001:db8::1]"}),
    (421, {"Host": "0.0.0.0"}),
    (421, {"Host": "localhost:x"}),
    (421, {"Host": "localhost@evil.example"}),
    (421, {"Host": ""}),
    (421, {"Host": "evil.example", "Origin": "http://evil.example"}),
    (403, {"Host": "127.0.0.1", "Sec-Fetch-Site": "cross-site"}),
    (403, {"Host": "127.0.0.1", "Sec-Fetch-Site": "same-site"}),
    (403, {"Host": "localhost", "Sec-Fetch-Site": "anything"}),
    (403, {"Host": "127.0.0.1", "Origin": "https://evil.example"}),
    (403, {"Host": "127.0.0.1", "Origin": "null"}),
    (403, {"Host": f"127.0.0.1:{PORT}", "Origin": "http://127.0.0.1:3000"}),
    (403, {"Host": f"127.0.0.1:{PORT}", "Origin": "http://127.0.0.1"}),
    (403, {"Host": f"127.0.0.1:{PORT}", "Origin": f"http://localhost:{PORT}"}),
    (403, {"Host": "localhost", "Origin": "http://localhost", "Sec-Fetch-Site": "cross-site"}),
]
SERVED = [
    {"Host": f"127.0.0.1:{PORT}"},
    {"Host": "localhost"},
    {"Host": "LocalHost:8000"},
    {"Host": "127.8.9.1:1"},
    {"Host": f"[::1]:{PORT}"},
    {"Host": "127.0.0.1", "Sec-Fetch-Site": "none", "Sec-Fetch-Mode": "navigate"},
    {"Host": f"127.0.0.1:{PORT}", "Sec-Fetch-Site": "same-origin", "Origin": f"http://127.0.0.1:{PORT}"},
    {"Host": "localhost", "Origin": "http://localhost:80"},
]


def ask(address: str, method: str, path: str, headers: dict[str, str]) -> tuple[int, str]:
    """Status and the rest of an answer, of a request that says exactly these headers."""
    target = urlsplit(address)
    lines = [f"{name}: {value}".replace(PORT, str(target.port)) for name, value in headers.items()]
    with socket.create_connection((target.hostname or "", target.port or 0), timeout=10) as connection:
        head = "\r\n".join([f"{method} {path} HTTP/1.0", *lines, "", ""])
        connection.sendall(head.encode())
        said = b"".join(iter(lambda: connection.recv(65536), b"")).decode()
    return int(said.split(" ", 2)[1]), said


def test_without_keys_only_this_machine_under_its_own_name(address: str) -> None:
    for method, path in ROUTES:
        for status, headers in REFUSED:
            found, said = ask(address, method, path, headers)
            assert found == status, (method, path, headers, said)
            assert MEDIA_TYPE in said
            assert ("untrusted_host" if status == 421 else "cross_site") in said or method == "HEAD"
        for headers in SERVED:
            assert ask(address, method, path, headers)[0] not in (403, 421), (method, path, headers)


def test_a_host_that_is_missing_or_given_twice_is_refused(address: str) -> None:
    assert ask(address, "GET", "/v1/inspections", {})[0] == 421
    twice = {"Host": "127.0.0.1", "host": "evil.example"}
    assert ask(address, "GET", "/v1/inspections", twice)[0] in (400, 421)


def test_whether_the_process_lives_is_said_to_anybody(address: str) -> None:
    assert ask(address, "GET", "/healthz", {"Host": "10.0.0.7", "Sec-Fetch-Site": "cross-site"})[0] == 200


def test_a_refused_request_changes_nothing(backend: Backend, address: str) -> None:
    one = backend.create("one")
    for headers in ({"Host": "evil.example"}, {"Host": "127.0.0.1", "Sec-Fetch-Site": "cross-site"}):
        assert ask(address, "DELETE", f"/v1/inspections/{one}", headers)[0] in (403, 421)
        assert ask(address, "POST", "/v1/uploads", {**headers, "Tus-Resumable": "1.0.0", "Upload-Length": "1"})[0] > 400
    assert ask(address, "GET", f"/v1/inspections/{one}", {"Host": "localhost"})[0] == 200
    assert list(backend.services.settings.folder("uploads").iterdir()) == []


@pytest.mark.parametrize(
    ("trusted", "host", "status"),
    [
        ("", "anything.example", 200),
        ("inspect.example, Other.Example", "inspect.example", 200),
        ("inspect.example, Other.Example", "other.example:8443", 200),
        ("inspect.example", "evil.example", 421),
        ("inspect.example", "", 421),
        ("inspect.example", "127.0.0.1", 200),
    ],
)
def test_with_keys_the_names_are_a_setting(
    backend: Backend, serve: Callable[[FastAPI], str], trusted: str, host: str, status: int
) -> None:
    _, key = Keys(backend.db).create("inspector")
    address = serve(create_app(backend.with_settings(trusted_hosts=trusted).services))
    headers = {"Host": host, "Authorization": f"Bearer {key}", "Sec-Fetch-Site": "cross-site"}
    assert ask(address, "GET", "/v1/inspections", headers)[0] == status


def test_while_the_database_is_away_nobody_else_is_let_in(backend: Backend, monkeypatch: pytest.MonkeyPatch) -> None:
    def away(*_: object) -> bool:
        raise OperationalError("SELECT", {}, Exception("away"))

    monkeypatch.setattr(Keys, "ever_made", away)
    client = TestClient(create_app(backend.services), "http://evil.example", client=("127.0.0.1", 1))
    answer = client.get("/v1/options")
    assert (answer.status_code, answer.json()["code"]) == (503, "database_unreachable")


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({"Host": "10.0.0.7:8000"}, 200),
        ({"Host": "inspections.example.com"}, 200),
        ({"Host": "rebound.example"}, 421),
        ({"Host": "10.0.0.7", "Sec-Fetch-Site": "cross-site"}, 403),
        ({"Host": "10.0.0.7", "Origin": "https://evil.example"}, 403),
        ({"Host": "10.0.0.7", "Authorization": "Bearer wrong"}, 401),
    ],
)
def test_no_auth_is_for_whoever_reaches_it_but_for_no_foreign_page(
    backend: Backend, headers: dict[str, str], status: int
) -> None:
    Keys(backend.db).revoke(Keys(backend.db).create("had one")[0].id)
    changed = backend.with_settings(no_auth=True, trusted_hosts="inspections.example.com")
    client = client_of(changed, "192.0.2.7")
    assert client.get("/v1/inspections", headers=headers).status_code == status
    assert client_of(backend, "192.0.2.7").get("/v1/inspections", headers=headers).status_code in (401, 403)


def test_without_auth_nobody_manages_keys_or_accounts(backend: Backend) -> None:
    client = client_of(backend.with_settings(no_auth=True))
    assert client.post("/v1/keys", json={"name": "mine"}).status_code == 403
    assert client.get("/v1/accounts").status_code == 403
    assert client.delete("/v1/accounts/default").status_code == 403
    assert client.post("/v1/uploads", headers={"Tus-Resumable": "1.0.0", "Upload-Length": "3"}).status_code == 201
