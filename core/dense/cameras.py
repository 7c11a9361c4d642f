"""Our own pinhole for the undistorted images, and how it is chosen from the lens."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.errors import StageFailed
from core.settings.groups import DenseSettings

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Pinhole:
    """A pinhole camera with square pixels; pixel centres at (0.5, 0.5)."""

    focal_px: float
    cx: float
    cy: float
    width: int
    height: int

    def matrix(self) -> F64:
        """(3, 3) calibration in COLMAP's convention, pixel centres at (0.5, 0.5)."""
        return np.array([[self.focal_px, 0.0, self.cx], [0.0, self.focal_px, self.cy], [0.0, 0.0, 1.0]])

    def index_matrix(self) -> F64:
        """(3, 3) calibration whose pixel centres are at whole numbers, as array indices are.

        COLMAP's stereo fusion wants this one: it multiplies whole pixel indices with the inverse of K.
        """
        K = self.matrix()
        K[:2, 2] -= 0.5
        return K

    def halved(self) -> Pinhole:
        """The camera of the image at half size (whole 2 x 2 blocks; an odd last row or column is lost)."""
        return Pinhole(self.focal_px / 2, self.cx / 2, self.cy / 2, self.width // 2, self.height // 2)


def choose_pinhole(camera: pycolmap.Camera, settings: DenseSettings) -> Pinhole:
    """The pinhole that shows what the lens shows, down to a bound on peripheral stretch.

    Rule: the focal length is the lens's own at its centre, so the centre keeps its resolution. The image covers the
    rays through the border of the distorted image, except where a pinhole would stretch a lens of
    constant angular resolution radially by more than `max_stretch` (1 / cos^2 of the angle off the axis): such
    rays are pulled in to that angle. `scale` and `max_image_size_px` then shrink the image as a whole.

    Args:
        camera: pycolmap.Camera of the distorted images.
        settings: `max_stretch`, `scale`, `max_image_size_px`.

    Raises:
        StageFailed: the lens model maps no border pixel to a ray in front of the camera.
    """
    border = _border_rays(camera)
    tangent_max = float(np.tan(np.arccos(1.0 / np.sqrt(settings.max_stretch))))
    tangent = np.linalg.norm(border, axis=1)
    border = border * np.minimum(1.0, tangent_max / np.maximum(tangent, 1e-12))[:, None]
    low, high = border.min(axis=0), border.max(axis=0)
    focal = float(camera.mean_focal_length()) * settings.scale
    longer = float((high - low).max()) * focal
    if longer > settings.max_image_size_px:
        focal *= settings.max_image_size_px / longer
    width, height = (int(v) for v in np.maximum(16, np.floor((high - low) * focal + 1e-6)))
    return Pinhole(focal, float(-low[0] * focal), float(-low[1] * focal), width, height)


def _border_rays(camera: pycolmap.Camera) -> F64:
    """(n, 2) tangents x/z, y/z of rays through the image border; rays that miss the front are left out."""
    w, h = float(camera.width), float(camera.height)
    s = np.linspace(0.0, 1.0, 65)
    corners = [(s * w, 0 * s), (s * w, 0 * s + h), (0 * s, s * h), (0 * s + w, s * h)]
    pixels = np.concatenate([np.stack(side, axis=1) for side in corners])
    rays = np.asarray(camera.cam_from_img(pixels), dtype=np.float64)
    back = np.asarray(camera.img_from_cam(np.column_stack([rays, np.ones(len(rays))])), dtype=np.float64)
    rays = rays[np.isfinite(rays).all(axis=1) & (np.abs(back - pixels).max(axis=1) < 1.0)]
    if not len(rays):
        raise StageFailed("the lens model has no pixel at the image border that looks forward", where="undistort")
    return np.asarray(rays, dtype=np.float64)
