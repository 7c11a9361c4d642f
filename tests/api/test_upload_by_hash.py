"""Uploads of files that the account sent before: found by their hash over real connections, without a byte sent."""

from __future__ import annotations

import base64
import hashlib
import os
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import text

from store.housekeeping import Retention
from store.inspections import mark_deleted
from store.models import Upload
from store.uploads import Digests
from tests.api.conftest import ANNOTATIONS, TUS, VIDEO, Backend, client_of
from tests.api.test_uploads import begin, patch, stored
from worker.cleaner import UploadCleaner

DATA = os.urandom(70_000)


def checksum(data: bytes) -> str:
    return "sha256 " + base64.b64encode(hashlib.sha256(data).digest()).decode()


def ask(
    client: Any, data: bytes, headers: dict[str, str] | None = None, length: int | None = None
) -> tuple[int, str, str]:
    """Status, place and offset of the answer to who has this file to send."""
    sent = {**TUS, "Upload-Length": str(len(data) if length is None else length), "Upload-Checksum": checksum(data)}
    answer = client.post("/v1/uploads", headers={**sent, **(headers or {})})
    return answer.status_code, answer.headers.get("Location", ""), answer.headers.get("Upload-Offset", "")


def test_a_file_that_was_sent_is_not_sent_again(backend: Backend, address: str) -> None:
    with httpx.Client(base_url=address) as client:
        status, url, offset = ask(client, DATA)
        assert (status, offset) == (201, "0")
        assert ask(client, DATA)[0] == 201, "half an upload is none"
        assert patch(client, url, 0, DATA).status_code == 204
        with backend.db.write() as session:
            session.execute(text("UPDATE uploads SET expires_at = '2090-01-01' WHERE sha256 IS NOT NULL"))
        before = len(list(backend.services.uploads.folder.iterdir()))
        assert ask(client, DATA) == (200, url, str(len(DATA)))
        assert len(list(backend.services.uploads.folder.iterdir())) == before
        with backend.db.read() as session:
            expires_at = session.get_one(Upload, url.rsplit("/", 1)[1]).expires_at
        assert expires_at is not None
        assert expires_at.year < 2090, "its time begins anew"
        assert ask(client, DATA, length=len(DATA) + 1)[0] == 201, "of another length it is another file"
        assert client.head(url, headers=TUS).headers["Upload-Offset"] == str(len(DATA))
        client.delete(url, headers=TUS)
        assert ask(client, DATA)[0] == 201, "it was removed"


def test_a_file_whose_hash_nobody_followed_is_found(backend: Backend, client: TestClient) -> None:
    url = begin(client, len(DATA))
    patch(client, url, 0, DATA[:100])
    application: Any = client.app
    application.state.bladeatlas.digests.__dict__.update(vars(Digests()))  # as after a restart of the server
    patch(client, url, 100, DATA[100:])
    upload = backend.services.uploads.find(url.rsplit("/", 1)[1], "default")
    assert upload is not None
    assert (upload.complete, upload.sha256) == (True, None)
    assert ask(client, DATA)[:2] == (200, url)
    assert ask(client, bytes(len(DATA)))[0] == 201, "another of the same length"


def test_what_others_sent_is_not_told(backend: Backend, address: str) -> None:
    mine, theirs = backend.key("mine"), backend.key("theirs")
    with httpx.Client(base_url=address) as client:
        _, url, _ = ask(client, DATA, mine)
        client.patch(
            url,
            content=DATA,
            headers={**TUS, **mine, "Content-Type": "application/offset+octet-stream", "Upload-Offset": "0"},
        )
        status, other, offset = ask(client, DATA, theirs)
        assert (status, offset) == (201, "0")
        assert other != url
        assert ask(client, DATA, mine)[:2] == (200, url)


@pytest.mark.parametrize("role", ["video", "annotations"])
def test_a_file_of_a_form_is_found_while_its_inspection_is_there(
    backend: Backend, address: str, unprobed: None, role: str
) -> None:
    files = {"video": VIDEO.read_bytes(), "annotations": ANNOTATIONS.read_bytes()}
    with httpx.Client(base_url=address, timeout=30) as client:
        made = client.post("/v1/inspections", files={name: (name, data) for name, data in files.items()})
        assert made.status_code == 202, made.text
        status, url, offset = ask(client, files[role])
        assert (status, offset) == (200, str(len(files[role])))
        assert stored(backend, url) == files[role]
        cleaner = UploadCleaner(Retention(backend.db), backend.services.settings.folder("uploads"), 0.0)
        cleaner.round()
        again = client.post(
            "/v1/inspections", json={f"{role}_upload": url.rsplit("/", 1)[1], "video_upload": _video(client)}
        )
        assert again.status_code == 202, again.text


def _video(client: httpx.Client) -> str:
    return ask(client, VIDEO.read_bytes())[1].rsplit("/", 1)[1]


def test_a_file_of_an_inspection_that_was_deleted_is_sent_again(backend: Backend, client: TestClient) -> None:
    one = backend.create("one", video="content")
    path = backend.services.settings.folder("made")
    path.write_bytes(b"content")
    key = f"inputs/{hashlib.sha256(b'content').hexdigest()}/video"
    backend.services.artifacts.put(key, path)
    assert ask(client, b"content")[0] == 200
    client.delete(ask(client, b"content")[1], headers=TUS)
    mark_deleted(backend.db, one)
    assert ask(client, b"content")[0] == 201


@pytest.mark.parametrize("value", ["sha1 Lve95gjOVATpfV8EL5X4nxwjKHE=", "sha256", "sha256 abc", "sha256 " + "é" * 43])
def test_checksums_that_are_none(client: TestClient, value: str) -> None:
    headers = {**TUS, "Upload-Length": "5", "Upload-Checksum": value.encode("latin-1")}
    answer = client.post("/v1/uploads", headers=headers)  # bytes, as no str may hold them
    assert (answer.status_code, answer.json()["where"]) == (400, "Upload-Checksum")


def test_limits_hold_for_a_file_of_a_form_too(backend: Backend) -> None:
    backend.create("one", video="content")
    path = backend.services.settings.folder("made")
    path.write_bytes(b"content")
    backend.services.artifacts.put(f"inputs/{hashlib.sha256(b'content').hexdigest()}/video", path)
    limited = client_of(backend.with_settings(max_kept_bytes_per_owner=3))
    assert ask(limited, b"content")[0] == 429
