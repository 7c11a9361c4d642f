"""What `probe` and `check` say of small files of kinds that went wrong."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cli.main import main
from tests.inputs import INPUTS


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
    ],
)
def test_probe_says_what_the_film_is_and_what_is_odd(video, frames, seconds, notes, capsys):
    found = as_json(capsys, "probe", video)
    assert (found["n_frames"], found["duration_s"], found["average_rate"]) == (frames, seconds, "12/1")
    assert (found["width"], found["height"]) == (480, 360)
    text = said(capsys, "probe", video)
    assert text.count("\n") == 3 + len(notes)
    assert all(note in text for note in notes)


def test_probe_refuses_large_pictures_by_their_header(capsys):
    assert "8192x8192 = 67,108,864 pixels; at most 40,000,000 are read" in said(capsys, "probe", "big180.mp4", expect=2)


def test_probe_reads_another_stream_when_told(capsys):
    assert "160x120, mjpeg, 4 frames" in said(capsys, "probe", "twov.mp4", "--stream", "0")
    assert "has no video stream 7" in said(capsys, "probe", "twov.mp4", "--stream", "7", expect=2)


@pytest.mark.parametrize(
    ("annotations", "video", "note"),
    [
        ("k96.json", "concat_disc.ts", "video: joined from 2 recordings, at frame 48"),
        ("nulldet.json", "twov.mp4", "video: stream 1 was read of"),
        ("nulldet.json", "cover_noflag.mp4", "video: stream 1 was read of"),
        ("nulldet.json", "d_x265_rand.mp4", "video: damaged: 4 frames lost after frame 18"),
    ],
)
def test_check_says_what_is_odd_of_the_video_too(annotations, video, note, capsys):
    assert note in said(capsys, "check", annotations, video)
    found = as_json(capsys, "check", annotations, video)["video"]
    assert found["joined"] == ([48] if video == "concat_disc.ts" else [])
    assert bool(found["damage"]) == video.startswith("d_")


def test_check_finds_every_key_of_a_joined_recording(capsys):
    found = as_json(capsys, "check", "k96.json", "concat_disc.ts")
    assert (found["n_keys"], found["n_keys_outside_video"]) == (96, 0)
    read = found["time_convention"]
    assert (read["clock"], read["strays"], read["frames_hit"]) == ("pts", 0, 96)
    assert (read["last"]["source_index"], read["last"]["key"]) == (95, "7.916667")


def test_check_takes_the_stream_that_a_run_would_take(capsys, tmp_path: Path):
    (tmp_path / "a.json").write_text('{"0.0": {}, "1.0": {}}', encoding="utf-8")
    told = as_json(capsys, "check", str(tmp_path / "a.json"), "twov.mp4", "--set", "input.video_stream=0")
    assert (told["video"]["n_frames"], told["time_convention"]["frames_hit"]) == (4, 2)
