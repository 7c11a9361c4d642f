from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from core.features.io import write_features
from core.settings import make_settings
from core.sparse.focal import choose_spans, joined
from core.sparse.lens import fov_from_focal
from core.stage import StageTask
from core.stages import focal
from tests.core.sparse.scene import FOCAL, HEIGHT, WIDTH, Scene, make_scene

TRUE_FOV = fov_from_focal(FOCAL, WIDTH)


def task(scene: Scene, folder: Path, fov_deg: float) -> StageTask:
    features = folder / "features"
    if not features.exists():
        features.mkdir()
        for index, found in enumerate(scene.features):
            write_features(features / f"{index:04d}.npz", found)
    frames: dict[str, Any] = {
        "crop": [0, 0, WIDTH, HEIGHT],
        "source_width": WIDTH,
        "source_height": HEIGHT,
        "n_search": len(scene.features),
    }
    settings = make_settings("default", {"camera.focal_span": 14, "camera.focal_spans": 1})
    return StageTask(
        "focal", {"fov_deg": fov_deg}, settings, {"features/000": features}, {"frames": frames}, (), folder
    )


@pytest.mark.parametrize("wrong", [0.6, 1.25])
def test_a_wrong_start_ends_at_the_true_focal_length(wrong: float, tmp_path: Path) -> None:
    facts = focal.run(task(make_scene(16, 700), tmp_path, TRUE_FOV * wrong)).facts
    assert facts["registered"] == facts["frames"] == 14
    assert facts["focal_px"] == pytest.approx(FOCAL, rel=0.05)
    assert facts["mean_reprojection_error_px"] < 0.6


def test_a_turning_camera_says_nothing(tmp_path: Path) -> None:
    facts = focal.run(task(make_scene(16, 400, step=0.0), tmp_path, TRUE_FOV)).facts
    assert (facts["registered"], facts["points3D"]) == (0, 0)
    assert facts["focal_px"] == pytest.approx(FOCAL)


def test_spans_lie_where_the_camera_moves() -> None:
    still, moving = make_scene(1, 400), make_scene(20, 400)
    features = still.features * 40 + moving.features
    spans = choose_spans(60, 12, 1, lambda index: features[index])
    assert len(spans) == 1
    assert spans[0][0] >= 30
    assert spans[0][1] - spans[0][0] == 12


def test_spans_cover_sections_and_short_clips() -> None:
    features = make_scene(30, 200).features
    first, second = choose_spans(30, 10, 2, lambda index: features[index])
    assert first[1] <= 15 <= second[0]
    assert second[1] <= 30
    assert choose_spans(8, 30, 2, lambda index: features[index]) == [(0, 8)]


def test_spans_are_joined_by_their_points() -> None:
    from core.sparse.focal import SpanFocal

    facts = joined([SpanFocal(0, 30, 500.0, 0.1, 30, 3000, 0.5), SpanFocal(40, 70, 520.0, 0.2, 20, 1000, 0.9)])
    assert facts["focal_px"] == pytest.approx(math.exp(0.75 * math.log(500) + 0.25 * math.log(520)))
    assert facts["k1"] == pytest.approx(0.125)
    assert (facts["registered"], facts["points3D"], facts["frames"]) == (50, 4000, 60)
    assert facts["mean_reprojection_error_px"] == pytest.approx(0.6)
    nothing = joined([SpanFocal(0, 30, 700.0, 0.0, 0, 0, 0.0)])
    assert (nothing["focal_px"], nothing["registered"]) == (700.0, 0)
