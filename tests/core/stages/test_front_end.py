"""Stages `features`, `motion`, `matches` and `graph` in a row, on a small synthetic clip."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pycolmap
import pytest

from core.errors import Cancelled, StageFailed
from core.features.io import FrameFeatures, read_features, write_features
from core.io.frames import read_crop, read_frames, write_frames
from core.matching.auto import GIVE_UP_AFTER
from core.matching.keyframes import Keyframes, read_keyframes, write_keyframes
from core.matching.lightglue import LightGlueMatcher
from core.products.front import FramesProduct
from core.scene.frame import RunFrames
from core.settings import make_settings
from core.stage import StageTask
from core.stages import features, graph, matches, motion
from core.verification import STRONG_INLIERS
from core.videos import Recording
from core.viewgraph import read_pairs, read_table
from tests.core.making_frames import SIZE, frames_folder
from tests.core.making_products import facts_of

OPTIONS = {"features.max_keypoints": 400, "matching.method": "mutual_nearest", "matching.window": 2}


def _task(
    key: str, out: Path, inputs: dict[str, Path], options: dict[str, Any] | None = None, **more: Any
) -> StageTask:
    out.mkdir(parents=True, exist_ok=True)
    settings = make_settings(options={**OPTIONS, **(options or {})})
    args: dict[str, Any] = {name: more.pop(name) for name in ("start", "end") if name in more}
    return StageTask(key, args, settings, inputs, {}, (Recording(Path("video.mp4")),), out, **more)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with every result: 5 search frames, one added between frames 1 and 2, two chunks."""
    root = tmp_path_factory.mktemp("front")
    frames_folder(root / "frames", ["sampled"] * 5 + ["added"], [0, 1, 2, 3, 4, 1.5])
    (root / "camera").mkdir()
    camera = {"model": "OPENCV_FISHEYE", "width": SIZE[0], "height": SIZE[1], "params": [150, 150, 100, 80, 0, 0, 0, 0]}
    (root / "camera" / "camera.json").write_text(json.dumps(camera))
    inputs = {"frames": root / "frames", "camera": root / "camera"}
    for chunk, (start, end) in enumerate([(0, 3), (3, 6)]):
        key = f"features/{chunk:03d}"
        features.run(_task(key, root / key, dict(inputs), start=start, end=end))
        inputs[key] = root / key
    for chunk, (start, end) in enumerate([(0, 3), (3, 6)]):
        key = f"matches/{chunk:03d}"
        matches.run(_task(key, root / key, dict(inputs), start=start, end=end))
        inputs[key] = root / key
    graph.run(_task("graph", root / "graph", dict(inputs)))
    return root


def _inputs(run: Path) -> dict[str, Path]:
    keys = ("frames", "camera", "features/000", "features/001", "matches/000", "matches/001")
    return {key: run / key for key in keys}


def test_every_frame_has_features_in_its_chunk(run: Path) -> None:
    assert sorted(path.name for path in (run / "features" / "001").iterdir()) == ["0003.npz", "0004.npz", "0005.npz"]
    found = read_features(run / "features" / "000" / "0001.npz")
    assert 50 < len(found) <= 400
    assert (found.keypoints > 0).all()
    assert (found.keypoints < SIZE).all()


def test_graph_holds_all_pairs_and_their_motion(run: Path) -> None:
    table = read_table(run / "graph" / "graph.npz")
    expected = [(0, 1), (0, 2), (0, 5), (1, 2), (1, 3), (1, 5), (2, 3), (2, 4), (2, 5), (3, 4), (3, 5)]
    assert [tuple(pair) for pair in table.pairs.tolist()] == expected
    assert table.verified.all()
    first = read_features(run / "features" / "000" / "0000.npz").keypoints
    second = read_features(run / "features" / "000" / "0001.npz").keypoints
    rows = table.inliers[table.offsets[0] : table.offsets[1]]
    moved = second[rows[:, 1]] - first[rows[:, 0]]
    np.testing.assert_allclose(np.median(moved, axis=0), [-6, 0], atol=0.2)


def test_database_is_complete(run: Path) -> None:
    with pycolmap.Database.open(run / "graph" / "database.db") as database:
        assert database.num_images() == 6
        assert database.num_verified_image_pairs() == 11
        assert database.read_image(6).name == "0005.jpg"


def test_facts_are_plain_and_repeatable(run: Path, tmp_path: Path) -> None:
    task = _task("matches/000", tmp_path / "again", _inputs(run), start=0, end=3)
    facts = matches.run(task).facts
    assert json.loads(json.dumps(facts)) == facts
    assert facts["n_pairs"] == 9
    again = (tmp_path / "again" / "pairs.npz").read_bytes()
    assert again == (run / "matches" / "000" / "pairs.npz").read_bytes()


def test_blade_masks_drop_the_background(run: Path, tmp_path: Path) -> None:
    (tmp_path / "annotations").mkdir()
    # Source pixels 10..110 x 20..180 of frame 0 (source index 0), which is the crop's left half; frame 1 has none.
    polygon = [[10 / 250, 20 / 200], [110 / 250, 20 / 200], [110 / 250, 180 / 200], [10 / 250, 180 / 200]]
    masks = {"0": [{"label": "blade", "polygon": polygon}]}
    (tmp_path / "annotations" / "masks.json").write_text(json.dumps(masks))
    inputs = {"frames": run / "frames", "annotations": tmp_path / "annotations"}
    options = {"features.blade_masks_only": True}
    features.run(_task("features/000", tmp_path / "out", inputs, options, start=0, end=2))
    assert read_features(tmp_path / "out" / "0000.npz").keypoints[:, 0].max() <= 101
    assert read_features(tmp_path / "out" / "0001.npz").keypoints[:, 0].max() > 150


def test_cancelling_stops_before_the_next_frame(run: Path, tmp_path: Path) -> None:
    seen: list[float] = []
    task = _task(
        "features/000",
        tmp_path / "out",
        {"frames": run / "frames"},
        start=0,
        end=3,
        progress=lambda fraction, message: seen.append(fraction),
        cancelled=lambda: len(seen) >= 2,
    )
    with pytest.raises(Cancelled):
        features.run(task)
    assert seen == [0, pytest.approx(1 / 3)]
    assert len(list((tmp_path / "out").iterdir())) == 2


def test_a_missing_chunk_is_named(run: Path, tmp_path: Path) -> None:
    inputs = _inputs(run)
    del inputs["features/001"]
    with pytest.raises(StageFailed, match="frame 3 has no features"):
        matches.run(_task("matches/000", tmp_path / "out", inputs, start=0, end=3))


def test_motion_chooses_among_the_search_frames(run: Path, tmp_path: Path) -> None:
    task = _task("motion", tmp_path, _inputs(run))
    facts = motion.run(replace(task, facts={"frames": facts_of(FramesProduct, n_search=5, crop=(0, 0, *SIZE))})).facts
    assert read_keyframes(tmp_path).frames == (0, 1, 2, 3, 4)
    assert facts == {"n_keyframes": 5, "median_step": 1.0, "motion_per_frame": pytest.approx(6 / SIZE[0], rel=0.05)}


def test_nothing_moves_over_a_cut_between_two_videos(run: Path, tmp_path: Path) -> None:
    inputs = _inputs(run)
    cut = tmp_path / "frames"
    shutil.copytree(inputs["frames"], cut)
    frames = read_frames(cut)
    write_frames(cut, RunFrames(tuple(replace(one, video=int(one.index >= 3)) for one in frames)), read_crop(cut))
    task = _task("motion", tmp_path / "out", {**inputs, "frames": cut})
    motion.run(replace(task, facts={"frames": facts_of(FramesProduct, n_search=5, crop=(0, 0, *SIZE))}))
    moved = read_keyframes(tmp_path / "out").moved
    assert [one is None for one in moved] == [False, False, True, False]


def test_keyframes_that_lie_apart_are_matched_too(run: Path, tmp_path: Path) -> None:
    write_keyframes(tmp_path, Keyframes((0, 2, 4), (0.01, 0.01)))
    inputs = {**_inputs(run), "motion": tmp_path}
    matches.run(_task("matches/000", tmp_path / "out", inputs, start=0, end=3))
    table, near = read_pairs(tmp_path / "out"), read_pairs(run / "matches" / "000")
    assert {tuple(pair) for pair in table.pairs.tolist()} - {tuple(pair) for pair in near.pairs.tolist()} == {(0, 4)}


def test_a_frame_that_shows_nothing_costs_little(run: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    inputs = _inputs(run)
    shutil.copytree(run / "features" / "000", tmp_path / "features")
    found, rng = read_features(tmp_path / "features" / "0002.npz"), np.random.default_rng(0)
    noise = rng.normal(size=found.descriptors.shape)
    noise /= np.linalg.norm(noise, axis=1, keepdims=True)
    write_features(tmp_path / "features" / "0002.npz", replace(found, descriptors=noise.astype(np.float16)))
    inputs["features/000"] = tmp_path / "features"
    tried: list[FrameFeatures] = []

    def match(self: LightGlueMatcher, a: FrameFeatures, b: FrameFeatures, *_: Any) -> Any:
        tried.append(a)
        return np.empty((0, 2), np.uint32)

    monkeypatch.setattr(LightGlueMatcher, "match", match)
    options = {"matching.method": "auto", "matching.auto_min_inliers": 100}
    matches.run(_task("matches/000", tmp_path / "out", inputs, options, start=0, end=3))
    table = read_table(tmp_path / "out" / "pairs.npz")
    shows = ~(table.pairs == 2).any(axis=1)
    assert table.n_inliers[shows].min() > 300
    assert table.n_inliers[~shows].max() < STRONG_INLIERS
    assert (~shows).sum() == 5
    assert len(tried) == GIVE_UP_AFTER
