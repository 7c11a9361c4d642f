"""Stages `probe`, `annotations` and `frames` over two videos: each on its own clock, frames numbered over both."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from core.annotations.model import Annotations
from core.errors import BadInput
from core.intake import check_input
from core.io.annotations import read_detections, read_looked_at, read_masks
from core.io.frames import image_path, read_frames
from core.scene.frame import SourceFrame
from core.settings import make_settings
from core.stage import StageTask
from core.stages import annotations as annotations_stage
from core.stages import frames, probe
from core.video.table import read_tables
from core.videos import Recording
from tests.core.making_videos import every_ms, make_video

BOX = {"label": "dent", "bbox": [0.2, 0.2, 0.4, 0.4], "track_id": 1}
SETTINGS = make_settings(options={"frames.count": 12, "roi.x0": 0.0, "roi.x1": 1.0, "roi.y0": 0.0, "roi.y1": 1.0})


def write(path: Path, keys: Sequence[str]) -> Path:
    masks = [{"label": "blade", "polygon": [[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]]}]
    path.write_text(json.dumps({key: {"detections": [BOX], "masks": masks} for key in keys}))
    return path


def run(recordings: Sequence[Recording], out: Path, upto: str = "frames") -> dict[str, Any]:
    """Facts of the stages by name; their files lie in folders of these names."""
    facts: dict[str, Any] = {}
    for name, stage in (("probe", probe), ("annotations", annotations_stage), ("frames", frames)):
        folder = out / name
        folder.mkdir(parents=True)
        inputs = {key: out / key for key in facts}
        facts[name] = stage.run(StageTask(name, {}, SETTINGS, inputs, dict(facts), recordings, folder)).facts
        if name == upto:
            break
    return facts


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("two")


@pytest.fixture(scope="module")
def recordings(root: Path) -> list[Recording]:
    """40 frames at 25/s with keys in seconds, and 20 frames at 10/s with keys that are frame numbers from 0."""
    first = Recording(make_video(root / "a.mp4", every_ms(40, 40)), write(root / "a.json", ["0.40", "1.00", "1.20"]))
    second = make_video(root / "b.mp4", every_ms(100, 20))
    return [first, Recording(second, write(root / "b.json", [str(i) for i in range(12)]))]


@pytest.fixture(scope="module")
def facts(root: Path, recordings: list[Recording]) -> dict[str, Any]:
    return run(recordings, root / "run")


@pytest.mark.usefixtures("facts")
def test_every_video_has_its_own_table(root: Path, facts: dict[str, Any]) -> None:
    tables = read_tables(root / "run" / "probe")
    assert [table.info.n_frames for table in tables] == [40, 20]
    assert [row.time_s for row in tables[1].rows[:3]] == [0.0, 0.1, 0.2]
    assert facts["probe"]["n_frames"] == 60
    assert facts["probe"]["videos"] == [
        {"n_frames": 40, "duration_s": pytest.approx(1.6)},
        {"n_frames": 20, "duration_s": pytest.approx(2.0)},
    ]


def test_keys_are_read_on_the_clock_of_their_own_video(root: Path, facts: dict[str, Any]) -> None:
    found = read_detections(root / "run" / "annotations")
    assert [one.id for one in found] == list(range(15))
    assert [one.source for one in found[:4]] == [SourceFrame(0, 10), SourceFrame(0, 25), SourceFrame(0, 30), (1, 0)]
    assert [one.time_s for one in found[3:6]] == pytest.approx([0.0, 0.1, 0.2])
    assert [told["clock"] for told in facts["annotations"]["time_conventions"]] == ["pts", "index"]
    looked, masks = read_looked_at(root / "run" / "annotations"), read_masks(root / "run" / "annotations")
    assert looked == [one.source for one in found] == sorted(masks)
    assert (facts["annotations"]["n_detections"], facts["annotations"]["labels"]) == (15, {"dent": 15})


@pytest.mark.usefixtures("facts")
def test_frames_are_numbered_over_both_and_shared_by_length(root: Path) -> None:
    used = read_frames(root / "run" / "frames")
    search = list(used)[: used.n_search]
    assert [frame.index for frame in search] == list(range(len(search)))
    assert [frame.source for frame in search] == sorted(frame.source for frame in search)
    sampled = [frame.video for frame in search if frame.role in ("sampled", "both")]
    assert (sampled.count(0), sampled.count(1)) == (8, 4), "12 over 40 and 20 frames"
    tables = read_tables(root / "run" / "probe")
    for frame in used:
        row = tables[frame.video].rows[frame.source_index]
        assert (frame.time_s, frame.sha256) == (row.time_s, row.sha256)


@pytest.mark.usefixtures("facts")
def test_the_picture_of_a_frame_is_of_its_own_video(root: Path, recordings: list[Recording]) -> None:
    """Both videos begin with the same picture; behind it their numbers tell them apart."""
    used = read_frames(root / "run" / "frames")
    alone = root / "alone"
    run([Recording(recordings[1].video, recordings[1].annotations)], alone)
    own = {frame.source_index: image_path(alone / "frames", frame.index) for frame in read_frames(alone / "frames")}
    both = {frame.source_index: image_path(root / "run" / "frames", frame.index) for frame in used if frame.video == 1}
    shared = own.keys() & both.keys()
    assert len(shared) >= 10
    digests = {hashlib.sha256(both[i].read_bytes()).hexdigest() for i in shared}
    assert digests == {hashlib.sha256(own[i].read_bytes()).hexdigest() for i in shared}


def test_one_video_leaves_the_files_and_facts_that_it_always_did(root: Path, recordings: list[Recording]) -> None:
    facts = run(recordings[:1], root / "one")
    assert "videos" not in facts["probe"]
    assert "time_conventions" not in facts["annotations"]
    for stage, name in (("annotations", "detections"), ("frames", "frames")):
        rows = json.loads((root / "one" / stage / f"{name}.json").read_text())
        assert all("video" not in row for row in rows)
    assert not any(path.is_dir() for path in (root / "one" / "probe").iterdir())


def test_a_video_may_have_no_annotations(root: Path, recordings: list[Recording]) -> None:
    facts = run([Recording(recordings[0].video), recordings[1]], root / "half")
    found = read_detections(root / "half" / "annotations")
    assert {one.video for one in found} == {1}
    assert [one.id for one in found] == list(range(12))
    assert facts["annotations"]["time_convention"]["clock"] == "index", "of the first video that has any"


def test_what_is_wrong_with_the_second_file_names_the_second_video(root: Path, recordings: list[Recording]) -> None:
    beyond = write(root / "beyond.json", ["5000.0", "5001.0", "5002.0"])
    with pytest.raises(BadInput, match=r"^video 1: the annotations belong to another video"):
        run([recordings[0], Recording(recordings[1].video, beyond)], root / "beyond")
    (root / "text.json").write_text("nothing")
    with pytest.raises(BadInput, match=r"^video 1: "):
        check_input([recordings[0], Recording(recordings[1].video, root / "text.json")], SETTINGS)


def test_videos_of_two_sizes_are_no_inspection(root: Path, recordings: list[Recording]) -> None:
    other = Recording(make_video(root / "small.mp4", every_ms(40, 20), size=(128, 96)))
    for refuse in (
        lambda: run([recordings[0], other], root / "sizes", upto="probe"),
        lambda: check_input([recordings[0], other], SETTINGS),
    ):
        with pytest.raises(BadInput, match="video 0 has frames of 160x128, video 1 of 128x96"):
            refuse()


def test_without_any_file_there_is_nothing(root: Path, recordings: list[Recording]) -> None:
    facts = run([Recording(one.video) for one in recordings], root / "bare", upto="annotations")
    assert (facts["annotations"]["format"], facts["annotations"]["n_detections"]) == (Annotations().format, 0)
    assert read_looked_at(root / "bare" / "annotations") == []
