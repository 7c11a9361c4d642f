"""What `probe` and `check` say of small files of kinds that went wrong."""

from __future__ import annotations

import json
from itertools import islice
from pathlib import Path
from typing import Any

import av
import pytest
from PIL import Image

from cli.main import main
from tests.core.making_videos import picture
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow


def said(capsys: pytest.CaptureFixture[str], *words: str, expect: int = 0) -> str:
    code = main([str(INPUTS / word) if (INPUTS / word).is_file() else word for word in words])
    captured = capsys.readouterr()
    assert code == expect, captured.err
    return captured.out if expect == 0 else captured.err


def as_json(capsys: pytest.CaptureFixture[str], *words: str) -> dict[str, Any]:
    found = json.loads(said(capsys, *words, "--json"))
    assert isinstance(found, dict)
    return found


@pytest.mark.parametrize(
    ("video", "frames", "seconds", "notes"),
    [
        ("afirst.mp4", 48, 4.0, []),
        ("kvz.mp4", 48, 4.0, []),
        ("twov.mp4", 48, 4.0, ["stream 1 was read of stream 0 (mjpeg, 160x120, 4 frames); stream 1 (h264, 480x360"]),
        ("cover_noflag.mp4", 48, 4.0, ["stream 1 was read of stream 0 (mjpeg, 480x360, 1 frame); stream 1 (h264"]),
        ("concat_disc.ts", 96, 8.0, ["joined from 2 recordings, at frame 48"]),
        ("d_x265_rand.mp4", 44, 4.0, ["damaged: 4 frames lost after frame 18 at 1.500 s"]),
        ("d_x264g12_rand.mp4", 44, 4.0, ["damaged: 4 frames lost after frame 18 at 1.500 s"]),
        ("s360_sar43.mp4", 96, 8.0, ["pixels are not square (4:3); frames are resampled"]),
        ("raw.h264", 48, 4.0, ["they are made from 12 frames/s, as the stream's header states"]),
        ("mjpeg_half.avi", 48, 4.0, ["damaged pictures: frame 20, 21, 22, 23, 24; they give no keypoints"]),
        ("corrupt_mid.avi", 48, 4.0, ["damaged pictures: frame 23; they give no keypoints"]),
    ],
)
def test_probe_says_what_the_film_is_and_what_is_odd(
    video: str, frames: int, seconds: float, notes: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    found = as_json(capsys, "probe", video)
    assert (found["n_frames"], found["duration_s"], found["average_rate"]) == (frames, seconds, "12/1")
    assert (found["width"], found["height"]) == (480, 360)
    text = said(capsys, "probe", video)
    assert text.count("\n") == 3 + len(notes)
    assert all(note in text for note in notes)


def test_probe_and_check_say_that_a_film_is_interlaced(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    found = as_json(capsys, "probe", "s480i.mp4")
    assert (found["n_frames"], found["average_rate"], found["interlaced_frames"]) == (48, "6/1", 48)
    assert "interlaced: 48 of 48 frames; they are deinterlaced" in said(capsys, "probe", "s480i.mp4")
    (tmp_path / "a.json").write_text('{"0.5": {}, "1.0": {}}', encoding="utf-8")
    assert "video: interlaced: 48 of 48 frames" in said(capsys, "check", str(tmp_path / "a.json"), "s480i.mp4")


def beginning(video: Path, frames: int, to: Path) -> Path:
    """The first frames of a film whose pictures are coded in the order in which they are shown, as they are coded."""
    with av.open(str(video)) as whole, av.open(str(to), "w") as cut:
        film = whole.streams.video[0]
        copy = cut.add_stream_from_template(film)
        for packet in islice(whole.demux(film), frames):
            packet.stream = copy
            cut.mux(packet)
    return to


@pytest.mark.parametrize(
    ("video", "frames", "rate"),
    [("gpb1080.mp4", 60, "30 frames/s"), ("m96.avi", 96, "12 frames/s"), ("m96_drop15.avi", 90, "frames/s")],
)
def test_probe_has_nothing_to_say_of_ordinary_films(
    video: str, frames: int, rate: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    if video == "gpb1080.mp4":  # all its 900 frames of 1080p take a quarter of a minute to decode
        video = str(beginning(INPUTS / video, frames, tmp_path / video))
    text = said(capsys, "probe", video)
    assert text.splitlines()[0].endswith(f", {frames} frames")
    assert f" {rate} on average\n" in text
    assert text.count("\n") == 3


def test_a_rate_can_be_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert as_json(capsys, "probe", "raw.h264", "--fps", "24")["average_rate"] == "24/1"
    assert "12 frames/s, as told" in said(capsys, "check", "k96.json", "raw.h264", "--fps", "12")
    assert as_json(capsys, "check", "k96.json", "raw.h264", "--set", "input.fps=12")["video"]["times_from"] == "given"
    assert "holds the times of its frames" in said(capsys, "probe", "m96.avi", "--fps", "24", expect=2)
    assert "input.fps" in said(capsys, "probe", "raw.h264", "--fps", "0", expect=2)


def test_pictures_are_probed_and_checked(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    folder = tmp_path / "pictures"
    folder.mkdir()
    for number in range(8, 12):
        Image.fromarray(picture(number)).save(folder / f"{number}.png")
    (tmp_path / "a.json").write_text('{"0": {}, "1": {}, "3": {}}', encoding="utf-8")
    assert "(--fps N, input.fps)" in said(capsys, "probe", str(folder), expect=2)
    assert "pictures: 160x128, png, 4 frames" in said(capsys, "probe", str(folder), "--fps", "2")
    assert as_json(capsys, "probe", str(folder / "%d.png"), "--fps", "2")["duration_s"] == 2.0
    read = as_json(capsys, "check", str(tmp_path / "a.json"), str(folder), "--fps", "2")
    assert read["video"]["n_frames"] == 4


def test_probe_refuses_large_pictures_by_their_header(capsys: pytest.CaptureFixture[str]) -> None:
    assert "8192x8192 = 67,108,864 pixels; at most 40,000,000 are read" in said(capsys, "probe", "big180.mp4", expect=2)


def test_probe_reads_another_stream_when_told(capsys: pytest.CaptureFixture[str]) -> None:
    assert "160x120, mjpeg, 4 frames" in said(capsys, "probe", "twov.mp4", "--stream", "0")
    assert "has no video stream 7" in said(capsys, "probe", "twov.mp4", "--stream", "7", expect=2)


@pytest.mark.parametrize(
    ("annotations", "video", "note"),
    [
        ("k96.json", "concat_disc.ts", "video: joined from 2 recordings, at frame 48"),
        ("nulldet.json", "twov.mp4", "video: stream 1 was read of"),
        ("nulldet.json", "cover_noflag.mp4", "video: stream 1 was read of"),
        ("nulldet.json", "d_x265_rand.mp4", "video: damaged: 4 frames lost after frame 18"),
        ("nulldet.json", "s360_sar43.mp4", "video: pixels are not square (4:3)"),
        ("k96.json", "raw.h264", "video: the file holds no times; they are made from 12 frames/s"),
        ("nulldet.json", "mjpeg_half.avi", "video: damaged pictures: frame 20, 21, 22, 23, 24"),
        ("nulldet.json", "corrupt_mid.avi", "video: damaged pictures: frame 23"),
    ],
)
def test_check_says_what_is_odd_of_the_video_too(
    annotations: str, video: str, note: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert note in said(capsys, "check", annotations, video)
    found = as_json(capsys, "check", annotations, video)["video"]
    assert found["joined"] == ([48] if video == "concat_disc.ts" else [])
    assert bool(found["damage"]) == video.startswith("d_")


def test_check_finds_every_key_of_a_joined_recording(capsys: pytest.CaptureFixture[str]) -> None:
    found = as_json(capsys, "check", "k96.json", "concat_disc.ts")
    assert (found["n_keys"], found["n_keys_outside_video"]) == (96, 0)
    read = found["time_convention"]
    assert (read["clock"], read["strays"], read["frames_hit"]) == ("pts", 0, 96)
    assert (read["last"]["source_index"], read["last"]["key"]) == (95, "7.916667")


def test_check_takes_the_stream_that_a_run_would_take(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"0.0": {}, "1.0": {}}', encoding="utf-8")
    told = as_json(capsys, "check", str(tmp_path / "a.json"), "twov.mp4", "--set", "input.video_stream=0")
    assert (told["video"]["n_frames"], told["time_convention"]["frames_hit"]) == (4, 2)
