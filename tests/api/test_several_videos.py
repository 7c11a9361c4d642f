"""An inspection of several videos over HTTP: parts in order, uploads in order, limits that hold for the sum."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient

from api.app import create_app
from cli.client import Client
from cli.client.transfers import Transfers
from core.videos import MAX_VIDEOS, Recording
from store.records import InputFiles
from tests.api.conftest import Backend, client_of
from tests.api.test_uploads import begin, patch
from tests.core.making_videos import every_ms, make_video

Files = list[tuple[str, tuple[str, bytes]]]
KEYS = json.dumps({"0.04": {"detections": [{"label": "dent", "bbox": [0.1, 0.1, 0.4, 0.4]}]}}).encode()


def part(name: str, data: bytes) -> tuple[str, tuple[str, bytes]]:
    return (name, (name, data))


def digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


@pytest.fixture(scope="module")
def videos(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("videos")
    return [make_video(folder / f"{count}.mp4", every_ms(40, count)) for count in (8, 12)]


def uploaded(client: TestClient, data: bytes) -> str:
    url = begin(client, len(data))
    patch(client, url, 0, data)
    return url.rsplit("/", 1)[1]


def test_two_videos_over_real_http_are_looked_into_and_kept_in_order(
    backend: Backend, serve: Callable[..., str], videos: list[Path], tmp_path: Path
) -> None:
    address, notes = serve(create_app(backend.services)), tmp_path / "notes.json"
    notes.write_bytes(KEYS)
    with Client(address, transfers=Transfers(tmp_path / "transfers")) as client:
        sent = client.submit(videos[0], None, {"preset": "draft"}, further=[Recording(videos[1], notes)])
    names = [{"video": n, "sha256": digest(path.read_bytes())} for n, path in enumerate(videos)]
    assert sent.raw["videos"] == [
        {**names[0], "annotations_sha256": None},
        {**names[1], "annotations_sha256": digest(KEYS)},
    ]
    assert sent.raw["input_sha256"] == {"video": names[0]["sha256"], "annotations": None}
    files = backend.services.inspections.get(sent.id).files
    assert [one.video_sha256 for one in files] == [name["sha256"] for name in names]
    with backend.services.artifacts.open(files[1].video) as stream:
        assert stream.read() == videos[1].read_bytes()
    answer = httpx.post(
        f"{address}/v1/inspections",
        files=[
            *(part("video", path.read_bytes()) for path in videos),
            part("annotations", b""),
            part("annotations", KEYS),
        ],
        timeout=60.0,
    )
    assert answer.status_code == 202, answer.text
    assert answer.json()["videos"] == sent.raw["videos"], "an empty part stands for none"


def test_videos_of_two_sizes_are_refused(client: TestClient, videos: list[Path], tmp_path: Path) -> None:
    small = make_video(tmp_path / "small.mp4", every_ms(40, 4), size=(96, 64))
    answer = client.post("/v1/inspections", files=[part("video", path.read_bytes()) for path in (videos[0], small)])
    assert (answer.status_code, answer.json()["code"]) == (422, "video_sizes_differ")
    assert "160x128" in answer.json()["detail"]
    assert "96x64" in answer.json()["detail"]


@pytest.mark.parametrize(
    ("limit", "code"), [({"max_video_frames": 19}, "too_many_frames"), ({"max_video_seconds": 0.7}, "too_long")]
)
def test_limits_on_frames_and_seconds_hold_for_the_sum(
    backend: Backend, videos: list[Path], limit: dict[str, Any], code: str
) -> None:
    files = [part("video", path.read_bytes()) for path in videos]
    client = client_of(backend.with_settings(**limit))
    answer = client.post("/v1/inspections", files=files)
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert client.post("/v1/inspections", files=files[:1]).status_code == 202


@pytest.mark.usefixtures("unprobed")
def test_a_limit_on_bytes_holds_for_the_sum(backend: Backend) -> None:
    client = client_of(backend.with_settings(max_upload_bytes=100))
    both: Files = [part("video", b"a" * 60), part("video", b"b" * 41)]
    answer = client.post("/v1/inspections", files=both)
    assert (answer.status_code, answer.json()["code"]) == (413, "too_large")
    assert client.post("/v1/inspections", files=[both[0], part("video", b"b" * 40)]).status_code == 202
    named = [{"video_upload": uploaded(client, data)} for data in (b"a" * 60, b"b" * 41)]
    answer = client.post("/v1/inspections", json={"videos": named})
    assert (answer.status_code, answer.json()["code"]) == (413, "too_large")
    assert list(backend.services.settings.folder("uploads").glob("*.part*")) == []


@pytest.mark.usefixtures("unprobed")
@pytest.mark.parametrize(
    ("files", "pointer"),
    [
        ([part("video", b"a"), part("video", b"b"), part("annotations", b"{}")], "/annotations"),
        ([part("video", b"a"), part("annotations", b"{}"), part("annotations", b"{}")], "/annotations"),
        ([part("annotations", b"{}")], "/video"),
        ([part("video", b"a")] * (MAX_VIDEOS + 1), "/video"),
        ([part("video", b"a"), part("parameters", b"{}"), part("parameters", b"{}")], "/parameters"),
    ],
)
def test_parts_that_do_not_belong_together_are_named(client: TestClient, files: Files, pointer: str) -> None:
    answer = client.post("/v1/inspections", files=files)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, pointer)


@pytest.mark.usefixtures("unprobed")
def test_the_order_of_videos_is_part_of_the_request(backend: Backend, client: TestClient) -> None:
    files: Files = [part("video", b"a"), part("video", b"b")]
    key = {"Idempotency-Key": "order-1"}
    first = client.post("/v1/inspections", files=files, headers=key)
    assert client.post("/v1/inspections", files=files, headers=key).json()["id"] == first.json()["id"]
    other = client.post("/v1/inspections", files=files[::-1], headers=key)
    assert (other.status_code, other.json()["code"]) == (422, "idempotency_key_reused")
    swapped = client.post("/v1/inspections", files=files[::-1]).json()
    digests = [backend.services.inspections.get(one).input_digest for one in (first.json()["id"], swapped["id"])]
    assert digests[0] != digests[1]


@pytest.mark.usefixtures("unprobed")
@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({}, "/video_upload"),
        ({"videos": []}, "/videos"),
        ({"videos": [{}]}, "/videos/0/video_upload"),
        ({"videos": [{"video_upload": "UP"}], "video_upload": "UP"}, "/videos"),
        ({"videos": [{"video_upload": "UP"}, {"video_upload": "none"}]}, "/videos/1/video_upload"),
        (
            {"videos": [{"video_upload": "UP", "annotations": {}, "annotations_upload": "UP"}]},
            "/videos/0/annotations_upload",
        ),
    ],
)
def test_a_body_that_cannot_be_meant_is_named(client: TestClient, body: dict[str, Any], pointer: str) -> None:
    name = uploaded(client, b"a")
    answer = client.post("/v1/inspections", json=json.loads(json.dumps(body).replace("UP", name)))
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, pointer)


@pytest.mark.usefixtures("unprobed")
def test_a_retry_keeps_all_videos(backend: Backend, client: TestClient) -> None:
    sent = client.post("/v1/inspections", files=[part("video", b"a"), part("video", b"b")]).json()
    backend.work(sent["id"])
    backend.publish(sent["id"])
    before = backend.services.inspections.get(sent["id"])
    assert (
        client.post(f"/v1/inspections/{sent['id']}/retry", json={"parameters": {"preset": "draft"}}).status_code == 202
    )
    after = backend.services.inspections.get(sent["id"])
    assert after.files == before.files
    assert [type(one) for one in after.files] == [InputFiles, InputFiles]


def test_tables_can_be_asked_for_one_video(backend: Backend, client: TestClient) -> None:
    row = {"key": "1", "time_s": 1.0, "label": "dent", "outcome": "unplaced", "support_points": 0}
    box = dict.fromkeys(("box_x1", "box_y1", "box_x2", "box_y2"), 0.5)
    rows = [{**row, **box, "id": number, "video": number // 2} for number in range(4)]
    one = backend.finished("two", detections=rows)
    for video, ids in ((0, [0, 1]), (1, [2, 3]), (2, [])):
        found = client.get(f"/v1/inspections/{one}/detections?video={video}").json()
        assert [(found_row["id"], found_row["video"]) for found_row in found] == [(i, video) for i in ids]
    assert client.get(f"/v1/inspections/{one}/timeline?video=1").json() == []
    assert client.get(f"/v1/inspections/{one}/detections?video=-1").status_code == 422
