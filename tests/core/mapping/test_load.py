"""What a depth map shows in the direction of a place, against a plane whose depths are known."""

from __future__ import annotations

import numpy as np
import pytest

from core.dense.cameras import Pinhole
from core.geometry.pose import Pose
from core.mapping.load import distances_in_map

PINHOLE = Pinhole(100.0, 10.0, 8.0, 20, 16)
DEPTH = 4.0


def pose(shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Pose:
    return Pose(np.eye(3), -np.array(shift))


def place(column: float, row: float, depth: float) -> np.ndarray:
    """The place that a camera at the origin sees at a position of the image, so deep."""
    return np.array([(column - PINHOLE.cx) / PINHOLE.focal_px, (row - PINHOLE.cy) / PINHOLE.focal_px, 1.0]) * depth


def plane() -> np.ndarray:
    return np.full((PINHOLE.height, PINHOLE.width), DEPTH, np.float32)


def test_a_depth_becomes_a_distance_along_the_line_of_sight() -> None:
    points = np.array([place(10.0, 8.0, 3.0), place(19.5, 0.5, 3.0), place(0.5, 15.5, 6.0)])
    found, own = distances_in_map(plane(), PINHOLE, pose(), points)
    assert own == pytest.approx(np.linalg.norm(points, axis=1))
    assert found == pytest.approx(own * DEPTH / points[:, 2]), "the same ray, as far as the plane"


def test_the_pixel_is_the_one_that_shows_the_place() -> None:
    depth = np.arange(1.0, 1.0 + plane().size, dtype=np.float32).reshape(plane().shape)
    columns, rows = np.array([0.0, 0.99, 7.5, 19.99, 3.2]), np.array([0.0, 15.99, 2.1, 0.5, 8.0])
    points = np.array([place(u, v, 2.0) for u, v in zip(columns + 1e-9, rows + 1e-9, strict=True)])
    found, own = distances_in_map(depth, PINHOLE, pose(), points)
    shown = depth[rows.astype(int), columns.astype(int)]
    assert found * points[:, 2] / own == pytest.approx(shown, rel=1e-6)


def test_the_camera_may_stand_anywhere() -> None:
    shift = (5.0, -2.0, 1.5)
    points = np.array([place(4.5, 6.5, 2.0)])
    found, own = distances_in_map(plane(), PINHOLE, pose(shift), points + np.array(shift))
    assert own == pytest.approx(np.linalg.norm(points, axis=1))
    assert found == pytest.approx(own * DEPTH / 2.0)


@pytest.mark.parametrize(("column", "row"), [(-0.01, 8.0), (20.01, 8.0), (10.0, -0.01), (10.0, 16.01)])
def test_beyond_the_map_nothing_is_shown(column: float, row: float) -> None:
    found, own = distances_in_map(plane(), PINHOLE, pose(), np.array([place(column, row, 3.0)]))
    assert found.tolist() == [0.0]
    assert own[0] > 3.0


def test_behind_the_camera_nothing_is_shown() -> None:
    """A place behind it has the pixel of the place opposite to it; on its plane there is no pixel."""
    points = np.array([-place(10.0, 8.0, 3.0), [1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, -1e100]])
    found, own = distances_in_map(plane(), PINHOLE, pose(), points)
    assert found.tolist() == [0.0] * 4
    assert own[:3] == pytest.approx([3.0, 1.0, 0.0])


def test_a_pixel_without_a_depth_shows_nothing() -> None:
    depth = plane()
    depth[8, 10] = 0.0
    found, _ = distances_in_map(depth, PINHOLE, pose(), np.array([place(10.5, 8.5, 3.0), place(11.5, 8.5, 3.0)]))
    assert found[0] == 0.0
    assert found[1] > DEPTH
