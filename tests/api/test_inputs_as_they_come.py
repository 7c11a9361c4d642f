"""Small files of kinds that went wrong, posted: looked into by the real probe process, accepted or clearly refused."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Sequence
from pathlib import Path

import jsonschema
import pytest
from fastapi.testclient import TestClient
from PIL import Image

from tests.core.making_videos import picture
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow


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
        ("s360_sar43.mp4", None),
        ("s480i.mp4", None),
        ("raw.h264", "k96.json"),
        ("mjpeg_half.avi", None),
        ("corrupt_mid.avi", None),
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


def zipped(sizes: Sequence[tuple[int, int]]) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as pictures:
        for number, size in enumerate(sizes):
            one = io.BytesIO()
            Image.fromarray(picture(number, *size)).save(one, "PNG")
            pictures.writestr(f"{number}.png", one.getvalue())
    return packed.getvalue()


@pytest.mark.parametrize(
    ("sizes", "options", "code"),
    [
        ([(160, 128)] * 12, {"input.fps": 10}, None),
        ([(160, 128)] * 12, {}, "fps_missing"),
        ([(160, 128), (128, 160)], {"input.fps": 10}, "frame_size_changes"),
        ([], {"input.fps": 10}, "not_a_video"),
        ([(60, 60)] * 3, {"input.fps": 10}, "roi_too_small"),
    ],
)
def test_a_zip_of_pictures_is_a_video(
    sizes: Sequence[tuple[int, int]], options: dict[str, float], code: str | None, client: TestClient
) -> None:
    files = {"video": ("p.zip", zipped(sizes)), "parameters": (None, json.dumps({"options": options}))}
    answer = client.post("/v1/inspections", files=files)
    assert (answer.status_code, answer.json().get("code")) == (422 if code else 202, code), answer.text


def test_a_rate_for_a_file_that_has_times_is_refused(client: TestClient) -> None:
    files = {"video": ("m96.avi", (INPUTS / "m96.avi").read_bytes())}
    answer = client.post("/v1/inspections", files={**files, "parameters": (None, '{"options": {"input.fps": 12}}')})
    assert (answer.status_code, answer.json()["code"]) == (422, "fps_not_needed")


def test_a_stream_that_is_not_there_is_refused(client: TestClient) -> None:
    parameters = json.dumps({"options": {"input.video_stream": 5}})
    files = {"video": ("twov.mp4", (INPUTS / "twov.mp4").read_bytes()), "parameters": (None, parameters)}
    answer = client.post("/v1/inspections", files=files)
    assert (answer.status_code, answer.json()["code"]) == (422, "no_such_stream")


FOREIGN = INPUTS / "foreign"
SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.fixture(scope="module")
def turbine() -> bytes:
    return (SAMPLES / "turbine.mp4").read_bytes()


@pytest.mark.parametrize(
    "name", ["coco.json", "cvat.xml", "cvat_export.zip", "labelstudio.json", "tools/datumaro_yolo.zip", "via3.json"]
)
def test_annotations_of_other_tools_are_accepted(name: str, turbine: bytes, client: TestClient) -> None:
    files = {"video": ("a", turbine), "annotations": ("a", (FOREIGN / name).read_bytes())}
    answer = client.post("/v1/inspections", files=files)
    assert answer.status_code == 202, answer.text


@pytest.mark.parametrize(
    ("name", "options", "code", "part"),
    [
        ("coco_results.json", {}, "annotations_unknown_format", "results of COCO alone"),
        ("coco.json", {"input.annotation_format": "via"}, "annotations_unknown_format", "seems to be COCO"),
        ("voc.xml", {}, "annotations_invalid", "names no size of its picture"),
    ],
)
def test_other_annotations_are_refused_with_what_they_seem_to_be(
    name: str, options: dict[str, str], code: str, part: str, turbine: bytes, client: TestClient
) -> None:
    files = {
        "video": ("a", turbine),
        "annotations": ("a", (FOREIGN / name).read_bytes()),
        "parameters": (None, json.dumps({"options": options})),
    }
    answer = client.post("/v1/inspections", files=files)
    assert (answer.status_code, answer.json()["code"]) == (422, code)
    assert part in answer.json()["detail"]


def test_annotations_made_on_pictures_of_another_shape_are_refused(client: TestClient, turbine: bytes) -> None:
    shape = json.loads((FOREIGN / "labelme.json").read_text())
    other = json.dumps({**shape, "imageWidth": 1280}).encode()
    answer = client.post("/v1/inspections", files={"video": ("a", turbine), "annotations": ("a", other)})
    assert (answer.status_code, answer.json()["code"]) == (422, "annotations_other_size")
    assert "1280x720" in answer.json()["detail"]
    assert "960x720" in answer.json()["detail"]


def test_the_schema_of_our_own_form_is_published(client: TestClient) -> None:
    answer = client.get("/v1/schemas/annotations.json")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/schema+json")
    jsonschema.validate(json.loads((SAMPLES / "turbine.json").read_text()), answer.json())
