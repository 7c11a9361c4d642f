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
from numpy.typing import NDArray
from PIL import Image

from core.errors import BadInput
from core.features.io import read_features
from core.settings import make_settings
from core.stage import StageTask
from core.stages import features
from core.video.table import FrameTable
from core.videos import Recording
from tests.core.making_films import ffmpeg_pixels
from tests.core.test_bad_input import run_stages
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow

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
        ("m96.avi", 96, []),
        ("m96_drop15.avi", 90, []),
        ("raw.h264", 48, ["times_made_up"]),
        ("mjpeg_half.avi", 48, ["damaged_pictures"]),
        ("corrupt_mid.avi", 48, ["damaged_pictures"]),
    ],
)
def test_every_frame_of_the_film_is_exported_from_its_own_stream(
    video: str, frames: int, said: list[str], tmp_path: Path
) -> None:
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
        assert image is not None
        assert np.abs(image[..., ::-1].astype(int) - shown[row["source_index"]].astype(int)).mean() < 3


def difference(folder: Path, pictures: NDArray[np.uint8]) -> float:
    """Mean difference of the worst exported image from the picture of its frame, grey levels."""
    worst = 0.0
    for row in exported(folder):
        coded = cv2.imread(str(folder / "results" / "frames" / "images" / f"{row['index']:04d}.jpg"))
        assert coded is not None
        image = coded[..., ::-1]
        shown = pictures[row["source_index"]]
        assert image.shape == shown.shape
        worst = max(worst, float(np.abs(image.astype(int) - shown.astype(int)).mean()))
    return worst


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize(
    ("video", "frames", "filters", "code", "where"),
    [
        ("s360_sar43.mp4", 96, "scale=iw*sar:ih,setsar=1", "pixels_not_square", "aspect ratio 4:3, pictures 480x360"),
        ("s480i.mp4", 48, "bwdif=mode=send_frame", "interlaced", "48 of 48 frames"),
    ],
)
def test_what_is_exported_is_what_ffmpeg_makes_of_it(
    video: str, frames: int, filters: str, code: str, where: str, tmp_path: Path
) -> None:
    facts = stages(tmp_path, video, frames__jpeg_quality=100)
    (flag,) = facts["probe"]["flags"]
    assert (flag["code"], flag["severity"]) == (code, "info")
    assert where in flag["where"]
    assert (facts["frames"]["source_width"], facts["frames"]["source_height"]) == (480, 360)
    assert (facts["probe"]["n_frames"], facts["frames"]["n_frames"]) == (frames, frames)
    assert difference(tmp_path, ffmpeg_pixels(INPUTS / video, "v:0", 480, 360, filters)) < 2
    with av.open(str(INPUTS / video)) as container:
        decoded = [frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)]
    hashes = [hashlib.sha256(rgb.tobytes()).hexdigest() for rgb in decoded]
    assert [row["sha256"] for row in exported(tmp_path)] == hashes, "hashes are those of the decoded frames"


def test_boxes_are_shares_of_the_square_picture(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text(json.dumps({"0.5": DETECTION, "1.0": DETECTION}), encoding="utf-8")
    facts = stages(tmp_path, "s360_sar43.mp4", str(tmp_path / "a.json"), roi__x0=0.25, roi__y0=0.5)
    assert facts["frames"]["crop"] == [120, 180, 480, 360]
    (first, _) = json.loads((tmp_path / "results" / "annotations" / "detections.json").read_text("utf-8"))
    assert (first["box"], first["source_index"]) == ([0.2, 0.2, 0.4, 0.4], 6)


@pytest.mark.parametrize(("video", "frames"), [("mjpeg_half.avi", [20, 21, 22, 23, 24]), ("corrupt_mid.avi", [23])])
def test_damaged_pictures_stay_in_the_table_and_give_no_keypoints(
    video: str, frames: list[int], tmp_path: Path
) -> None:
    facts = stages(tmp_path, video)
    (flag,) = facts["probe"]["flags"]
    assert (flag["severity"], flag["value"]) == ("warning", len(frames))
    assert flag["where"] == f"frame {', '.join(map(str, frames))}"
    assert (facts["frames"]["n_frames"], facts["frames"]["n_damaged"]) == (48, len(frames))
    out = tmp_path / "features"
    out.mkdir()
    settings = make_settings(options={"features.method": "sift", "features.max_keypoints": 100})
    inputs = {"frames": tmp_path / "results" / "frames"}
    features.run(
        StageTask("features/000", {"start": 18, "end": 27}, settings, inputs, {}, (Recording(Path(video)),), out)
    )
    empty = [index for index in range(18, 27) if not len(read_features(out / f"{index:04d}.npz"))]
    assert empty == frames


def test_times_of_a_raw_stream_are_made_from_its_rate_or_the_one_told(tmp_path: Path) -> None:
    facts = stages(tmp_path, "raw.h264", "k96.json")
    (flag,) = facts["probe"]["flags"]
    assert (flag["code"], flag["severity"]) == ("times_made_up", "info")
    assert flag["where"] == "12 frames/s, as the stream's header states"
    found = json.loads((tmp_path / "results" / "annotations" / "detections.json").read_text("utf-8"))
    assert [row["source_index"] for row in found] == [i if i < 48 else None for i in range(96)]
    (told,) = stages(tmp_path / "told", "raw.h264", input__fps=24)["probe"]["flags"]
    assert told["where"] == "24 frames/s, as told"


def test_a_folder_of_pictures_goes_through_the_stages(tmp_path: Path) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    with av.open(str(INPUTS / "kvz.mp4")) as container:
        for number, frame in enumerate(container.decode(video=0)):
            Image.fromarray(frame.to_ndarray(format="rgb24")).save(folder / f"{number}.png")
    (tmp_path / "a.json").write_text(json.dumps({"0.5": DETECTION, "2.0": DETECTION}), encoding="utf-8")
    facts = stages(tmp_path, str(folder), str(tmp_path / "a.json"), input__fps=12)
    (flag,) = facts["probe"]["flags"]
    assert (flag["code"], flag["severity"]) == ("times_made_up", "info")
    assert facts["frames"]["n_frames"] == 48
    found = json.loads((tmp_path / "results" / "annotations" / "detections.json").read_text("utf-8"))
    assert [row["source_index"] for row in found] == [6, 24]
    sha = [row["sha256"] for row in exported(tmp_path)]
    stages(tmp_path / "film", "kvz.mp4")
    assert sha == [row["sha256"] for row in exported(tmp_path / "film")]


def test_large_pictures_are_refused_from_the_header(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="8192x8192") as caught:
        stages(tmp_path, "big180.mp4")
    assert caught.value.code == "too_many_pixels"


def test_the_result_names_the_stream_and_takes_another_when_told(tmp_path: Path) -> None:
    (flag,) = stages(tmp_path, "twov.mp4")["probe"]["flags"]
    assert flag["where"] == ("stream 1 of: stream 0 (mjpeg, 160x120, 4 frames); stream 1 (h264, 480x360, 48 frames)")
    told = stages(tmp_path / "told", "twov.mp4", input__video_stream=0, roi__y1=1)
    assert (told["probe"]["width"], told["frames"]["n_frames"]) == (160, 4)


def test_keys_of_a_joined_recording_find_their_frames(tmp_path: Path) -> None:
    facts = stages(tmp_path, "concat_disc.ts", "k96.json")
    assert facts["annotations"]["n_without_frame"] == 0
    (flag,) = facts["probe"]["flags"]
    assert (flag["code"], flag["severity"], flag["where"]) == ("recording_joined", "info", "frame 48")
    found = json.loads((tmp_path / "results" / "annotations" / "detections.json").read_text("utf-8"))
    assert [row["source_index"] for row in found] == [round(Fraction(row["key"]) * 12) for row in found]
    table = FrameTable.read(tmp_path / "results" / "probe")
    assert [round(row.time_s * 12) for row in table.rows] == list(range(96))


def test_facts_and_files_name_the_same_part_of_the_picture(tmp_path: Path) -> None:
    facts = stages(tmp_path, "kvz.mp4", roi__x0=0.1, roi__y0=0.2, roi__x1=0.9, roi__y1=0.75)
    assert facts["frames"]["crop"] == [48, 72, 432, 270]
    assert (facts["frames"]["source_width"], facts["frames"]["source_height"]) == (480, 360)
    crop = json.loads((tmp_path / "results" / "frames" / "crop.json").read_text("utf-8"))
    assert [crop[name] for name in ("x0", "y0", "x1", "y1")] == facts["frames"]["crop"]


@pytest.mark.parametrize("video", ["d_x265_rand.mp4", "d_x264g12_rand.mp4"])
def test_lost_frames_refuse_the_video_until_it_is_allowed_and_are_named_then(video: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"4 frames lost after frame 18 at 1\.500 s"):
        stages(tmp_path, video)
    facts = stages(tmp_path / "allowed", video, input__allow_truncated=True)
    (flag,) = facts["probe"]["flags"]
    assert flag["code"] == "truncated_video"
    assert flag["where"].startswith("4 frames lost after frame 18")
    assert facts["frames"]["n_frames"] == 44
