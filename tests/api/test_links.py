"""Files and frames by signed link: what it opens, what it does not, and a picture of a foreign page."""

from __future__ import annotations

import io
import shutil
from collections.abc import Callable
from datetime import timedelta
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.responses import HTMLResponse
from fastapi.testclient import TestClient
from PIL import Image
from sqlalchemy import update

from api.app import create_app
from store.account_models import Account, Scope
from store.keys import Keys
from store.links import Links
from tests.api.conftest import Backend, client_of


def picture() -> bytes:
    out = io.BytesIO()
    Image.new("RGB", (31, 17), (200, 30, 30)).save(out, "JPEG")
    return out.getvalue()


@pytest.fixture
def one(backend: Backend) -> str:
    backend.key("mine")
    return backend.finished("one", {"gallery/dent.jpg": picture(), "other.json": b"{}"}, owner="mine")


@pytest.fixture
def client(backend: Backend, one: str) -> TestClient:
    return client_of(backend)


def link(client: TestClient, backend: Backend, one: str, path: str = "artifacts/gallery/dent.jpg", **more: Any) -> str:
    headers = backend.key("mine", Scope.READ)
    state: Any = client.app
    state.state.bladeatlas.keys.fresh_s = 0.0  # the key was made behind the server's back
    answer = client.post(f"/v1/inspections/{one}/links", json={"path": path, **more}, headers=headers)
    assert answer.status_code == 201, answer.text
    return str(answer.json()["url"])


def test_a_link_works_without_a_key_and_opens_nothing_else(client: TestClient, backend: Backend, one: str) -> None:
    url = link(client, backend, one)
    answer = client.get(url)
    assert (answer.status_code, answer.content) == (200, picture())
    assert client.head(url).status_code == 200
    assert client.get(url, headers={"Range": "bytes=0-9"}).status_code == 206
    query = url.split("?")[1]
    for path in ("artifacts/other.json", "artifacts", "archive.zip", "quality", "viewer/gallery/dent.jpg"):
        refused = client.get(f"/v1/inspections/{one}/{path}?{query}")
        assert refused.status_code in (401, 403), path
    assert client.get(f"/v1/inspections/{one}?{query}").status_code == 401
    assert client.post(f"/v1/inspections/{one}/cancel?{query}").status_code == 401
    changed = client.get(url[:-1] + ("0" if url[-1] != "0" else "1"))
    assert (changed.status_code, changed.json()["code"]) == (403, "bad_link")
    assert client.get(url.split("&")[0]).status_code == 403, "a time without a signature"
    assert client.get(url.replace("signature=", "signature=%C3%A9")).status_code in (403, 422)


def test_a_frame_by_link_is_found_to_be_missing_and_not_forbidden(
    client: TestClient, backend: Backend, one: str
) -> None:
    url = link(client, backend, one, "frames/3.jpg")
    assert client.get(f"{url}&boxes=true").status_code == 404
    assert client.get(url.replace("/3.jpg", "/4.jpg")).status_code == 403


@pytest.mark.parametrize("path", ["quality", "artifacts/", "../x", "frames/x.jpg", "archive.zip", "artifacts/\0"])
def test_only_files_and_frames_are_linked(client: TestClient, backend: Backend, one: str, path: str) -> None:
    headers = backend.key("mine", Scope.READ)
    state: Any = client.app
    state.state.bladeatlas.keys.fresh_s = 0.0
    answer = client.post(f"/v1/inspections/{one}/links", json={"path": path}, headers=headers)
    assert answer.status_code == 422


def test_links_end_when_their_account_says_so(client: TestClient, backend: Backend, one: str) -> None:
    url = link(client, backend, one)
    manager = backend.key("mine", Scope.MANAGE)
    assert client.delete("/v1/accounts/mine/links", headers=manager).status_code == 204
    assert client.get(url).status_code == 403
    assert client.get(link(client, backend, one)).status_code == 200
    with backend.db.write() as session:
        session.execute(update(Account).values(link_secret=None))
    assert client.get(url).status_code == 403


def test_a_link_outlives_the_key_that_made_it_and_not_its_time(client: TestClient, backend: Backend, one: str) -> None:
    url = link(client, backend, one, seconds=3600)
    for key in Keys(backend.db).all("mine"):
        Keys(backend.db).revoke(key.id)
    assert client.get(url).status_code == 200
    signed = Links(backend.db).sign("mine", one, "artifacts/gallery/dent.jpg", timedelta(seconds=-5))
    over = f"/v1/inspections/{one}/artifacts/gallery/dent.jpg?expires={signed.expires}&signature={signed.signature}"
    assert client.get(over).status_code == 403


@pytest.mark.browser
@pytest.mark.tool("chromium-headless-shell")
def test_a_foreign_page_shows_a_picture_and_calls_if_its_origin_may(
    backend: Backend, one: str, serve: Callable[[FastAPI], str], tmp_path: Path
) -> None:
    """The page is of another origin than the server (`localhost` and `127.0.0.1`), and has no key for the picture."""
    sync_api = pytest.importorskip("playwright.sync_api")
    front = FastAPI()
    pages = serve(front).replace("127.0.0.1", "localhost")
    key = backend.key("mine", Scope.READ)
    origins = {name: serve(create_app(backend.with_settings(cors_origins=value).services)) for name, value in
               (("open", pages), ("closed", "https://other.example.com"))}  # fmt: skip
    url = link(client_of(backend), backend, one)

    @front.get("/")
    def page() -> Any:
        return HTMLResponse("<!doctype html><title>front</title>")

    asked = """async ([address, key]) => {
        try {
            const answer = await fetch(address + "/v1/limits", {headers: key});
            return [answer.status, answer.headers.get("x-request-id") !== null];
        } catch (error) { return [error.name, false]; }
    }"""
    shown = """src => new Promise(done => {
        const picture = new Image();
        picture.onload = () => done([picture.naturalWidth, picture.naturalHeight]);
        picture.onerror = () => done("refused");
        picture.src = src;
    })"""
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium-headless-shell"), args=["--no-sandbox"]
        )
        try:
            tab = browser.new_page()
            tab.goto(pages)
            assert tab.evaluate(shown, origins["closed"] + url) == [31, 17]
            assert tab.evaluate(shown, origins["closed"] + url.split("?")[0]) == "refused"
            assert tab.evaluate(asked, [origins["open"], key]) == [200, True]
            assert tab.evaluate(asked, [origins["closed"], key]) == ["TypeError", False]
        finally:
            browser.close()
