"""The posed views of a model, all at once: rays of pixels, projections of points."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import in_box
from core.geometry.lens import lens_of
from core.geometry.pose import camera_centers

if TYPE_CHECKING:  # whoever loads it for real has to load OpenCV first
    import pycolmap

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True)
class Views:
    """Poses of registered images that share one camera, ordered by frame index."""

    frame_index: I64
    """(f,)"""
    R: F64
    """(f, 3, 3) cam_from_world."""
    t: F64
    """(f, 3)"""
    camera: pycolmap.Camera
    """Its size is that of the exported frames."""

    def __len__(self) -> int:
        return len(self.frame_index)

    @property
    def image_ids(self) -> list[int]:
        """COLMAP's ids of the images: frame index + 1."""
        return [int(index) + 1 for index in self.frame_index]

    @property
    def centers(self) -> F64:
        """(f, 3) projection centres."""
        return camera_centers(self.R, self.t)

    def row(self, frame_index: int) -> int | None:
        """Row of a frame; None when it is not registered."""
        at = int(np.searchsorted(self.frame_index, frame_index))
        return at if at < len(self.frame_index) and self.frame_index[at] == frame_index else None

    def rays(self, xy: F64, R: F64) -> F64:
        """(n, 3) unit viewing directions in the world of crop pixels seen with rotation R (cam_from_world)."""
        normalised = np.asarray(self.camera.cam_from_img(np.ascontiguousarray(xy, np.float64))).reshape(-1, 2)
        in_cam = np.hstack([normalised, np.ones((len(xy), 1))])
        world: F64 = (in_cam / np.linalg.norm(in_cam, axis=1, keepdims=True)) @ R
        return world

    def project(self, points: F64) -> tuple[F64, NDArray[np.bool_]]:
        """Where (n, 3) points appear in every view.

        Returns:
            (n, f, 2) crop pixels and (n, f) whether that is on the exported frame and before the camera.
        """
        in_cam = np.einsum("fij,nj->nfi", self.R, points) + self.t
        flat = in_cam.reshape(-1, 3)
        before = flat[:, 2] > 1e-9 * np.abs(flat).max(initial=1e-300)
        before &= lens_of(self.camera).before_fold(flat)
        xy = np.full((len(flat), 2), np.nan)
        if before.any():
            xy[before] = np.asarray(self.camera.img_from_cam(np.ascontiguousarray(flat[before])))
        inside = in_box(xy, (0, 0, self.camera.width, self.camera.height))
        shape = in_cam.shape[:2]
        return xy.reshape(*shape, 2), (inside & before).reshape(shape)


def views_of(model: pycolmap.Reconstruction) -> Views:
    """Views of a model with one camera; image id = frame index + 1."""
    ids = sorted(model.reg_image_ids())
    poses = np.array([model.image(i).cam_from_world().matrix() for i in ids], np.float64).reshape(-1, 3, 4)
    camera = copy.deepcopy(next(iter(model.cameras.values())))  # a camera that belongs to a model is freed with it
    return Views(np.array(ids, np.int64) - 1, poses[:, :, :3], poses[:, :, 3], camera)
