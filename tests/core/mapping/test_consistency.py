"""Independent depths, the split into patches, and the weights of a confidence."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from core.mapping.casting import depth_agreement
from core.mapping.confidence import Parts, confidence
from core.mapping.depth_consistency import no_depth_maps, seen_share
from core.mapping.patches import split_patches
from core.mapping.pixels import footprint
from core.mapping.surface import Surface
from tests.core import making_plates as plates


def test_looks_that_meet_pass_or_end_before() -> None:
    maps = plates.depth_maps_of(plates.plates(), [0, 5])
    grid = np.column_stack([np.linspace(-1, -0.5, 20), np.zeros(20), np.full(20, plates.NEAR)])
    assert seen_share(maps, 2, grid, plates.SPACING) == 1.0
    assert seen_share(maps, 2, grid * 0.8, plates.SPACING) == 0.0, "seen through"
    assert seen_share(maps, 2, grid * 1.3, plates.SPACING) is None, "hidden: nothing was said"
    assert seen_share(no_depth_maps(), 2, grid, plates.SPACING) is None
    assert plates.depth_maps_of(plates.plates(), range(0, 100, 10)).near(42)[:3] == [40, 50, 30]


def test_points_behind_a_patch_do_not_count() -> None:
    agreement = depth_agreement(np.array([4.0, 4.01, 3.99, 4.02, 9.0, 9.1]), 4.0, 0.01)
    assert (agreement.share, agreement.count) == (1.0, 4)
    assert depth_agreement(np.array([3.0, 3.0, 4.0, 4.0]), 4.0, 0.01).share == 0.5
    assert depth_agreement(np.array([4.0, 9.0]), 4.0, 0.01).share is None


def test_patches_are_split_at_the_edge_and_not_on_a_slope() -> None:
    views, mesh = plates.views([0]), plates.plates()
    samples = footprint((*(plates.pixel((0, 0, 4), 0) - 10), *(plates.pixel((0, 0, 4), 0) + 10)), 320, 240)
    rays = views.rays(samples.xy, np.eye(3))
    origin = np.zeros(3)
    hits = Surface(mesh.vertices, mesh.faces).cast(np.zeros_like(rays), rays)
    near, far = split_patches(samples, origin, rays, hits, plates.SPACING)
    assert near.share + far.share == pytest.approx(1.0)
    assert near.points[:, 2] == pytest.approx(plates.NEAR, abs=1e-4)
    assert far.points[:, 2] == pytest.approx(plates.FAR, abs=1e-4)
    assert near.weights.sum() == pytest.approx(1.0)
    tilted = plates.plate((-3, 3), (-2, 2), 0.0)
    slope = tilted.vertices @ np.array([[1, 0, 2.0], [0, 1, 0], [0, 0, 1]]) + (0, 0, 5.0)  # 63 degrees
    hits = Surface(slope, tilted.faces).cast(np.zeros_like(rays), rays)
    assert len(split_patches(samples, origin, rays, hits, 0.001)) == 1


PARTS = Parts(12, 3, 2, 0.6, 0.5, 0.1, 0.5, 0.6, 2.0, 0.5, 2, 0.7)


@pytest.mark.parametrize(
    ("better", "worse"),
    [
        ({"support": 8}, {"support": 1, "same_label": 1}),
        ({"depth": 1.0}, {"depth": 0.1}),
        ({"support": 5, "same_label": 5}, {"support": 5, "same_label": 0}),
        ({"model_warnings": 0}, {"model_warnings": 2}),
        ({"peers": 9}, {"peers": 0}),
    ],
)
def test_confidence_follows_its_parts(better: dict[str, float], worse: dict[str, float]) -> None:
    high, low = (confidence(replace(PARTS, **change)) for change in (better, worse))  # type: ignore[arg-type]
    assert 0.0 < low < high < 1.0


def test_confidence_stays_inside_its_bounds() -> None:
    worst = Parts(200, 0, 0, 0.1, 0.1, 0.0, 0.0, 0.0, 50.0, 0.0, 0, 9.0)
    best = Parts(200, 200, 200, 1.0, 1.0, float("inf"), 1.0, 1.0, 0.0, 1.0, 300, 0.0)
    assert confidence(worst) < 0.1
    assert confidence(best) > 0.95
    assert best.to_dict()["lead"] is None
