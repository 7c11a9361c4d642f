"""The opened scene: normals of faces, and how sure a pose is."""

from __future__ import annotations

import numpy as np
import pytest

from core.mapping.scene import SparsePoints, face_normals, places_nearest
from core.mapping.sigma import pose_covariance
from core.mapping.support import Observations
from core.surface.ply import Mesh
from tests.core import making_plates as plates
from tests.core.making_plates import FOCAL, NEAR, scene


def test_a_face_without_area_has_no_normal() -> None:
    vertices = np.array([[0, 0, 0], [2, 0, 0], [0, 3, 0], [4, 0, 0]], np.float64)
    mesh = Mesh(vertices, np.array([[0, 1, 2], [0, 2, 1], [0, 1, 3]], np.int32))
    assert face_normals(mesh).tolist() == [[0, 0, 1], [0, 0, -1], [0, 0, 0]]


def observed(count: int, behind: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Keypoints of frame 3, off by a tenth of a pixel, and points; those `behind` the camera come last."""
    rng = np.random.default_rng(5)
    points = rng.uniform((-1.5, -1.0, 3.0), (1.5, 1.0, 6.0), (count + behind, 3))
    points[count:, 2] *= -1.0
    xy = np.array([plates.pixel(point * [1, 1, np.sign(point[2])], 3) for point in points])
    return xy + rng.normal(scale=0.1, size=xy.shape), points


def test_six_points_before_the_camera_fix_a_pose_and_five_do_not() -> None:
    for count, behind in ((5, 0), (5, 3), (6, 0), (6, 3)):
        xy, points = observed(count, behind)
        found = scene(sparse={3: (xy, points)}).pose_covariance(3)
        if count < 6:
            assert found is None
            continue
        assert found is not None
        ahead = points[:count]
        expected = pose_covariance(
            ahead - [0.3, 0, 0], np.array([plates.pixel(p, 3) for p in ahead]) - xy[:count], FOCAL
        )
        assert expected is not None
        assert found.matrix == pytest.approx(expected.matrix)


def test_a_view_without_observations_has_no_covariance() -> None:
    assert scene().pose_covariance(3) is None


def test_points_of_a_frame_that_shows_none() -> None:
    empty = Observations(np.zeros((0, 2)), np.zeros(0, np.int64))
    points = SparsePoints({4: empty, 5: Observations(np.ones((1, 2)), np.array([7]))}, {7: np.array([1.0, 2.0, 3.0])})
    for frame, count in ((3, 0), (4, 0), (5, 1)):
        xy, ids, positions = points.of(frame)
        assert (xy.shape, ids.shape, positions.shape) == ((count, 2), (count,), (count, 3))
    assert points.of(5)[2].tolist() == [[1.0, 2.0, 3.0]]


def test_nearest_places_of_none_are_none() -> None:
    surface = scene().surface
    assert places_nearest(surface, []).shape == (0, 3)
    assert places_nearest(surface, [np.array([-1.0, 0.2, NEAR - 0.7])])[0] == pytest.approx([-1.0, 0.2, NEAR])
