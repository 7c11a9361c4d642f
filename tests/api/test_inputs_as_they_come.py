"""Small files of kinds that went wrong, posted: looked into by the real probe process, accepted or clearly refused."""

from __future__ import annotations

import json

import pytest
from fastapi.testclient import TestClient

from tests.inputs import INPUTS


@pytest.mark.parametrize(
    ("video", "annotations"),
    [
        ("afirst.mp4", None),
        ("twov.mp4", None),
        ("cover_noflag.mp4", None),
        ("concat_disc.ts", "k96.json"),
        ("d_x265_rand.mp4", None),
        ("d_x264g12_rand.mp4", None),
        ("kvz.mp4", None),
        ("gpb1080.mp4", None),
        ("m96_drop15.avi", "cv_fps.json"),
        ("m96.avi", "k25.json"),
        ("m96.avi", "frames_few.json"),
        ("m96.avi", "ms.json"),
        ("m96.avi", "labels.json"),
        ("m96.avi", "nulldet.json"),
    ],
)
def test_a_film_is_accepted(video: str, annotations: str | None, client: TestClient) -> None:
    """What only a whole pass can find, the stages say later."""
    files = {"video": (video, (INPUTS / video).read_bytes())}
    if annotations:
        files["annotations"] = (annotations, (INPUTS / annotations).read_bytes())
    answer = client.post("/v1/inspections", files=files)
    assert answer.status_code == 202, answer.text


def test_large_pictures_are_refused_with_the_limit(client: TestClient) -> None:
    answer = client.post("/v1/inspections", files={"video": ("big180.mp4", (INPUTS / "big180.mp4").read_bytes())})
    assert (answer.status_code, answer.json()["code"]) == (422, "too_many_pixels")
    assert "40,000,000" in answer.json()["detail"]


def test_a_stream_that_is_not_there_is_refused(client: TestClient) -> None:
    parameters = json.dumps({"options": {"input.video_stream": 5}})
    files = {"video": ("twov.mp4", (INPUTS / "twov.mp4").read_bytes()), "parameters": (None, parameters)}
    answer = client.post("/v1/inspections", files=files)
    assert (answer.status_code, answer.json()["code"]) == (422, "no_such_stream")
