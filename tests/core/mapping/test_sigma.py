"""Uncertainty of a place against what noisy poses do."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from core.mapping.sigma import PoseCovariance, place_sigma, pose_covariance

FOCAL = 400.0


def directions(points: np.ndarray) -> np.ndarray:
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def test_the_covariance_of_a_pose_is_what_noise_makes_of_it() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform((-2, -1.5, 3), (2, 1.5, 5), (60, 3))
    noise_px = 0.7

    def refitted() -> np.ndarray:
        seen = directions(directions(points) + rng.normal(scale=noise_px / FOCAL, size=points.shape))

        def residual(motion: np.ndarray) -> np.ndarray:
            moved = points @ Rotation.from_rotvec(motion[:3]).as_matrix().T + motion[3:]
            return np.ravel(directions(moved) - seen)

        return np.asarray(least_squares(residual, np.zeros(6)).x)

    sampled = np.cov(np.array([refitted() for _ in range(400)]).T)
    stated = pose_covariance(points, rng.normal(scale=noise_px, size=(60, 2)), FOCAL)
    assert stated is not None
    assert np.sqrt(np.diag(stated.matrix)) == pytest.approx(np.sqrt(np.diag(sampled)), rel=0.35)


def test_too_little_to_go_by() -> None:
    points = np.random.default_rng(0).uniform(1, 2, (5, 3))
    assert pose_covariance(points, np.ones((5, 2)), FOCAL) is None
    line = np.outer(np.linspace(1, 2, 9), [0.1, 0.2, 1.0])
    assert pose_covariance(line, np.ones((9, 2)), FOCAL) is None


def test_parts_of_a_place_add_up() -> None:
    place = np.array([0.3, 0.0, 4.0])
    distance = float(np.linalg.norm(place))
    box = place_sigma(place, None, 20.0, "box", FOCAL, 0.0)
    assert box == pytest.approx(0.06 * 20 / FOCAL * distance)
    assert place_sigma(place, None, 20.0, "mask", FOCAL, 0.0) == pytest.approx(box / 3)
    assert place_sigma(place, None, 20.0, "box", FOCAL, 0.05) == pytest.approx(np.hypot(box, 0.05))
    points = np.random.default_rng(1).uniform((-2, -1.5, 3), (2, 1.5, 5), (60, 3))
    pose = pose_covariance(points, np.random.default_rng(2).normal(size=(60, 2)), FOCAL)
    assert place_sigma(place, pose, 20.0, "box", FOCAL, 0.0) > box


def test_a_shaking_camera_moves_a_place_by_half_the_mean_square_of_its_shift() -> None:
    place, spread = np.array([0.3, -0.2, 4.0]), np.array([0.01, 0.02, 0.005, 0.03, 0.01, 0.02])
    motions = np.random.default_rng(0).normal(size=(200_000, 6)) * spread
    shifts = np.cross(motions[:, :3], place) + motions[:, 3:]
    expected = np.sqrt((shifts**2).sum(axis=1).mean() / 2)
    pose = PoseCovariance(np.diag(spread**2))
    assert place_sigma(place, pose, 0.0, "box", FOCAL, 0.0) == pytest.approx(expected, rel=0.01)
