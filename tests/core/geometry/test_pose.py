"""Poses: the identities that define them, and the bits of the expressions that the callers had."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry.pose import Pose, camera_center, camera_centers, transform


def random_matrices(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    rotations = Rotation.random(count, random_state=seed).as_matrix()
    return np.concatenate([rotations, rng.normal(size=(count, 3, 1))], axis=2)


def test_a_camera_lies_where_its_own_coordinates_vanish() -> None:
    for matrix in random_matrices(20, seed=1):
        pose = Pose(matrix[:, :3], matrix[:, 3])
        assert np.allclose(pose.in_camera(pose.center[None]), 0.0, atol=1e-14)


def test_centres_of_many_are_those_of_each() -> None:
    matrices = random_matrices(200, seed=2)
    R, t = matrices[:, :, :3], matrices[:, :, 3]
    many = camera_centers(R, t)
    assert np.array_equal(many, -np.einsum("fji,fj->fi", R, t))
    assert np.allclose(many, [camera_center(*pose) for pose in zip(R, t, strict=True)], rtol=0, atol=1e-15)


def test_a_relative_pose_carries_one_cameras_points_into_the_other() -> None:
    points = np.random.default_rng(3).normal(size=(30, 3))
    for one, two in zip(random_matrices(20, seed=4), random_matrices(20, seed=5), strict=True):
        first, second = Pose(one[:, :3], one[:, 3]), Pose(two[:, :3], two[:, 3])
        moved = second.relative_to(first)
        assert np.allclose(moved.in_camera(first.in_camera(points)), second.in_camera(points), atol=1e-13)


def test_the_bits_are_those_of_the_expressions() -> None:
    points = np.random.default_rng(6).normal(size=(100, 3))
    for one, two in zip(random_matrices(20, seed=7), random_matrices(20, seed=8), strict=True):
        R, t = one[:, :3], one[:, 3]
        assert np.array_equal(camera_center(R, t), -R.T @ t)
        assert np.array_equal(transform(points, R, t), points @ R.T + t)
        moved = Pose(two[:, :3], two[:, 3]).relative_to(Pose(R, t))
        rotation = two[:, :3] @ R.T
        assert np.array_equal(moved.R, rotation)
        assert np.array_equal(moved.t, two[:, 3] - rotation @ t)
    image = points[:, :2]
    similarity = two[:2, :3]
    assert np.array_equal(
        transform(image, similarity[:, :2], similarity[:, 2]), image @ similarity[:, :2].T + similarity[:, 2]
    )
