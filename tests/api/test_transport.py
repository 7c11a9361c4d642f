"""HEAD of everything, gzip under tags of its own, and pages of other origins; over real HTTP."""

from __future__ import annotations

import gzip
import hashlib
import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from api.app import create_app
from core.errors import BadInput
from store.environment import deployment_settings
from tests.api.callers import ROUTES, Place
from tests.api.conftest import Backend, client_of
from tests.api.test_results import ROWS

MESH = b"ply\nformat binary_little_endian 1.0\n" + b"1.25 2.5 -3.75 " * 60_000 + os.urandom(1000)
GZIP = {"Accept-Encoding": "gzip"}
PLAIN = {"Accept-Encoding": "identity"}


@dataclass
class Served:
    http: httpx.Client
    one: str

    @property
    def mesh(self) -> str:
        return f"/v1/inspections/{self.one}/artifacts/mapping/mesh.ply"


@pytest.fixture
def served(backend: Backend, serve: Callable[[FastAPI], str]) -> Iterator[Served]:
    files = {"mapping/mesh.ply": MESH, "surface.glb": MESH, "picture.jpg": MESH, "quality.json": b'{"flags": []}'}
    one = backend.finished("one", files, **ROWS)
    with httpx.Client(base_url=serve(create_app(backend.services)), timeout=10) as http:
        yield Served(http, one)


def raw(http: httpx.Client, path: str, headers: dict[str, str]) -> tuple[httpx.Response, bytes]:
    with http.stream("GET", path, headers=headers) as answer:
        return answer, b"".join(answer.iter_raw())


def test_every_get_has_a_head(backend: Backend) -> None:
    place = Place(backend)
    for (method, template), scope in ROUTES.items():
        if method != "GET" or template in ("/metrics", "/v1/system"):  # they differ from one second to the next
            continue
        headers = place.key(*([scope] if scope else [])) | GZIP
        path = template.format(**place.names)
        got, head = (place.client.request(one, path, headers=headers) for one in ("GET", "HEAD"))
        assert (head.status_code, head.content) == (got.status_code, b""), path
        changing = ("x-request-id", "date", "content-length", "connection")
        told = [{name: value for name, value in one.headers.items() if name not in changing} for one in (got, head)]
        assert told[0] == told[1], path
    assert place.client.head("/healthz").status_code == 200
    assert place.client.head("/v1/inspections/x/cancel").status_code == 405


def test_the_head_of_a_stream_comes_at_once_and_ends(served: Served) -> None:
    began = time.monotonic()
    answer = served.http.head("/v1/events", headers={"Accept": "text/event-stream"})
    assert (answer.status_code, answer.headers["content-type"].split(";")[0]) == (200, "text/event-stream")
    archive = served.http.head(f"/v1/inspections/{served.one}/archive.zip")
    whole = served.http.get(f"/v1/inspections/{served.one}/archive.zip")
    assert int(archive.headers["content-length"]) == len(whole.content)
    assert time.monotonic() - began < 5.0


@pytest.mark.parametrize("name", ["mapping/mesh.ply", "surface.glb"])
def test_a_mesh_comes_gzipped_under_its_own_tag(served: Served, name: str) -> None:
    path = f"/v1/inspections/{served.one}/artifacts/{name}"
    plain, same = raw(served.http, path, PLAIN)
    packed, body = raw(served.http, path, GZIP)
    assert same == MESH
    assert (packed.headers["content-encoding"], gzip.decompress(body)) == ("gzip", MESH)
    assert len(body) < len(MESH) / 10
    strong, weak = plain.headers["etag"], packed.headers["etag"]
    assert strong == f'"{hashlib.sha256(MESH).hexdigest()}"'
    assert weak == f'W/{strong[:-1]}-gzip"'
    assert "accept-encoding" in plain.headers.get("vary", "accept-encoding").lower()
    assert "accept-encoding" in packed.headers["vary"].lower()
    assert "repr-digest" not in packed.headers, "that is the hash of other bytes"

    for known, headers in ((strong, PLAIN), (weak, GZIP), (f'"other", {weak}', GZIP), (strong, GZIP)):
        answer = served.http.get(path, headers={**headers, "If-None-Match": known})
        assert answer.status_code == 304, known
    assert served.http.get(path, headers={**GZIP, "If-None-Match": weak}).headers["etag"] == weak
    assert served.http.get(path, headers={**PLAIN, "If-None-Match": weak}).status_code == 200


def test_a_part_is_a_part_of_the_original(served: Served) -> None:
    tag = served.http.head(served.mesh, headers=PLAIN).headers["etag"]
    part, body = raw(served.http, served.mesh, {**GZIP, "Range": "bytes=100-199"})
    assert (part.status_code, body, part.headers["etag"]) == (206, MESH[100:200], tag)
    assert "content-encoding" not in part.headers
    weak = raw(served.http, served.mesh, GZIP)[0].headers["etag"]
    whole, body = raw(served.http, served.mesh, {**GZIP, "Range": "bytes=100-199", "If-Range": weak})
    assert (whole.status_code, body) == (200, MESH), "a part must not be put behind gzipped bytes"


def test_tables_and_json_come_gzipped_and_pictures_do_not(served: Served, backend: Backend) -> None:
    for path, packed in (
        ("/v1/options", True),
        ("/openapi.json", True),
        (f"/v1/inspections/{served.one}/artifacts/picture.jpg", False),
        ("/v1/limits?unknown=1", False),  # small
    ):
        answer, body = raw(served.http, path, GZIP)
        assert (answer.headers.get("content-encoding") == "gzip") == packed, path
        if packed:
            assert gzip.decompress(body) == raw(served.http, path, PLAIN)[1]
    many = {"detections": [{**ROWS["detections"][0], "id": number} for number in range(1200)]}
    backend.publish(served.one, **{**ROWS, **many})
    path = f"/v1/inspections/{served.one}/detections?format=csv"
    answer, body = raw(served.http, path, GZIP)
    assert answer.headers["content-encoding"] == "gzip"
    text = gzip.decompress(body)
    assert text == raw(served.http, path, PLAIN)[1]
    assert text.count(b"\r\n") == 1201
    assert served.http.get(path, headers={**GZIP, "If-None-Match": answer.headers["etag"]}).status_code == 304


ORIGIN = "https://front.example.com"


@pytest.fixture
def open_to_front(backend: Backend) -> tuple[TestClient, dict[str, str]]:
    changed = backend.with_settings(cors_origins=f"{ORIGIN}, http://127.0.0.1:5173")
    return client_of(changed), backend.key("mine")


def test_a_page_of_an_allowed_origin_may_call(open_to_front: tuple[TestClient, dict[str, str]]) -> None:
    client, key = open_to_front
    asked = {
        "Access-Control-Request-Method": "PATCH",
        "Access-Control-Request-Headers": "authorization, tus-resumable, upload-offset, content-type",
        "Sec-Fetch-Site": "cross-site",
    }
    preflight = client.options("/v1/uploads/x", headers={"Origin": ORIGIN, **asked})
    assert preflight.status_code == 200
    assert preflight.headers["access-control-allow-origin"] == ORIGIN
    assert "PATCH" in preflight.headers["access-control-allow-methods"]
    assert "access-control-allow-credentials" not in preflight.headers
    foreign = client.options("/v1/uploads/x", headers={"Origin": "https://other.example.com", **asked})
    assert foreign.status_code == 400
    assert "access-control-allow-origin" not in foreign.headers

    headers: dict[str, Any] = {"Origin": ORIGIN, "Sec-Fetch-Site": "cross-site", **key}
    answer = client.get("/v1/limits", headers=headers)
    assert (answer.status_code, answer.headers["access-control-allow-origin"]) == (200, ORIGIN)
    assert "etag" in answer.headers["access-control-expose-headers"].lower()
    refused = client.get("/v1/limits", headers={**headers, "Authorization": "Bearer wrong"})
    assert (refused.status_code, refused.headers["access-control-allow-origin"]) == (401, ORIGIN), "it may read why"
    other = client.get("/v1/limits", headers={**headers, "Origin": "https://other.example.com"})
    assert "access-control-allow-origin" not in other.headers


def test_without_keys_no_foreign_page_is_answered_whatever_is_set(backend: Backend) -> None:
    client = client_of(backend.with_settings(cors_origins=ORIGIN))
    assert client.get("/v1/limits", headers={"Origin": ORIGIN, "Sec-Fetch-Site": "cross-site"}).status_code == 403


@pytest.mark.parametrize("value", ["*", "front.example.com", "https://front.example.com/", "ftp://x", "https://a b"])
def test_what_is_no_origin_is_refused_at_the_start(monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    monkeypatch.setenv("BLADEATLAS_CORS_ORIGINS", value)
    with pytest.raises(BadInput, match="CORS_ORIGINS"):
        deployment_settings()
