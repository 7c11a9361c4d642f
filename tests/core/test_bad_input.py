"""Bad input, all in one table: each ends in one error whose code and sentence name the cause."""

from __future__ import annotations

import importlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from core.errors import BadInput
from core.settings import make_settings
from core.stage import StageTask
from core.videos import Recording
from tests.core.making_videos import cut_to, every_ms, make_video, make_wav

DENT = {"label": "dent", "score": 0.5, "bbox": [0.2, 0.2, 0.4, 0.4]}
FULL = {"roi.x0": 0, "roi.y0": 0, "roi.x1": 1, "roi.y1": 1}


def run_stages(folder: Path, video: Path, annotations: Path | None, options: dict[str, Any]) -> dict[str, Any]:
    """Facts of the stages that read the user's input."""
    inputs: dict[str, Path] = {}
    facts: dict[str, Any] = {}
    settings = make_settings("default", {**FULL, **options})
    for name in ("probe", "annotations", "frames"):
        out = folder / "results" / name
        out.mkdir(parents=True)
        task = StageTask(name, {}, settings, dict(inputs), dict(facts), (Recording(video, annotations),), out)
        facts[name] = importlib.import_module(f"core.stages.{name}").run(task).facts
        inputs[name] = out
    return facts


@pytest.fixture(scope="module")
def good_video(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return make_video(tmp_path_factory.mktemp("good") / "good.mp4", every_ms(40, 50))


def text_as(name: str, text: bytes) -> Callable[[Path, Path], Path]:
    def make(folder: Path, good: Path) -> Path:
        (folder / name).write_bytes(text)
        return folder / name

    return make


def folder_as_video(folder: Path, good: Path) -> Path:
    (folder / "videos").mkdir()
    return folder / "videos"


VIDEOS: list[tuple[str, Callable[[Path, Path], Path], str, str]] = [
    ("missing", lambda folder, good: folder / "no.mp4", "missing_file", "video file 'no.mp4' does not exist"),
    ("folder", folder_as_video, "not_a_file", "the video 'videos' is a directory"),
    ("empty", text_as("empty.mp4", b""), "empty_file", "video file 'empty.mp4' is empty"),
    ("text", text_as("notes.txt", b"hello\n" * 400), "not_a_video", "'notes.txt' is not a video"),
    ("noise", text_as("noise.mp4", bytes(range(256)) * 40), "not_a_video", "'noise.mp4' is not a video"),
    ("playlist", text_as("list.m3u8", b"#EXTM3U\n#EXTINF:1,\n/etc/passwd\n"), "not_a_video", "is not a video"),
    ("audio", lambda folder, good: make_wav(folder / "a.wav"), "audio_only", "'a.wav' holds only audio"),
    ("one frame", lambda folder, good: make_video(folder / "1.mp4", [0]), "single_frame", "'1.mp4' holds only one"),
    ("no frame", lambda folder, good: make_video(folder / "0.avi", []), "no_frames", "'0.avi' holds no frame"),
    (
        "truncated",
        lambda folder, good: cut_to(
            make_video(folder / "all.mp4", every_ms(40, 50), options={"movflags": "faststart"}),
            0.6,
            folder / "cut.mp4",
        ),
        "truncated_video",
        "'cut.mp4' is truncated or damaged",
    ),
    (
        "index missing",
        lambda folder, good: cut_to(good, 0.6, folder / "half.mp4"),
        "not_a_video",
        "'half.mp4' .* index is missing",
    ),
]


@pytest.mark.parametrize(("make", "code", "cause"), [row[1:] for row in VIDEOS], ids=[row[0] for row in VIDEOS])
def test_bad_video(tmp_path: Path, good_video: Path, make: Callable[[Path, Path], Path], code: str, cause: str) -> None:
    with pytest.raises(BadInput, match=cause) as caught:
        run_stages(tmp_path, make(tmp_path, good_video), None, {})
    assert caught.value.code == code
    assert caught.value.where
    assert str(tmp_path) not in caught.value.message


OPTIONS: list[tuple[str, dict[str, Any], str, str]] = [
    ("interval outside", {"frames.clip_start_s": 2.5}, "interval_outside", "clip_start_s = 2.5 s lies outside"),
    ("interval too long", {"frames.clip_end_s": 9}, "interval_outside", "clip_end_s = 9 s lies outside the video"),
    ("interval inverted", {"frames.clip_start_s": 1, "frames.clip_end_s": 0.5}, "interval_empty", "1 to 0.5 s"),
    ("roi empty", {"roi.x0": 0.6, "roi.x1": 0.4}, "roi_empty", r"\(0.6, 0, 0.4, 1\) is empty"),
    ("roi outside", {"roi.y1": 1.5}, "bad_input", r"option 'roi.y1': .* less than or equal to 1"),
    ("roi too small", {"roi.x0": 0.7}, "roi_too_small", "48x128 px of a 160x128 px frame"),
]


@pytest.mark.parametrize(("options", "code", "cause"), [row[1:] for row in OPTIONS], ids=[row[0] for row in OPTIONS])
def test_bad_parameters(tmp_path: Path, good_video: Path, options: dict[str, Any], code: str, cause: str) -> None:
    with pytest.raises(BadInput, match=cause) as caught:
        run_stages(tmp_path, good_video, None, options)
    assert caught.value.code == code


def at(key: str, **changes: Any) -> bytes:
    """An annotation file with one detection at `key`, changed."""
    return json.dumps({key: {"detections": [{**DENT, **changes}]}}).encode()


@dataclass(frozen=True)
class BadAnnotation:
    name: str
    data: bytes = field(repr=False)
    code: str
    cause: str


BOX = r'"1\.2"\.detections\[0\]\.bbox'
ANNOTATIONS = [
    BadAnnotation("empty", b"", "empty_file", "annotation file 'a.json' is empty"),
    BadAnnotation("malformed", b'{\n "1.2": [}', "annotations_malformed", "line 2, column 10"),
    BadAnnotation("cut off", at("1.2")[:-9], "annotations_malformed", "not valid JSON: .* at line 1"),
    BadAnnotation("not text", b"\xff\xfe{\x00}\x00", "annotations_not_utf8", "not UTF-8"),
    BadAnnotation("too deep", b"[" * 200_000, "annotations_malformed", "nested too deeply"),
    BadAnnotation("long number", b"[" + b"1" * 9000 + b"]", "annotations_malformed", "thousands of digits"),
    BadAnnotation("top level", b"[1, 2]", "annotations_unknown_format", "seem to be a JSON list of another kind"),
    BadAnnotation("duplicate key", b'{"1.2": {}, "1.2": {}}', "duplicate_key", 'key "1.2" occurs twice'),
    BadAnnotation("entry type", b'{"1.2": 5}', "annotations_invalid", '"1.2" must be an object, not 5'),
    BadAnnotation(
        "list type", b'{"1.2": {"detections": {}}}', "annotations_invalid", r'"1.2".detections must be a list'
    ),
    BadAnnotation("no label", at("1.2", label=None), "annotations_invalid", r"detections\[0\]\.label must be a text"),
    BadAnnotation("no box", at("1.2", bbox=None), "annotations_invalid", f"{BOX} must be a list, not null"),
    BadAnnotation("box type", at("1.2", bbox=[0, 0, "1", 1]), "annotations_invalid", rf'{BOX}\[2\] .* not "1"'),
    BadAnnotation("box bool", at("1.2", bbox=[0, 0, True, 1]), "annotations_invalid", rf"{BOX}\[2\] .* not true"),
    BadAnnotation("box length", at("1.2", bbox=[0, 0, 1]), "annotations_invalid", f"{BOX} must be .* not 3 values"),
    BadAnnotation("NaN", at("1.2", bbox=[0, 0, float("nan"), 1]), "not_finite", rf"{BOX}\[2\] is NaN"),
    BadAnnotation("infinity", at("1.2", score=float("inf")), "not_finite", r"score is infinite"),
    BadAnnotation("box outside", at("1.2", bbox=[0.2, 0.2, 1.2, 0.4]), "box_outside", rf"{BOX}\[2\] is 1.2, outside"),
    BadAnnotation("box negative", at("1.2", bbox=[-0.1, 0, 1, 1]), "box_outside", rf"{BOX}\[0\] is -0.1, outside"),
    BadAnnotation("box in px", at("1.2", bbox=[20, 30, 90, 80]), "box_outside", "pixels"),
    BadAnnotation("box inverted", at("1.2", bbox=[0.4, 0.2, 0.2, 0.4]), "box_inverted", f"{BOX} is .*inverted"),
    BadAnnotation("score", at("1.2", score=1.5), "bad_score", r"score is 1.5, outside \[0, 1\]"),
    BadAnnotation("polygon", at("1.2", polygon=[[0, 2], [1, 1], [0, 1]]), "polygon_outside", r"polygon\[0\]\[1\] is 2"),
    BadAnnotation("track", at("1.2", track_id=1.5), "annotations_invalid", "track_id must be"),
    BadAnnotation("not a time", at("frame 3"), "bad_time", 'key "frame 3" is not a time'),
    BadAnnotation("negative time", at("-1.5"), "bad_time", 'key "-1.5" is a negative time'),
    BadAnnotation("beyond the video", at("99.0"), "annotations_beyond_video", "belong to another video: 1 of 1"),
]


@pytest.mark.parametrize("bad", ANNOTATIONS, ids=[bad.name for bad in ANNOTATIONS])
def test_bad_annotations(tmp_path: Path, good_video: Path, bad: BadAnnotation) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(bad.data)
    with pytest.raises(BadInput, match=bad.cause) as caught:
        run_stages(tmp_path, good_video, path, {})
    assert caught.value.code == bad.code
    assert caught.value.where


def test_100_mb_of_annotations_are_refused(tmp_path: Path, good_video: Path) -> None:
    path = tmp_path / "huge.json"
    with path.open("wb") as stream:
        stream.truncate(100_000_000)
    with pytest.raises(BadInput, match=r"'huge\.json' has 100 MB; at most 67 MB") as caught:
        run_stages(tmp_path, good_video, path, {})
    assert caught.value.code == "annotations_too_large"


def test_good_input_next_to_the_bad(tmp_path: Path, good_video: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(at("1.2"))
    facts = run_stages(tmp_path, good_video, path, {"frames.count": 10})
    assert facts["probe"]["n_frames"] == 50
    assert facts["annotations"]["n_detections"] == 1
    assert (facts["frames"]["n_frames"], facts["frames"]["n_search"]) == (11, 11)
    assert facts["frames"]["crop"] == [0, 0, 160, 128]
    frames = json.loads((tmp_path / "results/frames/frames.json").read_text())
    assert [f["role"] for f in frames if f["source_index"] == 30] == ["annotated"]
    assert sorted(p.name for p in (tmp_path / "results/frames/images").iterdir())[-1] == "0010.jpg"
    table = (tmp_path / "results/probe/table.csv").read_text().splitlines()
    assert table[0] == "index,pts,time_s,keyframe,sha256"
    assert all(table[1 + f["source_index"]].endswith(f["sha256"]) for f in frames)


def test_the_decodable_part_is_used_on_request(tmp_path: Path) -> None:
    whole = make_video(tmp_path / "all.mp4", every_ms(40, 50), options={"movflags": "faststart"})
    cut = cut_to(whole, 0.6, tmp_path / "cut.mp4")
    facts = run_stages(tmp_path, cut, None, {"input.allow_truncated": True})
    assert facts["probe"]["truncated"] is True
    assert [flag["code"] for flag in facts["probe"]["flags"]] == ["truncated_video"]
    assert 10 < facts["frames"]["n_frames"] == facts["probe"]["n_frames"] < 50
