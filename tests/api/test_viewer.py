"""The page of an inspection as the service sends it."""

from __future__ import annotations

import gzip
import hashlib
import io
import zipfile
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from api.negotiation import accepts_gzip
from core.outputs import is_of_page
from core.viewer.policy import POLICY
from store.publishing import compressed_key, media_type, uncompressed_key
from tests.api.conftest import Backend

SCRIPT = b"window.BLADEATLAS = {};\n" * 50
FILES = {
    "viewer/index.html": b"<!doctype html>",
    "viewer/data.js": SCRIPT,
    "viewer/frames/0000.jpg": b"picture",
    "models/1/viewer/index.html": b"<!doctype html><p>1",
    "summary.json": b"{}",
}


@pytest.fixture
def page(backend: Backend, tmp_path: Path) -> str:
    """Path of the inspection; `data.js` lies gzipped beside itself, as publishing leaves it."""
    one = backend.finished("one", dict(FILES))
    packed = tmp_path / "packed"
    packed.write_bytes(gzip.compress(SCRIPT, mtime=0))
    key = compressed_key(f"published/{one}/viewer/data.js")
    assert key is not None
    backend.services.artifacts.put(key, packed)
    return f"/v1/inspections/{one}"


def test_the_resource_leads_to_the_page(client: TestClient, page: str) -> None:
    link = client.get(page).json()["links"]["viewer"]
    assert link == f"{page}/viewer/index.html"
    answer = client.get(link)
    assert answer.content == FILES["viewer/index.html"]
    assert answer.headers["content-security-policy"] == POLICY
    assert "frame-ancestors 'none'" in POLICY
    assert answer.headers["cross-origin-resource-policy"] == "same-origin"
    assert client.get(f"{page}/models/1/viewer/index.html").content == FILES["models/1/viewer/index.html"]
    assert client.get(f"{page}/viewer/frames/0000.jpg").content == b"picture"


def test_large_files_come_compressed_to_who_takes_that(client: TestClient, page: str) -> None:
    plain = client.get(f"{page}/viewer/data.js", headers={"Accept-Encoding": "identity"})
    packed = client.get(f"{page}/viewer/data.js", headers={"Accept-Encoding": "br, gzip"})
    assert plain.content == packed.content == SCRIPT
    assert "content-encoding" not in plain.headers
    assert packed.headers["content-encoding"] == "gzip"
    assert int(packed.headers["content-length"]) < int(plain.headers["content-length"]) == len(SCRIPT)
    assert plain.headers["vary"] == packed.headers["vary"] == "Accept-Encoding"
    assert plain.headers["etag"] == f'"{hashlib.sha256(SCRIPT).hexdigest()}"' != packed.headers["etag"]
    # A file without a compressed form comes as it is.
    assert "content-encoding" not in client.get(f"{page}/viewer/index.html").headers


@pytest.mark.parametrize("encoding", ["identity", "gzip"])
def test_what_is_at_hand_is_not_sent_again(client: TestClient, page: str, encoding: str) -> None:
    headers = {"Accept-Encoding": encoding}
    path = f"{page}/viewer/data.js"
    etag = client.get(path, headers=headers).headers["etag"]
    again = client.get(path, headers={**headers, "If-None-Match": etag})
    assert (again.status_code, again.content, again.headers["etag"]) == (304, b"", etag)
    other = {"identity": "gzip", "gzip": "identity"}[encoding]
    assert client.get(path, headers={"Accept-Encoding": other, "If-None-Match": etag}).status_code == 200
    head = client.head(path, headers=headers)
    assert (head.status_code, head.content, head.headers["etag"]) == (200, b"", etag)


@pytest.mark.parametrize(
    "path",
    [
        "viewer/none.js",
        "viewer/../summary.json",
        "viewer/%2e%2e/summary.json",
        "viewer/",
        "models/2/viewer/index.html",
        "viewer/a%00b",
        "viewer/data.js.gz",
    ],
)
def test_no_other_file_is_sent(client: TestClient, page: str, path: str) -> None:
    assert client.get(f"{page}/{path}").status_code == 404


def test_a_page_is_its_owners(backend: Backend, client: TestClient) -> None:
    foreign = backend.finished("foreign", dict(FILES), owner="somebody")
    assert client.get(f"/v1/inspections/{foreign}/viewer/index.html").status_code == 404


def test_a_page_that_may_still_come(backend: Backend, client: TestClient) -> None:
    one = backend.create("waiting")
    answer = client.get(f"/v1/inspections/{one}/viewer/index.html")
    assert (answer.status_code, answer.json()["code"]) == (409, "not_ready")


def test_the_page_is_handed_over_as_an_archive(client: TestClient, page: str) -> None:
    data = client.get(f"{page}/archive.zip", params={"include": "viewer/*"}).content
    assert set(zipfile.ZipFile(io.BytesIO(data)).namelist()) == {name for name in FILES if name.startswith("viewer/")}


@pytest.mark.parametrize(
    ("header", "taken"),
    [
        ("gzip", True),
        ("deflate, GZIP;q=0.5", True),
        ("gzip;q=0", False),
        ("gzip; q=0.000", False),
        ("br", False),
        ("", False),
        (None, False),
        ("*", False),
    ],
)
def test_who_takes_gzip(header: str | None, taken: bool) -> None:
    assert accepts_gzip(header) == taken


def test_names_of_pages() -> None:
    assert is_of_page("viewer/data.js")
    assert is_of_page("models/1/viewer/frames/0000.jpg")
    assert not is_of_page("mapping/viewer/a.js")
    assert not is_of_page("models/1/mapping/defects.json")
    assert compressed_key("a/viewer/frames/0000.jpg") is None
    assert uncompressed_key(str(compressed_key("a/viewer/data.js"))) == "a/viewer/data.js"
    assert media_type("viewer/app.js") == "text/javascript; charset=utf-8"
    assert media_type("viewer/style.css") == "text/css; charset=utf-8"
