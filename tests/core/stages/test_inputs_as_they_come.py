"""Small files of kinds that went wrong, through the stages that read the user's input."""

from __future__ import annotations

import hashlib
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import av
import cv2
import numpy as np
import pytest

from core.errors import BadInput
from core.video.table import FrameTable
from tests.core.test_bad_input import run_stages
from tests.inputs import INPUTS

DETECTION = {"detections": [{"label": "dent", "score": 0.9, "bbox": [0.2, 0.2, 0.4, 0.4]}]}


def stages(folder: Path, video: str, annotations: str | None = None, **options: Any) -> dict[str, Any]:
    names = {name.replace("__", "."): value for name, value in options.items()}
    return run_stages(folder, INPUTS / video, INPUTS / annotations if annotations else None, names)


def codes(facts: dict[str, Any]) -> list[str]:
    return [flag["code"] for flag in facts["flags"]]


def exported(folder: Path) -> list[dict[str, Any]]:
    rows = json.loads((folder / "results" / "frames" / "frames.json").read_text("utf-8"))
    assert isinstance(rows, list)
    return rows


@pytest.mark.parametrize(
    ("video", "frames", "said"),
    [
        ("afirst.mp4", 48, []),
        ("kvz.mp4", 48, []),
        ("twov.mp4", 48, ["video_stream_chosen"]),
        ("cover_noflag.mp4", 48, ["video_stream_chosen"]),
        ("concat_disc.ts", 96, ["recording_joined"]),
    ],
)
def test_every_frame_of_the_film_is_exported_from_its_own_stream(
    video: str, frames: int, said: list[str], tmp_path: Path
):
    facts = stages(tmp_path, video)
    assert (facts["probe"]["n_frames"], facts["frames"]["n_frames"]) == (frames, frames)
    assert codes(facts["probe"]) == said
    with av.open(str(INPUTS / video)) as container:
        film = max(container.streams.video, key=lambda stream: stream.width * stream.frames)
        film.thread_type = "NONE"
        shown = [frame.to_ndarray(format="rgb24") for frame in container.decode(film)]
    rows = exported(tmp_path)
    assert [row["sha256"] for row in rows] == [hashlib.sha256(rgb.tobytes()).hexdigest() for rgb in shown]
    images = tmp_path / "results" / "frames" / "images"
    for row in rows[::11]:
        image = cv2.imread(str(images / f"{row['index']:04d}.jpg"))
        assert np.abs(image[..., ::-1].astype(int) - shown[row["source_index"]].astype(int)).mean() < 3


def test_the_result_names_the_stream_and_takes_another_when_told(tmp_path: Path):
    (flag,) = stages(tmp_path, "twov.mp4")["probe"]["flags"]
    assert flag["where"] == ("stream 1 of: stream 0 (mjpeg, 160x120, 4 frames); stream 1 (h264, 480x360, 48 frames)")
    told = stages(tmp_path / "told", "twov.mp4", input__video_stream=0, roi__y1=1)
    assert (told["probe"]["width"], told["frames"]["n_frames"]) == (160, 4)


def test_keys_of_a_joined_recording_find_their_frames(tmp_path: Path):
    facts = stages(tmp_path, "concat_disc.ts", "k96.json")
    assert facts["annotations"]["n_without_frame"] == 0
    (flag,) = facts["probe"]["flags"]
    assert (flag["code"], flag["severity"], flag["where"]) == ("recording_joined", "info", "frame 48")
    found = json.loads((tmp_path / "results" / "annotations" / "detections.json").read_text("utf-8"))
    assert [row["source_index"] for row in found] == [round(Fraction(row["key"]) * 12) for row in found]
    table = FrameTable.read(tmp_path / "results" / "probe")
    assert [round(row.time_s * 12) for row in table.rows] == list(range(96))


def test_facts_and_files_name_the_same_part_of_the_picture(tmp_path: Path):
    facts = stages(tmp_path, "kvz.mp4", roi__x0=0.1, roi__y0=0.2, roi__x1=0.9, roi__y1=0.75)
    assert facts["frames"]["crop"] == [48, 72, 432, 270]
    assert (facts["frames"]["source_width"], facts["frames"]["source_height"]) == (480, 360)
    crop = json.loads((tmp_path / "results" / "frames" / "crop.json").read_text("utf-8"))
    assert [crop[name] for name in ("x0", "y0", "x1", "y1")] == facts["frames"]["crop"]


@pytest.mark.parametrize("video", ["d_x265_rand.mp4", "d_x264g12_rand.mp4"])
def test_lost_frames_refuse_the_video_until_it_is_allowed_and_are_named_then(video: str, tmp_path: Path):
    with pytest.raises(BadInput, match=r"4 frames lost after frame 18 at 1\.500 s"):
        stages(tmp_path, video)
    facts = stages(tmp_path / "allowed", video, input__allow_truncated=True)
    (flag,) = facts["probe"]["flags"]
    assert flag["code"] == "truncated_video"
    assert flag["where"].startswith("4 frames lost after frame 18")
    assert facts["frames"]["n_frames"] == 44
