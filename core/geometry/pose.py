"""Camera poses as ``cam_from_world``: x_in_cam = R @ x_in_world + t."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Pose:
    """cam_from_world: x_in_cam = R @ x_in_world + t."""

    R: F64
    """(3, 3)"""
    t: F64
    """(3,)"""

    @property
    def center(self) -> F64:
        """(3,) position of the camera in the world."""
        return camera_center(self.R, self.t)

    def in_camera(self, points: F64) -> F64:
        """(n, 3) world points in the camera's frame."""
        return transform(points, self.R, self.t)

    def relative_to(self, reference: Pose) -> Pose:
        """The pose that maps points of the reference camera's frame into this camera's: this_from_reference."""
        R = self.R @ reference.R.T
        return Pose(R, self.t - R @ reference.t)


def pose_of(image: pycolmap.Image) -> Pose:
    """The pose of a registered image (`pycolmap.Image`)."""
    matrix = np.asarray(image.cam_from_world().matrix())
    return Pose(matrix[:, :3], matrix[:, 3])


def transform(points: F64, matrix: F64, shift: F64) -> F64:
    """``matrix @ x + shift`` of every row of the points.

    Args:
        points: (n, d)
        matrix: (d, d), a rotation or any other linear map.
        shift: (d,)
    """
    moved: F64 = points @ matrix.T + shift
    return moved


def camera_center(R: F64, t: F64) -> F64:
    """(3,) position in the world of a camera with rotation (3, 3) and translation (3,) of cam_from_world."""
    center: F64 = -R.T @ t
    return center


def camera_centers(R: F64, t: F64) -> F64:
    """(f, 3) positions in the world of many cameras: rotations (f, 3, 3) and translations (f, 3) of cam_from_world.

    It sums in another order than `camera_center`, so the two may differ in the last bit; each keeps its callers.
    """
    centers: F64 = -np.einsum("fji,fj->fi", R, t)
    return centers
