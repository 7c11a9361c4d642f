"""`bladeatlas convert`, and other tools' files and folders in `check` and `run`'s early look."""

from __future__ import annotations

import json
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from cli.input_files import annotation_file
from cli.main import main
from core.annotations.load import load_annotations
from core.annotations.placed import place
from core.video.probe import probe_video
from core.video.table import FrameTable
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
FOREIGN = INPUTS / "foreign"
VIDEO = ROOT / "samples" / "turbine.mp4"
SAMPLE = ROOT / "samples" / "turbine.json"


def called(capsys: pytest.CaptureFixture[str], *words: str | Path, expect: int = 0) -> str:
    code = main([str(word) for word in words])
    captured = capsys.readouterr()
    assert code == expect, captured.err
    return captured.out if expect == 0 else captured.err


@cache
def _sample() -> FrameTable:
    """Frames of the sample, decoded once for all tests."""
    return probe_video(VIDEO)


def placed_of(path: Path) -> list[Any]:
    """What matters of every detection, and the frames looked at."""
    table = _sample()
    placed = place(load_annotations(path, (table.info.width, table.info.height)), table)
    rows = [(d.source_index, d.label, d.score, d.box, d.polygon, d.track_id) for d in placed.detections]
    return [*rows, placed.looked_at, dict(sorted(placed.masks.items()))]


@pytest.mark.parametrize(
    "name",
    [
        "coco.json",
        "cvat_export.zip",
        "labelstudio.json",
        "supervisely.json",
        "via3.json",
        "roboflow_video.json",
        "tools/datumaro.json",
        "tools/datumaro_yolo.zip",
        "tools/label_studio_video.json",
    ],
)
def test_what_is_converted_with_the_video_reads_the_same(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "annotations.json"
    said = called(capsys, "convert", FOREIGN / name, VIDEO, "--out", out)
    assert said.startswith(f"{out}: ")
    assert placed_of(out) == placed_of(FOREIGN / name)
    assert load_annotations(out).format == "bladeatlas"


def test_our_own_form_is_converted_to_itself(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for video in ([], [VIDEO]):
        called(capsys, "convert", SAMPLE, *video, "--out", tmp_path / "own.json")
        assert placed_of(tmp_path / "own.json") == placed_of(SAMPLE)


def test_frame_numbers_need_the_video(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    said = called(capsys, "convert", FOREIGN / "labelme.json", "--out", tmp_path / "a.json", expect=2)
    assert "name frames by their numbers" in said
    assert not list(tmp_path.iterdir())
    missing = tmp_path / "no" / "a.json"
    assert "cannot be written" in called(capsys, "convert", SAMPLE, "--out", missing, expect=2)


def test_check_says_the_format_and_what_is_not_read(capsys: pytest.CaptureFixture[str]) -> None:
    said = called(capsys, "check", FOREIGN / "tools" / "labelme_frame_0003.json", VIDEO)
    assert "  format: labelme\n" in said
    assert "  warning: 1 circle is not read\n" in said
    found = json.loads(called(capsys, "check", FOREIGN / "coco.json", VIDEO, "--json"))
    assert (found["format"], found["n_detections"]) == ("coco", 1)


def test_a_folder_is_read_by_check_as_its_zip_is(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with zipfile.ZipFile(FOREIGN / "tools" / "supervision_yolo.zip") as archive:
        archive.extractall(tmp_path / "yolo")
    found = json.loads(called(capsys, "check", tmp_path / "yolo", VIDEO, "--json"))
    zipped = json.loads(called(capsys, "check", FOREIGN / "tools" / "supervision_yolo.zip", VIDEO, "--json"))
    assert found == zipped
    assert (found["format"], found["n_detections"], found["n_keys"]) == ("yolo", 14, 12)
    with annotation_file(tmp_path / "yolo") as packed:
        kept = packed
        assert kept.is_file()
    assert not kept.exists()


def test_the_format_can_be_forced(capsys: pytest.CaptureFixture[str]) -> None:
    assert "seems to be COCO" in called(capsys, "check", FOREIGN / "coco.json", VIDEO, "--format", "via", expect=2)
    assert "format: coco" in called(capsys, "check", FOREIGN / "coco.json", VIDEO, "--format", "coco")
    commands: list[list[str | Path]] = [
        ["check", FOREIGN / "coco.json"],
        ["run", VIDEO, SAMPLE, "--out", "x"],
        ["submit", VIDEO, SAMPLE],
    ]
    for words in commands:
        said = called(capsys, *words, "--format", "coca", expect=2)
        assert "input.annotation_format" in said


def test_run_refuses_what_check_refuses(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    results = FOREIGN / "coco_results.json"
    assert "results of COCO alone" in called(capsys, "run", VIDEO, results, "--out", tmp_path / "out", expect=2)
    assert "wrong order" in called(capsys, "run", SAMPLE, VIDEO, "--out", tmp_path / "out", expect=2)
    assert "wrong order" in called(capsys, "check", VIDEO, SAMPLE, expect=2)
