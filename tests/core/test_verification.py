from __future__ import annotations

import numpy as np
import pycolmap
import pytest

from core.settings import make_settings
from core.verification import CALIBRATED, DEGENERATE, Verifier
from tests.core.making_views import bumpy_points, fisheye, pose, true_matches, view

PLANAR = 4


def _verifier(seed: int = 0) -> Verifier:
    return Verifier(fisheye(), make_settings().verification, seed)


def _pair(depth: float = 0.8, wrong: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Keypoints of two views, their matches and which of them are right."""
    points = bumpy_points(400, depth=depth)
    first, seen_first = view(points, pose(0), seed=1)
    second, seen_second = view(points, pose(2), seed=2)
    matches = true_matches(seen_first, seen_second)
    right = np.ones(len(matches), np.bool_)
    right[: int(wrong * len(matches))] = False
    matches[~right, 1] = np.random.default_rng(3).permutation(matches[~right, 1])
    return first, second, matches, right


def test_a_fisheye_pair_is_calibrated_and_its_motion_right() -> None:
    first, second, matches, right = _pair(wrong=0.3)
    found = _verifier().verify(first, second, matches)
    assert found.config == CALIBRATED
    assert len(found.inliers) >= 0.95 * right.sum()
    wrong = {tuple(row) for row in matches[~right].tolist()}
    assert sum(tuple(row) in wrong for row in found.inliers.tolist()) <= 0.1 * len(wrong)
    truth = pose(2) * pose(0).inverse()
    rotation = pycolmap.Rotation3d(found.rotation_xyzw)
    assert np.degrees((rotation * truth.rotation.inverse()).angle()) < 0.3
    direction = truth.translation / np.linalg.norm(truth.translation)
    assert found.translation @ direction > 0.995
    assert 2 < found.triangulation_angle_deg < 10


def test_without_a_prior_focal_length_the_same_pair_is_degenerate() -> None:
    """The trap that `camera_from_dict` avoids; if COLMAP changes, this says so."""
    first, second, matches, _ = _pair()
    camera = fisheye()
    assert camera.has_prior_focal_length
    camera.has_prior_focal_length = False
    assert Verifier(camera, make_settings().verification).verify(first, second, matches).config == DEGENERATE


def test_a_plane_is_told_apart() -> None:
    first, second, matches, _ = _pair(depth=0.0)
    found = _verifier().verify(first, second, matches)
    assert found.config == PLANAR
    assert len(found.inliers) > 0.8 * len(matches)


def test_the_same_seed_gives_the_same_result() -> None:
    first, second, matches, _ = _pair(wrong=0.5)
    one, two = (_verifier(7).verify(first, second, matches) for _ in range(2))
    np.testing.assert_array_equal(one.inliers, two.inliers)
    np.testing.assert_array_equal(one.rotation_xyzw, two.rotation_xyzw)
    np.testing.assert_array_equal(one.translation, two.translation)


@pytest.mark.parametrize("count", [0, 5, 200])
def test_random_or_few_matches_verify_nothing(count: int) -> None:
    rng = np.random.default_rng(0)
    first, second = (rng.uniform(0, 470, (300, 2)).astype(np.float32) for _ in range(2))
    matches = np.column_stack([rng.permutation(300)[:count], rng.permutation(300)[:count]]).astype(np.uint32)
    found = _verifier().verify(first, second, matches)
    assert found.inliers.shape == (0, 2)
    assert found.triangulation_angle_deg == 0
