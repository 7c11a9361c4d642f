"""Everything about a reconstruction that placing a detection asks for, read once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.pose import transform
from core.mapping.consensus import LookedAt
from core.mapping.depth_consistency import DepthMaps
from core.mapping.sigma import PoseCovariance, pose_covariance
from core.mapping.support import Observations
from core.mapping.surface import Surface
from core.scene.frame import Crop
from core.scene.views import Views
from core.surface.ply import Mesh

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True)
class SparsePoints:
    """The sparse model as a view sees it."""

    observations: Mapping[int, Observations]
    """By frame index; those of frames with detections, and of the ones that poses are judged by."""
    positions: Mapping[int, F64]
    """(3,) by point id."""

    def of(self, frame_index: int) -> tuple[F64, I64, F64]:
        """Of a frame: (n, 2) crop pixels, (n,) point ids, (n, 3) positions."""
        seen = self.observations.get(frame_index)
        if seen is None or not len(seen.point_ids):
            return np.zeros((0, 2)), np.zeros(0, np.int64), np.zeros((0, 3))
        return seen.xy, seen.point_ids, np.array([self.positions[int(i)] for i in seen.point_ids])


@dataclass(frozen=True)
class Scene:
    """A model and its surface."""

    views: Views
    mesh: Mesh
    """Faces are counter-clockwise seen from the cameras."""
    surface: Surface
    face_normals: F64
    """(m, 3) unit."""
    cloud: Any
    """cKDTree over the fused points."""
    spacing: float
    """Median distance of a fused point to its nearest neighbour, scene units."""
    crop: Crop
    sparse: SparsePoints
    frames: LookedAt
    depth: DepthMaps
    focal_px: float
    model: int = 0

    @property
    def tolerance(self) -> float:
        """Depth by which the surface may lie before a place without hiding it, scene units."""
        return 5.0 * self.spacing

    def pose_covariance(self, view: int) -> PoseCovariance | None:
        """Of a registered view, by its sparse observations."""
        xy, _, points = self.sparse.of(int(self.views.frame_index[view]))
        in_cam = transform(points, self.views.R[view], self.views.t[view])
        in_front = in_cam[:, 2] > 0
        in_cam, xy = in_cam[in_front], xy[in_front]
        if len(in_cam) < 6:
            return None
        residuals = np.asarray(self.views.camera.img_from_cam(np.ascontiguousarray(in_cam))) - xy
        return pose_covariance(in_cam, residuals, self.focal_px)


def face_normals(mesh: Mesh) -> F64:
    """(m, 3) unit normals; zero for a face without area."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    unit: F64 = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    return unit


def cloud_tree(points: F64) -> Any:
    """Tree over the fused cloud; built quickly, since it is asked only a few thousand times."""
    return cKDTree(points, balanced_tree=False, compact_nodes=False)


def mean_focal(camera: pycolmap.Camera) -> float:
    """Mean of the focal lengths of a camera, px."""
    return float(camera.mean_focal_length())


def places_nearest(surface: Surface, points: Sequence[F64]) -> F64:
    """(n, 3) points of the mesh nearest to the given ones."""
    if not points:
        return np.zeros((0, 3))
    return surface.nearest(np.array(points))[0]
