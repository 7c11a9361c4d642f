"""Fallback methods: poses between two registered views with the error of such poses, boxes carried by matches."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.mapping.fallback_methods import MIN_MATCHES, between, carried_over
from core.scene.views import Views
from tests.core import making_plates as plates

FOCAL = plates.FOCAL


def turned(angles: list[float], xs: list[float] | None = None) -> Views:
    """Views turned about the y axis by these angles (rad), at these places along x."""
    R = Rotation.from_rotvec(np.outer(angles, [0.0, 1.0, 0.0])).as_matrix()
    centers = np.zeros((len(angles), 3))
    centers[:, 0] = 0.0 if xs is None else xs
    return Views(np.arange(len(angles)), R, -np.einsum("nij,nj->ni", R, centers), plates.camera())


def test_a_pose_between_two_views_turns_and_moves_by_its_share_of_the_time() -> None:
    views = turned([0.0, 0.1, 0.2, 0.6], [0.0, 1.0, 3.0, 7.0])
    found = between(views, np.array([0.0, 0.1, 0.3, 0.4]), 0.15, 1.0)
    assert found is not None
    R, center, _ = found
    assert Rotation.from_matrix(R).as_rotvec() == pytest.approx([0.0, 0.125, 0.0])
    assert center == pytest.approx([1.5, 0.0, 0.0])


def test_views_need_not_come_in_the_order_of_their_times() -> None:
    views, times_s = turned([0.4, 0.0, 0.2], [4.0, 0.0, 2.0]), np.array([0.4, 0.0, 0.2])
    found = between(views, times_s, 0.3, 1.0)
    assert found is not None
    assert found[1] == pytest.approx([3.0, 0.0, 0.0])


def test_neighbours_out_of_reach_give_no_pose() -> None:
    views, times_s = turned([0.0] * 3), np.array([0.0, 0.5, 1.0])
    assert between(views, times_s, 0.75, 0.26) is not None
    assert between(views, times_s, 0.75, 0.25) is None, "nearer than the reach, not as near"
    assert between(views, times_s, 0.7, 0.25) is None
    assert between(views, times_s, 0.8, 0.25) is None
    assert between(views, times_s, -0.1, 9.0) is None
    assert between(views, times_s, 1.1, 9.0) is None


def test_the_error_is_the_median_over_views_left_out() -> None:
    """One view shakes by an angle: left out itself it is off by all of it, its neighbours by half."""
    shaken = 0.02
    found = between(turned([0.0, shaken, 0.0, 0.0]), np.array([0.0, 0.1, 0.2, 0.3]), 0.25, 1.0)
    assert found is not None
    assert found[2] == pytest.approx(FOCAL * (shaken + shaken / 2) / 2, rel=1e-6)


def test_the_error_weighs_neighbours_by_their_times() -> None:
    """Turning evenly by frame where the times are uneven: the view between two is off by what its share misses."""
    found = between(turned([0.0, 0.1, 0.2]), np.array([0.0, 0.1, 0.25]), 0.2, 1.0)
    assert found is not None
    assert found[2] == pytest.approx(FOCAL * (0.1 - 0.2 * 0.1 / 0.25), rel=1e-6)


def test_without_a_view_to_leave_out_the_error_is_unknown() -> None:
    found = between(turned([0.0, 0.1]), np.array([0.0, 0.1]), 0.05, 1.0)
    assert found is not None
    assert found[2] == np.inf
    # The third view is so far off in time that a pose across it says nothing of a short gap.
    found = between(turned([0.0, 0.1, 0.2]), np.array([0.0, 0.1, 0.9]), 0.05, 1.0)
    assert found is not None
    assert found[2] == np.inf


def matched(count: int, stray: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Keypoints in a box of 20 px around (100, 80), and what a turn by 90 degrees and twice the size makes of them."""
    own = np.random.default_rng(1).uniform((90, 70), (110, 90), (count + stray, 2))
    other = 2.0 * own @ np.array([[0.0, 1.0], [-1.0, 0.0]]) + (300.0, 10.0)
    other[count:] += np.random.default_rng(2).uniform(40, 90, (stray, 2))
    return own, other


def test_matches_around_a_box_give_the_similarity() -> None:
    for stray in (0, 4):
        found = carried_over(*matched(12, stray), (90.0, 70.0, 110.0, 90.0))
        assert found == pytest.approx(np.array([[0.0, -2.0, 300.0], [2.0, 0.0, 10.0]]), abs=1e-3)


def test_too_few_matches_or_too_far_away_carry_nothing() -> None:
    box = (90.0, 70.0, 110.0, 90.0)
    assert carried_over(*matched(MIN_MATCHES), box) is not None
    assert carried_over(*matched(MIN_MATCHES - 1), box) is None
    assert carried_over(*matched(MIN_MATCHES - 1, stray=3), box) is None
    own, other = matched(12)
    assert carried_over(own, other, (130.5, 70.0, 150.5, 90.0)) is None, "farther than its size from every one"
    assert carried_over(own, other, (200.0, 70.0, 220.0, 90.0)) is None
    # A small box is asked for the matches within 16 px of its middle.
    assert carried_over(own, other, (99.0, 79.0, 101.0, 81.0)) is not None
