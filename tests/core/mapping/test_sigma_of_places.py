"""How far places may be off, by placement method: closed forms on plates that all cameras see at right angles."""

from __future__ import annotations

import numpy as np
import pytest

from core.mapping.sigma import BOX_JITTER, place_sigma, pose_covariance
from core.mapping.surface_rules import place_on_surface
from tests.core import making_plates as plates
from tests.core.making_plates import FOCAL, NEAR, SPACING, detection, scene, times

ON_NEAR = (-0.8, 0.2, NEAR)
HALF_PX = 8.0


def of_the_box(place: tuple[float, float, float], frame: int, side_px: float) -> float:
    """From the edge of the box and the spacing of the cloud; the pose adds nothing."""
    distance = np.linalg.norm(np.array(place) - [plates.STEP * frame, 0, 0])
    return float(np.hypot(BOX_JITTER * side_px / FOCAL * distance, SPACING))


def test_a_cast_place_is_as_sure_as_its_box() -> None:
    one = detection(0, ON_NEAR, 3, HALF_PX)
    found = place_on_surface([one], scene(detections=[one]), times(), plates.no_matches, 0.4)[0]
    assert found.sigma == pytest.approx(of_the_box(ON_NEAR, 3, 2 * HALF_PX), rel=0.01)


def test_the_pose_of_its_view_makes_a_place_less_sure() -> None:
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(-1.6, -0.1, 8), rng.uniform(-0.9, -0.3, 8), np.full(8, NEAR)])
    exact = np.array([plates.pixel(point, 3) for point in points])
    seen = exact + rng.normal(scale=5.0, size=exact.shape)
    one = detection(0, ON_NEAR, 3, HALF_PX)
    made = scene(detections=[one], sparse={3: (seen, points)})
    found = place_on_surface([one], made, times(), plates.no_matches, 0.4)[0]
    moved = np.array(ON_NEAR) - [0.3, 0, 0]
    pose = pose_covariance(points - [0.3, 0, 0], exact - seen, FOCAL)
    expected = place_sigma(moved, pose, 2 * HALF_PX, "box", FOCAL, SPACING)
    assert found.sigma == pytest.approx(expected, rel=0.01)
    assert expected > 1.5 * of_the_box(ON_NEAR, 3, 2 * HALF_PX), "the pose is what makes it unsure"


def test_the_sparse_points_of_a_place_tell_how_far_they_spread() -> None:
    """The mean distance of those that count from their middle."""
    hole = plates.plate((2.0, 3.0), (-2.0, 2.0), NEAR)
    points = np.array(ON_NEAR) + np.array([[0.06, 0, 0], [-0.06, 0, 0], [0, 0.08, 0], [0, -0.08, 0], [0, 0, 2.0]])
    xy = np.array([plates.pixel(point, 3) for point in points])
    one = detection(0, ON_NEAR, 3, HALF_PX)
    made = scene(detections=[one], mesh=hole, sparse={3: (xy, points)})
    found = place_on_surface([one], made, times(), plates.no_matches, 0.4)[0]
    assert (found.row.outcome, found.row.rung) == ("approximate", "sparse")
    assert found.sigma == pytest.approx((0.06 + 0.06 + 0.08 + 0.08) / 4)


@pytest.mark.parametrize("times_larger", [1.0, 2.5])
def test_a_carried_place_is_half_as_sure_as_the_box_that_it_is_carried_to(times_larger: float) -> None:
    """Matches tell how much larger the box appears in the frame with a pose."""
    one = detection(0, ON_NEAR, 9, HALF_PX)
    corner, other_corner = plates.pixel(ON_NEAR, 9), plates.pixel(ON_NEAR, 3)
    around = np.random.default_rng(0).uniform(-12.0, 12.0, (30, 2)) / times_larger
    own, other = corner + around, other_corner + times_larger * around
    made = scene([0, 1, 2, 3], [one])
    found = place_on_surface([one], made, times(), lambda _: [(3, own, other)], 0.4)[0]
    assert found.row.rung == "propagated"
    assert found.sigma == pytest.approx(2 * of_the_box(ON_NEAR, 3, times_larger * 2 * HALF_PX), rel=0.01)
