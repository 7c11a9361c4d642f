"""Requests that somebody damaged, hundreds of them: a clear answer each, and nothing left behind."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from api.problems import MEDIA_TYPE
from store.account_models import DEFAULT_ACCOUNT
from tests.api.conftest import TUS, Backend, client_of
from tests.api.test_submit import form, leftovers, post
from tests.api.test_uploads import begin
from tests.damage import damaged, damaged_videos

pytestmark = pytest.mark.slow

_FORM = form(
    (
        'Content-Disposition: form-data; name="video"; filename="../../../etc/v.mp4"\r\nContent-Type: text/html',
        b"v" * 200,
    ),
    ('Content-Disposition: form-data; name="annotations"; filename="a.zip"', b'{"1.0": {"detections": []}}'),
    ('Content-Disposition: form-data; name="parameters"', json.dumps({"preset": "draft"}).encode()),
)


def outside(backend: Backend, root: Path) -> list[str]:
    """Files that are not in the data folder."""
    data = backend.services.settings.data_dir
    return [str(path) for path in root.rglob("*") if path.is_file() and not path.is_relative_to(data)]


@pytest.mark.usefixtures("unprobed")
def test_damaged_forms(backend: Backend, client: TestClient, tmp_path: Path) -> None:
    chance, statuses = random.Random(1), set()
    for _ in range(200):
        headers = {"Content-Type": "multipart/form-data; boundary=b"}
        answer = client.post("/v1/inspections", content=damaged(_FORM, chance), headers=headers)
        statuses.add(answer.status_code)
        if answer.status_code != 202:
            assert answer.headers["content-type"] == MEDIA_TYPE
            assert answer.json()["code"]
            if answer.status_code == 429:
                break
    assert statuses <= {202, 400, 422, 429}
    assert {400, 422} <= statuses
    assert leftovers(backend) == []
    assert outside(backend, tmp_path) == []


@pytest.mark.usefixtures("unprobed")
def test_damaged_json(backend: Backend, client: TestClient) -> None:
    chance = random.Random(2)
    whole = json.dumps({"video_upload": "0" * 32, "annotations": {"1": {}}, "parameters": {"options": {"seed": 1}}})
    for _ in range(100):
        content = damaged(whole.encode(), chance)
        answer = client.post("/v1/inspections", content=content, headers={"Content-Type": "application/json"})
        assert answer.status_code in (400, 422)
        assert answer.headers["content-type"] == MEDIA_TYPE
    assert leftovers(backend) == []


def test_damaged_headers_of_uploads(backend: Backend, client: TestClient) -> None:
    chance = random.Random(3)
    url = begin(client, 50)
    good = {**TUS, "Upload-Length": "50", "Upload-Offset": "0", "Upload-Metadata": "filename dA==,x"}
    good["Content-Type"] = "application/offset+octet-stream"
    for _ in range(150):
        name = chance.choice(list(good))
        value = damaged(good[name].encode(), chance).replace(b"\r", b"").replace(b"\n", b"").replace(b"\0", b"")
        headers = {**{key: text.encode() for key, text in good.items()}, name: value}
        method, path = chance.choice([("POST", "/v1/uploads"), ("PATCH", url), ("HEAD", url)])
        answer = client.request(method, path, headers=headers, content=b"" if method == "POST" else b"x")
        assert answer.status_code in (200, 201, 204, 400, 409, 412, 413, 415), (headers, answer.text)
    found = backend.services.uploads.find(url.rsplit("/", 1)[1], DEFAULT_ACCOUNT)
    assert found is not None
    assert found.offset <= 50


def test_damaged_videos(backend: Backend, tmp_path: Path) -> None:
    """What a decoder in a child process says of them; `tests/core/test_intake.py` shows it many more."""
    client = client_of(backend.with_settings(max_active=1000))
    statuses = set()
    for video in damaged_videos(backend.services.settings.data_dir, 6):
        answer = post(client, video)
        statuses.add(answer.status_code)
        assert answer.status_code in (202, 422), answer.text
        if answer.status_code == 422:
            assert answer.headers["content-type"] == MEDIA_TYPE
            assert answer.json()["code"]
    assert 422 in statuses
    assert leftovers(backend) == []
    assert outside(backend, tmp_path) == []
