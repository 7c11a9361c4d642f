"""Which registered views could see a place, and how well."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from core.geometry.boxes import in_box
from core.geometry.pose import camera_center, transform

F64 = NDArray[np.float64]

MIN_VISIBLE_SHARE = 0.5
"""A view sees a place when at least this share of its sample points is inside the image and not hidden."""


@dataclass(frozen=True)
class View:
    """Pose and lens of a registered image."""

    frame_index: int
    cam_from_world: F64
    """(3, 4)"""
    camera: Any
    """pycolmap.Camera; its size is that of the exported frames."""

    @property
    def center(self) -> F64:
        """(3,) projection centre in the world."""
        return camera_center(self.cam_from_world[:, :3], self.cam_from_world[:, 3])


@dataclass(frozen=True)
class Sighting:
    """One view that could see a place."""

    frame_index: int
    quality: float
    """cos(angle of incidence) / squared distance, relative to the best view of the place, in [0, 1]."""
    at: tuple[float, float] | None = None
    """Where the place appears, normalised on the source frame; None = not asked."""

    def to_dict(self, detected: bool) -> dict[str, Any]:
        """JSON form; `detected` says whether the defect was detected in that frame."""
        row = {"frame_index": self.frame_index, "quality": round(self.quality, 4), "detected": detected}
        if self.at is not None:
            row["x"], row["y"] = (round(value, 5) for value in self.at)
        return row


def views_of_model(model: Any) -> list[View]:
    """Registered images of a pycolmap.Reconstruction, ordered by frame index (image id - 1)."""
    # Copies, because a camera that belongs to a model is freed with it.
    cameras = {camera_id: copy.deepcopy(camera) for camera_id, camera in model.cameras.items()}
    views = []
    for image_id in sorted(model.reg_image_ids()):
        image = model.image(image_id)
        pose = np.array(image.cam_from_world().matrix(), dtype=np.float64)
        views.append(View(image_id - 1, pose, cameras[image.camera_id]))
    return views


class Occlusion:
    """Line of sight against a mesh."""

    def __init__(self, vertices: F64, faces: NDArray[np.int32]) -> None:
        self._scene: Any = None
        if len(faces):
            self._scene = o3d.t.geometry.RaycastingScene()
            self._scene.add_triangles(vertices.astype(np.float32), faces.astype(np.uint32))

    def clear(self, center: F64, points: F64, tolerance: float) -> NDArray[np.bool_]:
        """(n,) whether nothing lies between `center` and each point, but for `tolerance` scene units before it."""
        if self._scene is None:
            return np.ones(len(points), dtype=bool)
        towards = points - center
        distance = np.linalg.norm(towards, axis=1)
        rays = np.hstack([np.broadcast_to(center, points.shape), towards / distance[:, None]]).astype(np.float32)
        tensor: Any = o3d.core.Tensor
        hit = self._scene.cast_rays(tensor(rays), nthreads=1)["t_hit"].numpy()
        free: NDArray[np.bool_] = hit >= distance - tolerance
        return free


def sightings(
    points: F64, normal: F64, views: Sequence[View], occlusion: Occlusion, tolerance: float
) -> list[Sighting]:
    """Views that could see a place given by sample points on it, best first (earlier first among equals).

    Args:
        points: (n, 3) sample points of the place.
        normal: (3,) unit normal of the surface there; its sign does not matter. Zero = unknown.
        views: registered images.
        occlusion: the surface that may hide it.
        tolerance: depth by which the surface may lie before a point, scene units.
    """
    middle = points.mean(axis=0)
    found = []
    for view in views:
        if _visible_share(points, view, occlusion, tolerance) >= MIN_VISIBLE_SHARE:
            towards = view.center - middle
            distance = float(np.linalg.norm(towards))
            incidence = abs(float(towards @ normal)) / distance if normal.any() else 1.0
            found.append((view.frame_index, incidence / distance**2))
    best = max((quality for _, quality in found), default=0.0) or 1.0
    ranked = [Sighting(index, quality / best) for index, quality in found]
    return sorted(ranked, key=lambda sighting: (-sighting.quality, sighting.frame_index))


def _visible_share(points: F64, view: View, occlusion: Occlusion, tolerance: float) -> float:
    in_camera = transform(points, view.cam_from_world[:, :3], view.cam_from_world[:, 3])
    xy = np.asarray(view.camera.img_from_cam(in_camera), dtype=np.float64)
    inside = in_box(xy, (0, 0, view.camera.width, view.camera.height)) & (in_camera[:, 2] > 0)
    if inside.mean() < MIN_VISIBLE_SHARE:
        return 0.0
    clear = occlusion.clear(view.center, points[inside], tolerance)
    return float(clear.sum()) / len(points)
