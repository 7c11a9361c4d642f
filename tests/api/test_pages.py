"""The pages that show the API work without the internet, and nobody may frame them."""

from __future__ import annotations

import re
from html.parser import HTMLParser

import pytest
from fastapi.testclient import TestClient

from tests.api.conftest import Backend

PAGES = ["/docs", "/redoc", "/"]


class References(HTMLParser):
    """Everything that a page loads, and what it runs in place."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[str] = []
        self.inline = ""
        self._in_script = False
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.found += [str(values[name]) for name in ("src", "href", "spec-url") if name in values]
        self._in_script = tag == "script"

    def handle_data(self, data: str) -> None:
        self.inline += data if self._in_script else ""


@pytest.mark.parametrize("path", PAGES)
def test_a_page_loads_from_this_server_alone(client: TestClient, path: str) -> None:
    page = client.get(path)
    assert page.headers["content-type"].startswith("text/html")
    references = References(page.text)
    assert len(references.found) >= 3
    assert references.inline.strip() == ""
    for reference in references.found:
        assert re.fullmatch(r"data:,|[a-z][a-z0-9./-]*", reference), "relative, so from here and behind any prefix"
        if reference != "data:,":
            answer = client.get(f"/{reference}")
            assert answer.status_code == 200
            assert len(answer.content) > 50


@pytest.mark.parametrize("path", PAGES)
def test_the_policy_lets_nothing_foreign_in(client: TestClient, path: str) -> None:
    text = client.get(path).headers["Content-Security-Policy"]
    policy = {name: sources for name, *sources in (part.split() for part in text.split(";"))}
    assert policy["default-src"] == ["'none'"]
    assert policy["frame-ancestors"] == ["'none'"]
    assert policy["script-src"] == ["'self'"]
    allowed = {"'none'", "'self'", "'unsafe-inline'", "data:", "blob:"}
    assert {source for sources in policy.values() for source in sources} <= allowed


def test_styles_load_nothing(client: TestClient) -> None:
    style = client.get("/assets/swagger-ui.css").text
    assert "@import" not in style
    assert set(re.findall(r"url\(\s*[\"']?([a-z]+:|[^d])", style)) <= {"data:"}
    assert client.get("/assets/favicon.png").status_code == 404


def test_the_pages_are_what_they_say(client: TestClient) -> None:
    assert "SwaggerUIBundle" in client.get("/assets/swagger-ui-bundle.js").text
    assert "SwaggerUIBundle(" in client.get("/assets/start.js").text
    assert "Redoc" in client.get("/assets/redoc.standalone.js").text
    assert client.get("/openapi.json").json()["openapi"].startswith("3.1")
    assert client.get("/docs/oauth2-redirect").status_code == 404


def test_every_page_has_a_policy(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one", {"gallery/index.html": b"<p>"})
    with backend.db.write() as session:
        session.connection().exec_driver_sql("UPDATE artifacts SET media_type = 'text/html'")
    answer = client.get(f"/v1/inspections/{one}/artifacts/gallery/index.html")
    assert answer.headers["content-type"].startswith("text/html")
    policy = answer.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "Content-Security-Policy" not in client.get("/v1/options").headers
