"""Starting inspections: by form, by finished uploads, once per key, and nothing of strangers gets further."""

from __future__ import annotations

import hashlib
import json
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import select

from api.app import create_app
from core.calibration.documents import MAX_BYTES
from store.models import Inspection
from tests.api.conftest import ANNOTATIONS, TUS, VIDEO, Backend, client_of
from tests.api.test_uploads import begin, patch
from tests.inputs import INPUTS

SMALL = b"not really a video"


def rows(backend: Backend) -> list[Inspection]:
    with backend.db.read() as session:
        return list(session.scalars(select(Inspection)))


def post(
    client: TestClient, video: bytes = SMALL, headers: dict[str, str] | None = None, **fields: Any
) -> httpx.Response:
    files: dict[str, Any] = {"video": ("../../evil.mp4", video, "application/octet-stream")}
    files.update({name: (None, value) for name, value in fields.items()})
    answer: httpx.Response = client.post("/v1/inspections", files=files, headers=headers)
    return answer


def leftovers(backend: Backend) -> list[str]:
    return [path.name for path in backend.services.settings.folder("uploads").iterdir()]


def test_a_form_with_the_sample_starts_an_inspection(backend: Backend, client: TestClient) -> None:
    asked = {"preset": "draft", "options": {"matching.window": 8}, "label": "blade", "external_id": "WO-1"}
    answer = client.post(
        "/v1/inspections",
        files={
            "video": ("v", VIDEO.read_bytes()),
            "annotations": ("a", ANNOTATIONS.read_bytes()),
            "parameters": (None, json.dumps(asked)),
        },
    )
    assert answer.status_code == 202, answer.text
    body = answer.json()
    assert answer.headers["Location"] == body["links"]["self"] == f"/v1/inspections/{body['id']}"
    assert answer.headers["Retry-After"]
    assert (body["state"], body["label"], body["external_id"], body["attempt"]) == ("queued", "blade", "WO-1", 1)
    assert body["parameters"] == {"preset": "draft", "options": {"matching.window": 8}}
    assert body["queue"]["position"] == 1
    least, most = body["queue"]["eta_s"]
    assert 0 <= least < most, "nothing is learnt yet, so what is shipped says it"
    digest = hashlib.sha256(VIDEO.read_bytes()).hexdigest()
    assert body["input_sha256"]["video"] == digest
    (row,) = rows(backend)
    assert row.video_path == f"inputs/{digest}/video"
    assert row.settings["matching"]["window"] == 8
    with backend.services.artifacts.open(row.video_path) as stream:
        assert stream.read() == VIDEO.read_bytes()
    assert row.annotations_path is not None
    assert backend.services.artifacts.size(row.annotations_path) == ANNOTATIONS.stat().st_size
    assert backend.woken == [body["id"]]
    assert leftovers(backend) == []


def test_what_tools_on_other_systems_write_is_read(backend: Backend, client: TestClient) -> None:
    """Parameters with a byte order mark, and null where there are no detections."""
    marked, empty = (INPUTS / "param_bom.json").read_bytes(), (INPUTS / "nulldet.json").read_bytes()
    answer = post(client, VIDEO.read_bytes(), parameters=marked, annotations=empty)
    assert answer.status_code == 202, answer.text
    assert answer.json()["parameters"]["preset"] == "draft"
    assert backend.woken == [answer.json()["id"]]


def test_finished_uploads_start_an_inspection(backend: Backend, client: TestClient) -> None:
    video = VIDEO.read_bytes()
    url = begin(client, len(video))
    name = url.rsplit("/", 1)[1]
    half = client.post("/v1/inspections", json={"video_upload": name})
    assert (half.status_code, half.json()["errors"][0]["pointer"]) == (422, "/video_upload")
    patch(client, url, 0, video)
    annotations = json.loads(ANNOTATIONS.read_text())
    answer = client.post("/v1/inspections", json={"video_upload": name, "annotations": annotations})
    assert answer.status_code == 202, answer.text
    exported = json.loads((INPUTS / "foreign" / "labelstudio.json").read_text())
    listed = client.post("/v1/inspections", json={"video_upload": name, "annotations": exported})
    assert listed.status_code == 202, "Label Studio exports a list"
    assert client.delete(url, headers=TUS).status_code == 204
    with backend.services.artifacts.open(rows(backend)[0].video_path) as stream:
        assert stream.read() == video, "the inspection keeps what its upload had"
    assert leftovers(backend) == []


@pytest.mark.usefixtures("unprobed")
def test_a_key_has_one_effect(backend: Backend, client: TestClient) -> None:
    key = {"Idempotency-Key": "order-1"}
    first = post(client, headers=key)
    again = post(client, headers=key)
    assert (first.status_code, again.status_code) == (202, 202)
    assert first.json()["id"] == again.json()["id"]
    other = post(client, SMALL + b"!", headers=key)
    assert (other.status_code, other.json()["code"]) == (422, "idempotency_key_reused")
    for changed in ({"preset": "draft"}, {"options": {"matching.window": 9}}, {"label": "x"}, {"external_id": "x"}):
        other = post(client, headers=key, parameters=json.dumps(changed))
        assert (other.status_code, other.json()["code"]) == (422, "idempotency_key_reused"), changed
    other = post(client, headers=key, annotations="{}")
    assert (other.status_code, other.json()["code"]) == (422, "idempotency_key_reused")
    assert post(client, headers={"Idempotency-Key": "order-2"}).json()["id"] != first.json()["id"]
    assert len(rows(backend)) == 2


@pytest.mark.usefixtures("unprobed")
def test_equal_requests_at_once_make_one_inspection(backend: Backend, serve: Any) -> None:
    """Two applications that share nothing but the database."""
    addresses = [serve(create_app(backend.services)) for _ in range(2)]

    def ask(number: int) -> httpx.Response:
        headers = {"Idempotency-Key": "order-1"}
        return httpx.post(f"{addresses[number % 2]}/v1/inspections", files={"video": SMALL}, headers=headers)

    with ThreadPoolExecutor(8) as pool:
        answers = list(pool.map(ask, range(16)))
    assert {answer.status_code for answer in answers} <= {202, 409}
    assert len({answer.json()["id"] for answer in answers if answer.status_code == 202}) == 1
    assert len(rows(backend)) == 1


@pytest.mark.usefixtures("unprobed")
@pytest.mark.parametrize(
    ("parameters", "status", "pointer"),
    [
        ("{", 400, None),
        ('{"options": {"seed": NaN}}', 400, None),
        ("[" * 100_000, 400, None),
        ('{"label": "\\u0000"}', 400, None),
        ('{"label": "\\ud800"}', 400, None),
        ("1" * 5000, 400, None),
        ("[]", 422, "/parameters"),
        ('{"presset": "draft"}', 422, "/parameters/presset"),
        ('{"preset": "fast"}', 422, "/parameters/preset"),
        ('{"options": {"matching.windw": 3}}', 422, "/parameters/options/matching.windw"),
        ('{"options": {"matching.window": -1}}', 422, "/parameters/options/matching.window"),
        (json.dumps({"label": "x" * 257}), 422, "/parameters/label"),
        ("x" * ((1 << 20) + 1), 413, "/parameters"),
    ],
)
def test_wrong_parameters_are_named(
    backend: Backend, client: TestClient, parameters: str, status: int, pointer: str | None
) -> None:
    answer = post(client, parameters=parameters)
    assert answer.status_code == status, answer.text
    assert [error["pointer"] for error in answer.json()["errors"]] == ([pointer] if pointer else [])
    assert (rows(backend), leftovers(backend), backend.woken) == ([], [], [])


@pytest.mark.parametrize(
    ("video", "annotations", "code"),
    [
        (b"", None, "empty_file"),
        (SMALL, None, "not_a_video"),
        (b"#EXTM3U\n#EXTINF:1,\nfile:///etc/passwd\n", None, "not_a_video"),
        (VIDEO.read_bytes()[:3000], None, "no_frames"),
        (VIDEO.read_bytes(), b"{", "annotations_malformed"),
        (VIDEO.read_bytes(), b"[" * 1_000_000, "annotations_malformed"),
        (VIDEO.read_bytes(), b'{"1": {"detections": [{"label": "x", "bbox": [1, 1, 0, 0]}]}}', "box_inverted"),
    ],
)
def test_files_that_no_run_can_use_are_refused(
    backend: Backend, client: TestClient, video: bytes, annotations: bytes | None, code: str
) -> None:
    fields: dict[str, Any] = {} if annotations is None else {"annotations": annotations}
    answer = post(client, video, **fields)
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert (rows(backend), leftovers(backend)) == ([], [])
    assert backend.services.artifacts.list() == []


LENS = b"1 PINHOLE 480 360 260 260 240 180\n"
"""COLMAP's camera of a picture of half the size of the sample's frames."""


def test_a_calibration_tells_the_lens_and_named_options_count_before_it(backend: Backend, client: TestClient) -> None:
    answer = post(client, VIDEO.read_bytes(), calibration=LENS)
    assert answer.status_code == 202, answer.text
    told = {"camera.model": "PINHOLE", "camera.params": [260, 260, 240, 180], "camera.size_px": [480, 360]}
    assert answer.json()["parameters"]["options"] == told
    other = {"camera.params": [250, 250, 240, 180], "mapper.refine_lens": True}
    answer = post(client, VIDEO.read_bytes(), calibration=LENS, parameters=json.dumps({"options": other}))
    assert answer.status_code == 202, answer.text
    assert answer.json()["parameters"]["options"] == {**told, **other}
    first, second = sorted((row.settings for row in rows(backend)), key=lambda kept: kept["mapper"]["refine_lens"])
    assert (first["camera"]["model"], first["camera"]["params"][0], first["camera"]["size_px"]) == (
        "PINHOLE",
        260,
        [480, 360],
    )
    assert (second["camera"]["params"][0], second["mapper"]["refine_lens"]) == (250, True)


@pytest.mark.parametrize(
    ("calibration", "status", "words"),
    [
        (b"1 FULL_OPENCV 480 360 1 2 3 4 5 6 7 8 9 10 11 12\n", 422, "'FULL_OPENCV' is not read"),
        (b"1 PINHOLE 480 480 260 260 240 240\n", 422, "480x480 and the video has 960x720"),
        (b"#" * (MAX_BYTES + 1), 413, str(MAX_BYTES)),
    ],
)
def test_a_calibration_that_tells_no_lens_of_the_video_is_refused(
    backend: Backend, client: TestClient, calibration: bytes, status: int, words: str
) -> None:
    answer = post(client, VIDEO.read_bytes(), calibration=calibration)
    assert answer.status_code == status
    assert words in answer.text
    assert (rows(backend), leftovers(backend)) == ([], [])


def form(*parts: tuple[str, bytes]) -> bytes:
    return b"".join(b"--b\r\n" + name.encode() + b"\r\n\r\n" + data + b"\r\n" for name, data in parts) + b"--b--\r\n"


_VIDEO_PART = 'Content-Disposition: form-data; name="video"; filename="v"'
_PARAMETERS_PART = 'Content-Disposition: form-data; name="parameters"'


@pytest.mark.usefixtures("unprobed")
@pytest.mark.parametrize(
    ("content_type", "body", "status"),
    [
        ("text/plain", b"x", 415),
        ("multipart/form-data", form((_VIDEO_PART, b"x")), 400),
        ("multipart/form-data; boundary=" + "b" * 71, form((_VIDEO_PART, b"x")), 400),
        ("multipart/form-data; boundary=b", b"", 400),
        ("multipart/form-data; boundary=b", b"garbage", 400),
        ("multipart/form-data; boundary=b", form((_VIDEO_PART, b"x"))[:-6], 400),
        ("multipart/form-data; boundary=b", form(("No: name", b"x")), 422),
        ("multipart/form-data; boundary=b", form(('Content-Disposition: form-data; name="../x"', b"x")), 422),
        ("multipart/form-data; boundary=b", form((_VIDEO_PART, b"x"), *2 * [(_PARAMETERS_PART, b"{}")]), 422),
        ("multipart/form-data; boundary=b", form((_PARAMETERS_PART, b"{}")), 422),
        ("multipart/form-data; boundary=b", form((_VIDEO_PART + "; x=" + "y" * 10_000, b"x")), 400),
        ("multipart/form-data; boundary=b", form((_VIDEO_PART, b"x" * 2001)), 413),
        ("application/json", b"{", 400),
        ("application/json", b"[1]", 422),
        ("application/json", b'{"video_upload": "../../bladeatlas.db"}', 422),
        ("application/json", b'{"video_upload": "x", "more": 1}', 422),
        ("application/json", b" " * ((8 << 20) + 1), 413),
    ],
)
def test_malformed_bodies_leave_nothing_behind(backend: Backend, content_type: str, body: bytes, status: int) -> None:
    client = client_of(backend.with_settings(max_upload_bytes=2000))
    answer = client.post("/v1/inspections", content=body, headers={"Content-Type": content_type})
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    assert (rows(backend), leftovers(backend)) == ([], [])


def test_too_many_and_too_full_are_said_before_anything_is_read(backend: Backend) -> None:
    backend.create("one")
    busy = post(client_of(backend.with_settings(max_active=1)))
    assert (busy.status_code, busy.json()["code"]) == (429, "too_many_active")
    assert busy.headers["Retry-After"]
    full = post(client_of(backend.with_settings(reserve_bytes=1 << 60)))
    assert (full.status_code, full.json()["code"]) == (507, "disk_full")


def test_a_decoder_above_its_limits_is_bad_input(backend: Backend, tmp_path: Path) -> None:
    client = client_of(backend.with_settings(probe_memory_bytes=32 << 20))
    answer = post(client, VIDEO.read_bytes())
    assert answer.status_code == 422
    assert answer.json()["code"] in ("probe_died", "too_complex", "not_a_video")
    late = post(client_of(backend.with_settings(probe_seconds=0.01)), VIDEO.read_bytes())
    assert (late.status_code, late.json()["code"]) == (503, "probe_busy"), "it had hardly begun"
