"""The early look at an input, in the caller's process and in one with limits."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from core.intake import answer

ROOT = Path(__file__).parents[2]
VIDEO = ROOT / "samples" / "turbine.mp4"
ANNOTATIONS = ROOT / "samples" / "turbine.json"
FULL = {"x0": 0.0, "y0": 0.0, "x1": 1.0, "y1": 1.0}


def test_a_sound_input_is_described() -> None:
    found = answer({"video": str(VIDEO), "annotations": str(ANNOTATIONS), "roi": FULL})
    assert (found["video"]["width"], found["video"]["height"], found["video"]["codec"]) == (960, 720, "h264")
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
    found = answer({"video": str(VIDEO), "annotations": None, "roi": FULL, **change})
    assert found["error"]["code"] == code


def ask(**change: Any) -> subprocess.CompletedProcess[str]:
    question: dict[str, Any] = {"video": str(VIDEO), "annotations": None, "roi": FULL, "parent": os.getpid()}
    question |= {"memory_bytes": 2 << 30, "seconds": 30, **change}
    words = [sys.executable, "-m", "core.intake"]
    return subprocess.run(words, input=json.dumps(question), capture_output=True, text=True, check=False, cwd=ROOT)


def test_a_process_of_its_own_answers() -> None:
    done = ask()
    assert done.returncode == 0
    assert json.loads(done.stdout)["video"]["width"] == 960


def test_its_memory_is_limited() -> None:
    done = ask(memory_bytes=16 << 20)
    assert "width" not in done.stdout


def test_it_does_not_outlive_who_asked() -> None:
    done = ask(parent=1)
    assert (done.returncode, done.stdout) == (1, "")
