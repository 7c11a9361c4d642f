"""Behind a proxy that takes a prefix off: whatever the service tells leads back to it, over real HTTP."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urljoin

import httpx
import pytest
from fastapi import FastAPI
from sqlalchemy import select

from api.app import create_app
from api.auth import COOKIE, WRITE_HEADER
from cli.client.client import Client
from cli.client.transfers import Transfers
from store.account_models import AuditEntry, Scope
from tests.api.conftest import TUS, Backend
from tests.api.test_pages import PAGES, References
from tests.api.test_results import ROWS

PREFIX = "/turbines/blades"
_ADDRESS = re.compile(r"\"(/[^\"\s]*)\"|<(/[^>]*)>")
"""What a body or a header names by its path."""


class Proxy(httpx.HTTPTransport):
    """Takes the prefix off, and serves nothing that is not below it."""

    def handle_request(self, request: httpx.Request) -> httpx.Response:
        path = request.url.raw_path
        assert path.startswith(PREFIX.encode() + b"/"), f"{path!r} leads past the service"
        request.url = request.url.copy_with(raw_path=path[len(PREFIX) :])
        return super().handle_request(request)


@pytest.fixture
def place(backend: Backend, unprobed: None) -> Backend:
    return backend.with_settings(root_path=PREFIX)


@pytest.fixture
def bare(place: Backend, serve: Callable[[FastAPI], str]) -> str:
    """The server as the proxy sees it."""
    return serve(create_app(place.services))


@pytest.fixture
def client(bare: str) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=bare, transport=Proxy(), timeout=30) as made:
        yield made


def named(answer: httpx.Response) -> list[str]:
    """Every path of the API that an answer names."""
    texts = [answer.text, answer.headers.get("link", ""), f'"{answer.headers.get("location", "/")}"']
    found = [one or other for text in texts for one, other in _ADDRESS.findall(text)]
    return [path for path in found if "/v1/" in path]


def test_every_address_that_is_told_is_below_the_prefix(place: Backend, client: httpx.Client) -> None:
    one = place.finished("one", {"quality.json": b'{"flags": []}', "a/file name.csv": b"x\r\n"}, **ROWS)
    place.finished("two")
    own = f"{PREFIX}/v1/inspections/{one}"
    client.post(f"{PREFIX}/v1/uploads", headers={**TUS, "Upload-Length": "3"})
    asked = (f"{PREFIX}/v1/inspections?limit=1", own, f"{own}/artifacts", f"{own}/detections?limit=1")
    told = [path for asked_for in (*asked, f"{PREFIX}/v1/uploads") for path in named(client.get(asked_for))]
    assert len(told) > 20
    assert {path for path in told if not path.startswith(f"{PREFIX}/v1/")} == set()
    for path in told:
        if path.endswith("/report.pdf"):
            continue  # a route of the same form as others, and seconds to make
        answer = client.get(path, headers=TUS)
        assert answer.is_success or answer.json()["detail"] != "Not Found", f"{path} leads to no route"
    assert client.get(f"{PREFIX}/v1/nothing").json()["instance"] == f"{PREFIX}/v1/nothing"


def test_a_client_sends_looks_and_fetches(
    place: Backend, bare: str, client: httpx.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    video = tmp_path / "video.mp4"
    video.write_bytes(b"pictures" * 1000)
    with Client(f"{bare}{PREFIX}", transfers=Transfers(tmp_path / "cache")) as own:
        own._http._transport = Proxy()
        made = own.submit(video, parameters={"label": "behind"})
        place.work(made.id)
        place.publish(made.id, {"quality.json": b"{}"}, **ROWS)
        assert own.wait(made.id).state == "succeeded"
        (artifact,) = own.artifacts(made.id)
        assert own.download(made.id, artifact, tmp_path / "out").read_bytes() == b"{}"
        assert [each.id for each in own.list(label="behind")] == [made.id]


def test_sessions_and_signed_links(place: Backend, bare: str, client: httpx.Client) -> None:
    one = place.finished("one", {"gallery/dent.jpg": b"picture"}, owner="mine")
    key = place.key("mine", Scope.READ, Scope.SUBMIT)
    said = client.post(f"{PREFIX}/v1/session", headers=key).headers["Set-Cookie"]
    assert f"path={PREFIX};" in said.lower(), "what else this name serves does not get it"
    assert client.get(f"{PREFIX}/v1/session").status_code == 200, "the browser sends it back"
    write = {WRITE_HEADER: "1"}
    link = client.post(
        f"{PREFIX}/v1/inspections/{one}/links", json={"path": "artifacts/gallery/dent.jpg"}, headers=write
    ).json()["url"]
    with httpx.Client(base_url=bare, transport=Proxy()) as stranger:
        assert stranger.get(link).content == b"picture"
        assert stranger.get(link.replace("signature=", "signature=0")[:-1]).status_code == 403
    assert client.delete(f"{PREFIX}/v1/session", headers=write).status_code == 204
    assert COOKIE not in client.cookies, "it is taken back under the path that it was given for"
    with place.db.read() as session:
        rows = session.scalars(select(AuditEntry)).all()
    assert {(row.target, row.status) for row in rows} >= {("/v1/session", 201), (f"/v1/inspections/{one}/links", 201)}


def test_pages_and_the_description_are_of_the_prefix(client: httpx.Client) -> None:
    for page in PAGES:
        address = f"{PREFIX}{page}"
        found = References(client.get(address).text).found
        assert len(found) >= 3
        for reference in found:
            if reference != "data:,":
                assert client.get(urljoin(address, reference)).status_code == 200
    document: dict[str, Any] = json.loads(client.get(f"{PREFIX}/openapi.json").content)
    assert document["servers"] == [{"url": PREFIX}]
    assert "/v1/limits" in document["paths"]


def test_health_is_asked_without_the_prefix(bare: str) -> None:
    """By what watches the process itself, past the proxy, under any name."""
    assert httpx.get(f"{bare}/healthz", headers={"Host": "10.1.2.3"}).status_code == 200
    assert httpx.get(f"{bare}/v1/limits", headers={"Host": "10.1.2.3"}).status_code == 421
