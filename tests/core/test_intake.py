"""The early look at an input, in the caller's process and in one with limits."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from core.intake import LimitFields, answer
from core.video.decode import DecodedFrame, VideoReader
from tests.damage import damaged_videos
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[2]
VIDEO = ROOT / "samples" / "turbine.mp4"
ANNOTATIONS = ROOT / "samples" / "turbine.json"
FULL = {"x0": 0.0, "y0": 0.0, "x1": 1.0, "y1": 1.0}


def test_a_sound_input_is_described() -> None:
    found = answer({"recordings": [{"video": str(VIDEO), "annotations": str(ANNOTATIONS)}], "roi": FULL})
    assert (found["videos"][0]["width"], found["videos"][0]["height"], found["videos"][0]["codec"]) == (
        960,
        720,
        "h264",
    )
    assert found["n_detections"] == 90


@pytest.mark.parametrize(
    ("change", "code"),
    [
        ({"video": str(ROOT / "README.md")}, "not_a_video"),
        ({"video": str(ROOT / "missing")}, "missing_file"),
        ({"annotations": str(ROOT / "README.md")}, "annotations_malformed"),
        ({"roi": {**FULL, "x1": 0.0}}, "roi_empty"),
        ({"roi": {**FULL, "x1": 0.01}}, "roi_too_small"),
    ],
)
def test_what_is_wrong_is_named(change: dict[str, Any], code: str) -> None:
    recording = {"video": str(VIDEO), "annotations": None, **{k: v for k, v in change.items() if k != "roi"}}
    question: Any = {"recordings": [recording], "roi": change.get("roi", FULL)}
    found = answer(question)
    assert found["error"]["code"] == code


BIG = INPUTS / "big180.mp4"


@pytest.mark.parametrize(
    ("video", "limits", "code"),
    [
        (BIG, {}, "too_many_pixels"),
        (VIDEO, {"max_frame_pixels": 960 * 720 - 1}, "too_many_pixels"),
        (VIDEO, {"max_video_frames": 95}, "too_many_frames"),
        (VIDEO, {"max_video_seconds": 7.9}, "too_long"),
    ],
)
def test_a_header_beyond_a_limit_is_enough(
    video: Path, limits: LimitFields, code: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def decode(_: VideoReader) -> None:
        pytest.fail("a frame was decoded")

    monkeypatch.setattr(VideoReader, "frames", decode)
    found = answer({"recordings": [{"video": str(video), "annotations": None}], "roi": FULL, "limits": limits})
    assert found["error"]["code"] == code
    message = str(found["error"]["message"])
    assert "at most" in message or "more than" in message


def test_a_video_at_its_limits_is_taken() -> None:
    limits: LimitFields = {"max_frame_pixels": 960 * 720, "max_video_frames": 96, "max_video_seconds": 8.0}
    found = answer({"recordings": [{"video": str(VIDEO), "annotations": None}], "roi": FULL, "limits": limits})
    assert found["videos"][0]["declared_frames"] == 96


def test_only_the_first_frames_are_decoded(monkeypatch: pytest.MonkeyPatch) -> None:
    """However long the film is."""
    seen: list[int] = []
    frames = VideoReader.frames

    def counted(reader: VideoReader) -> Iterator[DecodedFrame]:
        for frame in frames(reader):
            seen.append(frame.index)
            yield frame

    monkeypatch.setattr(VideoReader, "frames", counted)
    answer({"recordings": [{"video": str(VIDEO), "annotations": None}], "roi": FULL})
    assert seen == [0, 1]


def ask(**change: Any) -> subprocess.CompletedProcess[str]:
    recording = {"video": str(VIDEO), "annotations": None}
    question: dict[str, Any] = {"recordings": [recording], "roi": FULL, "parent": os.getpid()}
    question |= {"memory_bytes": 2 << 30, "seconds": 30, **change}
    words = [sys.executable, "-m", "core.intake"]
    return subprocess.run(words, input=json.dumps(question), capture_output=True, text=True, check=False, cwd=ROOT)


def test_a_process_of_its_own_answers() -> None:
    done = ask()
    assert done.returncode == 0
    assert json.loads(done.stdout)["videos"][0]["width"] == 960


def test_its_memory_is_limited() -> None:
    done = ask(memory_bytes=16 << 20)
    assert "width" not in done.stdout


def test_it_does_not_outlive_who_asked() -> None:
    done = ask(parent=1)
    assert (done.returncode, done.stdout) == (1, "")


FORKS = """\
import json, os, sys
from core import intake

for line in sys.stdin:
    question = json.loads(line)
    child = os.fork()
    if child == 0:
        intake.limit_process(os.getppid(), question["memory_bytes"], question["seconds"])
        print(json.dumps(intake.answer(question)), flush=True)
        os._exit(0)
    print(json.dumps(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])), flush=True)
"""
"""Answers questions as the module does, each in a process with its limits, but loads the libraries once for all."""


def test_damaged_videos_are_answered_or_end_their_process(tmp_path: Path) -> None:
    """Headers of containers and of the streams in them, through the real decoder."""
    paths = [tmp_path / f"{count}.mp4" for count in range(100)]
    questions = []
    for path, video in zip(paths, damaged_videos(tmp_path, len(paths)), strict=True):
        path.write_bytes(video)
        recording = {"video": str(path), "annotations": None}
        questions.append({"recordings": [recording], "roi": FULL, "memory_bytes": 4 << 30, "seconds": 20.0})
    asked = "".join(json.dumps(question) + "\n" for question in questions)
    run = subprocess.run(
        [sys.executable, "-c", FORKS], input=asked, capture_output=True, text=True, cwd=ROOT, check=True
    )
    said = [json.loads(line) for line in run.stdout.splitlines()]
    answers, codes = [one for one in said if isinstance(one, dict)], [one for one in said if isinstance(one, int)]
    assert len(codes) == len(paths)
    assert len(answers) == codes.count(0)
    assert max(codes) == 0, "a decoder may crash, which is a signal; the look itself may not fail"
    errors = [found["error"] for found in answers if "error" in found]
    assert 20 < len(errors) < len(answers)
    assert all(error["code"] and error["kind"] == "BadInput" for error in errors)
    assert sorted(tmp_path.iterdir()) == sorted(paths)
