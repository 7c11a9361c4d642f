"""Clips made from a clip: what they keep of it, and what a path told at another rate has in common with it."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.accuracy.truth import load_truth
from bench.main import main
from bench.scenes import variants
from bench.scenes.make import make_scene
from bench.scenes.path import make_path, resampled
from bench.scenes.render import TONE
from bench.scenes.spec import Lens, Scene
from bench.scenes.variants import NOISE, SLOW, darkened, rewrite
from bench.scenes.variants_command import dark_cells, rate_cells
from core.errors import BadInput
from core.video.decode import iter_frames

SMALL = Scene("small", 7, Lens(96, 72, 90.0), n_frames=9, turn_deg=9.0, missed=0.0, n_defects=6)


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("variants") / "small"
    make_scene(SMALL, folder)
    return folder


def pictures(folder: Path) -> list[np.ndarray[Any, Any]]:
    return [rgb.astype(float) for _, _, _, rgb in iter_frames(folder / "video.mp4")]


def test_every_fourth_frame_keeps_its_picture_pose_time_and_boxes(source: Path, tmp_path: Path) -> None:
    rewrite(source, tmp_path / "thin", range(0, 9, 4))
    whole, thin = load_truth(source / "truth"), load_truth(tmp_path / "thin/truth")
    assert thin.n_frames == 3
    assert thin.times_s == pytest.approx(whole.times_s[::4], abs=1e-9)
    assert np.array_equal(thin.centers, whole.centers[::4])
    assert [len(boxes) for boxes in thin.boxes] == [len(boxes) for boxes in whole.boxes[::4]]
    before, after = pictures(source), pictures(tmp_path / "thin")
    assert len(after) == 3
    for old, new in zip(before[::4], after, strict=True):
        assert np.abs(old - new).mean() < 3.0, "once more through the encoder, and no other frame"
    assert np.abs(before[1] - after[1]).mean() > 3.0
    times = [time for _, _, time, _ in iter_frames(tmp_path / "thin/video.mp4")]
    assert times == pytest.approx(thin.times_s, abs=1e-4)
    entries, all_entries = (json.loads((at / "annotations.json").read_text()) for at in (tmp_path / "thin", source))
    assert list(entries.values()) == list(all_entries.values())[::4]
    assert [float(key) for key in entries] == pytest.approx(thin.times_s, abs=1e-4)


def test_the_middle_goes_dark_and_loses_its_annotations(source: Path, tmp_path: Path) -> None:
    dark, change = darkened(9, 3, 0.05)
    assert dark == [3, 4, 5]
    rewrite(source, tmp_path / "dark", range(9), change, without=dark)
    before, after = pictures(source), pictures(tmp_path / "dark")
    factor = 0.05 ** (1 / TONE)
    for i in range(9):
        expected = before[i].mean() * (factor if i in dark else 1.0)
        assert after[i].mean() == pytest.approx(expected, abs=2.0), i
    entries = json.loads((tmp_path / "dark/annotations.json").read_text())
    times = load_truth(source / "truth").times_s
    assert [float(key) for key in entries] == pytest.approx(np.delete(times, dark), abs=1e-4)


def test_noise_stays_when_the_light_goes() -> None:
    rgb = np.full((60, 80, 3), 200, np.uint8)
    dark, change = darkened(20, 5, 0.02)
    assert change(0, rgb) is rgb
    faint = change(dark[0], rgb)
    assert faint.mean() == pytest.approx(200 * 0.02 ** (1 / TONE), abs=0.6)
    assert faint.std() == pytest.approx(255 * NOISE, rel=0.1)
    assert np.array_equal(faint, darkened(20, 5, 0.02)[1](dark[0], rgb))
    assert not np.array_equal(faint, change(dark[1], rgb))
    none = darkened(20, 5, 0.0)[1](dark[0], rgb)
    assert 0 < none.max() < 20


def test_a_path_told_at_five_times_the_rate_is_the_same_motion() -> None:
    path = make_path(SLOW)
    fine = resampled(path, 5 * (SLOW.n_frames - 1) + 1)
    assert fine.rotor_angle[::5] == pytest.approx(path.rotor_angle)
    assert fine.world_from_cam[::5] == pytest.approx(path.world_from_cam)
    steps = np.linalg.norm(np.diff(fine.rotor_from_cam()[:, :3, 3], axis=0), axis=1)
    coarse = np.linalg.norm(np.diff(path.rotor_from_cam()[:, :3, 3], axis=0), axis=1)
    assert steps.reshape(-1, 5).sum(axis=1) == pytest.approx(coarse, rel=0.1)


def test_a_scene_can_be_given_another_motion(tmp_path: Path) -> None:
    motion = resampled(make_path(SMALL), 4)
    make_scene(replace(SMALL, n_frames=4), tmp_path / "other", motion)
    truth = load_truth(tmp_path / "other/truth")
    assert truth.centers == pytest.approx(motion.rotor_from_cam()[:, :3, 3], abs=1e-5)


def scored(**changes: Any) -> dict[str, Any]:
    frames = {"registered": 90, "source_frames": 100, "registered_share": 0.9}
    place = {"mapped_placeable": 8, "placeable": 10, "wrong_mapped": 1}
    defects = {"found": 3, "expected": 4, "split": 2, "extra": 0}
    cameras = {"position_median_mm": 0.1, "position_p95_mm": 0.25}
    score = {"frames": frames, "placement": place, "defects": defects, "cameras": cameras, "models": {"1": {}}}
    return {"score": score, "verdict": "ok", "flags": [], "focal_px": 200.0, "step": 1, **changes}


def test_the_tables_compare_with_the_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = rate_cells(scored(step=4, focal_px=203.0, flags=["few_points"], verdict="suspect"), scored())
    assert row[0] == "every 4th frame"
    assert row[3:] == [
        "203.0 px",
        "registered +0.0 %, focal length +1.5 %",
        "0.10 / 0.25",
        "suspect (few_points)",
    ]
    assert rate_cells(scored(focal_px=None), scored())[4].endswith("focal length -")
    assert dark_cells(scored(frames=5, percent=2.0)) == [
        "5",
        "2 %",
        "2",
        "90 of 100",
        "8 of 10",
        "1",
        "3 of 4 / 2 / 0",
        "ok",
    ]
    monkeypatch.setattr(variants, "rates", lambda _: [scored(), scored(step=12)])
    assert main(["variants", "rates", str(tmp_path)]) == 0
    assert "every 12th frame" in capsys.readouterr().out


def test_runs_are_made_once_for_each_number_of_frames_and_light(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    calls: list[str] = []

    def run(clip: Path, roi: Any, _column: Any, _out: Path) -> dict[str, Any]:
        assert tuple(roi) == SMALL.roi
        calls.append(clip.name)
        return {**scored(), "seconds": 1.0}

    monkeypatch.setattr(variants, "run_and_score", run)
    arguments = ["variants", "dark", str(tmp_path / "out"), str(source), "--frames", "1,3", "--light", "0,2.5"]
    assert main(arguments) == 0
    assert main(arguments) == 0
    assert calls == ["dark-1-0", "dark-1-2.5", "dark-3-0", "dark-3-2.5"]
    assert "| 3 | 2.5 % | 2 | 90 of 100 |" in capsys.readouterr().out
    assert main([*arguments[:4], "--light", "bright"]) == 2
    assert main([*arguments[:4], "--frames", "0"]) == 2


def test_entries_that_are_not_by_time_are_refused(source: Path, tmp_path: Path) -> None:
    (tmp_path / "list").mkdir()
    for path in source.iterdir():
        (tmp_path / "list" / path.name).symlink_to(path)
    (tmp_path / "list/annotations.json").unlink()
    (tmp_path / "list/annotations.json").write_text("[]")
    with pytest.raises(BadInput, match="entries by time"):
        rewrite(tmp_path / "list", tmp_path / "out", range(3))
