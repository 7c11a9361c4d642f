"""Inverse-depth planes and counter-based random numbers."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from core.dense.cameras import Pinhole
from core.dense.patchmatch.jit import kernel
from core.dense.patchmatch.planes import from_normals, to_normals, uniform, upsample
from core.dense.patchmatch.transfer import planes_from_source
from core.geometry.pose import Pose

Plane = tuple[Pinhole, NDArray[np.float64], NDArray[np.float32]]


def _plane_image(pinhole: Pinhole, normal: np.ndarray, distance: float) -> np.ndarray:
    """Exact (w, gu, gv, 0) of the plane normal . X = distance."""
    K = pinhole.index_matrix()
    v, u = np.mgrid[0 : pinhole.height, 0 : pinhole.width]
    scaled = np.linalg.inv(K).T @ (normal / distance)
    planes = np.zeros((pinhole.height, pinhole.width, 4), np.float32)
    planes[..., 0] = scaled[0] * u + scaled[1] * v + scaled[2]
    planes[..., 1], planes[..., 2] = scaled[0], scaled[1]
    return planes


@pytest.fixture
def plane() -> tuple[Pinhole, np.ndarray, np.ndarray]:
    pinhole = Pinhole(60.0, 21.0, 15.0, 40, 32)
    normal = np.array([0.3, -0.4, -1.0]) / np.linalg.norm([0.3, -0.4, -1.0])
    return pinhole, normal, _plane_image(pinhole, normal, -3.0)


def test_normals_of_a_plane_are_its_normal_and_come_back(plane: Plane) -> None:
    pinhole, normal, planes = plane
    normals = to_normals(planes, pinhole.index_matrix())
    np.testing.assert_allclose(normals, np.broadcast_to(normal, normals.shape), atol=1e-4)
    back = from_normals(1.0 / planes[..., 0], normals, pinhole.index_matrix())
    np.testing.assert_allclose(back[..., :3], planes[..., :3], atol=1e-5)


def test_pixels_without_depth_have_no_plane_and_no_normal(plane: Plane) -> None:
    pinhole, _, planes = plane
    planes[3, 4] = 0
    normals = to_normals(planes, pinhole.index_matrix())
    assert not normals[3, 4].any()
    depth = np.where(planes[..., 0] > 0, 1 / np.maximum(planes[..., 0], 1e-9), 0).astype(np.float32)
    assert not from_normals(depth, normals, pinhole.index_matrix())[3, 4].any()


def test_upsampled_planes_are_exact_on_a_plane(plane: Plane) -> None:
    pinhole, normal, _ = plane
    coarse = _plane_image(pinhole.halved(), normal, -3.0)
    fine = upsample(coarse, pinhole.width, pinhole.height)
    np.testing.assert_allclose(fine[..., :3], _plane_image(pinhole, normal, -3.0)[..., :3], atol=1e-5)


@kernel
def _draw(key: np.uint64, out: NDArray[np.float32]) -> None:
    for i in range(out.size):
        out[i] = uniform(key, np.uint64(i))


def test_random_numbers_are_uniform_and_depend_on_the_key_only() -> None:
    first, again, other = (np.empty(20000, np.float32) for _ in range(3))
    _draw(np.uint64(5), first)
    _draw(np.uint64(5), again)
    _draw(np.uint64(6), other)
    np.testing.assert_array_equal(first, again)
    assert abs(np.corrcoef(first, other)[0, 1]) < 0.03
    assert first.min() >= 0
    assert first.max() < 1
    counts, _ = np.histogram(first, bins=10, range=(0, 1))
    assert counts.min() > 1800


def test_a_plane_seen_from_another_camera_is_the_same_plane() -> None:
    pinhole = Pinhole(60.0, 21.0, 15.0, 40, 32)
    a = np.radians(9)
    turn = np.array([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])
    reference, source = Pose(np.eye(3), np.array([0.1, 0, 0])), Pose(turn, np.array([-0.4, 0.1, 0.2]))
    normal, distance = np.array([0.2, 0.1, -1.0]), -3.0
    # n . X_world = d; X_camera = R X_world + t.
    planes = [
        _plane_image(pinhole, pose.R @ normal, distance + (pose.R @ normal) @ pose.t) for pose in (reference, source)
    ]
    carried = planes_from_source(planes[1], pinhole, reference, source, (0.01, 10.0))
    hit = carried[..., 0] > 0
    assert hit.mean() > 0.5
    np.testing.assert_allclose(carried[hit][:, :3], planes[0][hit][:, :3], atol=2e-5)
    none = planes_from_source(planes[1], pinhole, reference, source, (5.0, 10.0))
    assert not none.any()
