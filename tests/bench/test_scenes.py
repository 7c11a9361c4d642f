"""Rendered scenes: the same pixels twice, truth that agrees with them, and a table of scores."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from plyfile import PlyData

from bench.accuracy.truth import load_truth
from bench.scenes.blades import build_row, surface_point
from bench.scenes.detector import Detector, Visible
from bench.scenes.make import frame_times, is_made, make_scene
from bench.scenes.path import make_path
from bench.scenes.render import Painter, true_lens
from bench.scenes.spec import Lens, Scene, Span
from bench.scenes.suite import CALIBRATION, DRAWN, SUITE
from bench.scenes.table import markdown
from core.video.decode import iter_frames

TINY = Scene("tiny", 3, Lens(240, 180, 80.0), n_frames=6, turn_deg=4.0, distance_mm=34.0, n_defects=5, missed=0.0)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("scenes") / "tiny"
    make_scene(TINY, folder)
    return folder


def test_the_lens_goes_out_and_comes_back() -> None:
    for lens in (Lens(480, 360, 112.0, -0.04), Lens(480, 360, 68.0, 0.02)):
        ray = true_lens(lens).rays(np.array([0.0, 240.0]), np.array([180.0, 180.0]))
        assert np.degrees(np.arccos(ray[0, 2])) == pytest.approx(lens.fov_deg / 2)
        assert ray[1] == pytest.approx((0, 0, 1))


def test_the_same_scene_gives_the_same_pixels() -> None:
    one, two = (next(Painter(TINY, build_row(TINY), make_path(TINY)).frames()) for _ in range(2))
    assert (one.rgb == two.rgb).all()
    other = replace(TINY, seed=4)
    assert (next(Painter(other, build_row(other), make_path(other)).frames()).rgb != one.rgb).any()


def test_truth_agrees_with_the_picture(made: Path) -> None:
    truth = load_truth(made / "truth")
    assert truth.n_frames == 6
    assert truth.chord == pytest.approx(27.0)
    row, path = build_row(TINY), make_path(TINY)
    for i, frame in enumerate(Painter(TINY, row, path).frames()):
        rows, columns = np.nonzero(~np.isnan(frame.point[..., 0]))
        pick = slice(None, None, 50)
        points = frame.point[rows, columns][pick]
        in_cam = (points - truth.centers[i]) @ truth.rotations[i]
        rays = truth.lens.rays(columns[pick].astype(np.float64) + 0.5, rows[pick].astype(np.float64) + 0.5)
        assert in_cam / np.linalg.norm(in_cam, axis=1, keepdims=True) == pytest.approx(rays, abs=1e-5)
        for box in truth.boxes[i]:
            x1, y1, x2, y2 = box.box_px.astype(int)
            assert (frame.defect[y1:y2, x1:x2] == box.defect).any()
    assert truth.defects, "something is visible"
    for number, defect in truth.defects.items():
        nominal = row.defects[number]
        assert np.linalg.norm(defect.patch - nominal.center, axis=1).max() <= 1.1 * nominal.radius_mm + 1e-3


def test_defects_are_shape_or_colour() -> None:
    row = build_row(TINY)
    intact = build_row(replace(TINY, n_defects=0))
    moved = np.linalg.norm(row.vertices - intact.vertices, axis=1)
    shaped = [one for one in row.defects if one.kind in ("nick", "dent")]
    assert shaped
    for one in shaped:
        near = np.linalg.norm(intact.vertices - one.center, axis=1) < one.radius_mm
        assert moved[near].max() > 0.2 * one.radius_mm
    far = np.min([np.linalg.norm(intact.vertices - one.center, axis=1) for one in row.defects], axis=0)
    assert moved[far > 32.0].max(initial=0.0) < 1e-9
    sides = [surface_point(TINY, 0, 0.5, 0.3, side) for side in (-1, 1)]
    assert 1.0 < np.linalg.norm(sides[0] - sides[1]) < 8.0


def test_dark_frames_and_a_second_body() -> None:
    dark = replace(TINY, dark=Span(2, 4))
    means = [float(frame.rgb.mean()) for frame in Painter(dark, build_row(dark), make_path(dark)).frames()]
    assert max(means[2:4]) < 0.7 * min(means[:2] + means[4:])
    vanes = replace(TINY, casing=True)
    plain, hidden = (next(Painter(s, build_row(s), make_path(s)).frames()) for s in (TINY, vanes))
    covered = ~np.isnan(plain.point[..., 0]) & np.isnan(hidden.point[..., 0])
    assert 0.005 < covered.mean() < 0.6


def test_times_are_those_of_the_video(tmp_path: Path) -> None:
    uneven = replace(TINY, name="uneven", n_frames=20, dropped=0.2, jitter_s=0.01)
    kept, times = frame_times(uneven)
    assert len(kept) < 20
    assert (np.diff(times) > 0).all()
    assert np.diff(times).std() > 0.005
    make_scene(uneven, tmp_path / "uneven")
    decoded = [seconds for _, _, seconds, _ in iter_frames(tmp_path / "uneven" / "video.mp4")]
    assert decoded == pytest.approx(times, abs=1e-6)
    keys = json.loads((tmp_path / "uneven" / "annotations.json").read_text())
    assert [float(key) for key in keys] == pytest.approx(times, abs=1e-4)
    truth = load_truth(tmp_path / "uneven" / "truth")
    assert [truth.frame_at(float(key)) for key in keys] == list(range(len(keys)))
    assert truth.frame_at(99.0) is None


def test_a_scene_is_made_once(made: Path) -> None:
    assert is_made(TINY, made)
    assert not is_made(replace(TINY, seed=9), made)
    assert len(PlyData.read(str(made / "truth" / "surface.ply"))["face"].data) > 1000


def test_the_detector_misses_jitters_and_invents() -> None:
    box = np.array([40.0, 30.0, 60.0, 50.0])
    seen = [Visible(0, "dent", box, np.array([[40.0, 30.0], [60.0, 30.0], [60.0, 50.0]]))]
    keen = Detector(replace(TINY, masks=True))
    entries = [keen.entry(seen)["detections"] for _ in range(200)]
    assert {len(found) for found in entries} == {1}
    edges = np.array([found[0]["bbox"] for found in entries]) * [240, 180, 240, 180]
    assert edges.mean(axis=0) == pytest.approx(box, abs=0.4)
    assert edges.std(axis=0) == pytest.approx(np.full(4, 0.06 * 20), rel=0.3)
    assert len(entries[0][0]["polygon"]) == 3
    lazy = Detector(replace(TINY, missed=0.5, false_boxes=0.3))
    counts = [len(lazy.entry(seen)["detections"]) for _ in range(400)]
    assert np.mean(counts) == pytest.approx(0.8, abs=0.15)


def test_no_two_families_share_a_scene() -> None:
    assert len(SUITE) >= 12
    every = [*SUITE, *CALIBRATION, *DRAWN]
    assert len({scene.name for scene in every}) == len({scene.seed for scene in every}) == len(every)
    assert not {scene.lens for scene in SUITE} & {scene.lens for scene in (*CALIBRATION, *DRAWN)}
    for scene in every:
        assert scene.n_frames <= 120
        assert scene.lens.width <= 480


def test_the_table_has_a_row_for_every_scene_and_the_median() -> None:
    score = {
        "frames": {"registered_annotated_share": 1.0},
        "placement": {
            "mapped_share": 0.9,
            "placeable": 10,
            "mapped_placeable": 9,
            "wrong_mapped": 0,
            "position_median_mm": 0.27,
            "position_p95_mm": 0.54,
            "wrong_mapped_share": 0.0,
            "false_boxes": {"mapped_confident_persistent_share": None},
        },
        "defects": {"found": 3, "expected": 4, "split": 0, "extra": 1},
        "confidence": {"ece": 0.02, "auroc": None},
    }
    ok = {"verdict": "ok", "flags": [], "seconds": 60.0, "score": score}
    hopeless = {**ok, "verdict": "refused", "flags": ["no_parallax"]}
    text = markdown([SUITE[0], SUITE[-1]], [ok, hopeless]).splitlines()
    assert len(text) == 5
    assert "| easy | ok | 100.0 % | 90.0 % of 10 | 1.0 / 2.0 | 0.0 % | 90.0 % | 3 of 4 / 0 / 1 |" in text[2]
    assert "refused (no_parallax): as expected" in text[3]
    assert "**median scene**" in text[4]
