"""Two-view geometric verification with COLMAP's estimators, and what a pair of views is worth."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypedDict

import cv2  # noqa: F401  (before pycolmap: the other order aborts in PNG writing)
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.geometry.lens import lens_of
from core.settings.groups import VerificationSettings

UNDEFINED, DEGENERATE, CALIBRATED, UNCALIBRATED, PLANAR = 0, 1, 2, 3, 4
"""COLMAP's configurations of a pair that are named in this code; 5 panoramic, 7 watermark."""

STRONG_INLIERS = 30
"""A pair with this many inliers can register an image (COLMAP's least for an absolute pose)."""

_CAMERA = "camera.json"
_MIN_TRIALS = 30
"""Of the RANSAC. COLMAP's 100 find the same inliers on real pairs at twice the cost."""


@dataclass(frozen=True)
class TwoViewGeometry:
    """What verification found between two views; without success there are no inliers and no motion."""

    config: int
    """COLMAP's configuration: 1 degenerate, 2 calibrated, 4 planar, 5 panoramic, ..."""
    inliers: NDArray[np.uint32]
    """(k, 2) keypoint indices."""
    rotation_xyzw: NDArray[np.float64]
    """(4,) of cam2_from_cam1."""
    translation: NDArray[np.float64]
    """(3,) of cam2_from_cam1, of unit length; zero for a pure rotation or failure."""
    triangulation_angle_deg: float
    """Median angle between the rays of the inliers; 0 when the views did not move apart."""


class CameraFields(TypedDict):
    """What ``camera.json`` says of the lens, in pixels; it has further members."""

    model: str
    width: int
    height: int
    params: list[float]


def camera_from_dict(values: CameraFields) -> pycolmap.Camera:
    """`pycolmap.Camera` number 1 from the facts of stage `camera`.

    The focal length is marked as a prior: without it COLMAP 4.2 calls every fisheye pair degenerate.
    """
    return pycolmap.Camera(
        camera_id=1,
        model=str(values["model"]),
        width=int(values["width"]),
        height=int(values["height"]),
        params=[float(value) for value in values["params"]],
        has_prior_focal_length=True,
    )


def write_camera(folder: Path, values: Mapping[str, object]) -> None:
    """Write the lens that matching and mapping start from, into the result of `camera`."""
    (folder / _CAMERA).write_text(json.dumps(values, indent=1) + "\n", encoding="utf-8")


def read_camera(folder: Path) -> pycolmap.Camera:
    """`camera_from_dict` of what `write_camera` wrote."""
    return camera_from_dict(json.loads((folder / _CAMERA).read_text(encoding="utf-8")))


class Verifier:
    """Verifies pairs of frames that share `camera`; the same input gives the same output."""

    def __init__(self, camera: pycolmap.Camera, settings: VerificationSettings, seed: int = 0) -> None:
        """Take the camera as `camera_from_dict` makes it."""
        self._camera = camera
        options = pycolmap.TwoViewGeometryOptions()
        options.min_num_inliers = settings.min_inliers
        options.compute_relative_pose = True
        options.ransac.max_error = settings.max_error_px
        options.ransac.random_seed = seed
        options.ransac.num_threads = 1
        options.ransac.min_num_trials = _MIN_TRIALS
        if not lens_of(camera).fisheye:
            # Pairs of a fisheye are judged by the essential matrix of their rays alone, and so are those of any lens:
            # with a fundamental matrix beside it a pair counts as uncalibrated, and gives no initial pair.
            options.min_E_F_inlier_ratio = 0.0
        self._options = options
        self._settings = settings

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) of the frames."""
        return int(self._camera.width), int(self._camera.height)

    def verify(
        self, first: NDArray[np.float32], second: NDArray[np.float32], matches: NDArray[np.uint32]
    ) -> TwoViewGeometry:
        """Keep the matches that one motion explains.

        Args:
            first, second: (n, 2) and (m, 2) keypoints in pixels, centres at (0.5, 0.5).
            matches: (k, 2) keypoint indices.
        """
        if len(matches) < self._settings.min_inliers:
            return _failed(DEGENERATE)
        found = pycolmap.estimate_two_view_geometry(
            self._camera,
            first.astype(np.float64),
            self._camera,
            second.astype(np.float64),
            matches,
            self._options,
        )
        inliers = np.asarray(found.inlier_matches, np.uint32).reshape(-1, 2)
        needed = max(self._settings.min_inliers, self._settings.min_inlier_share * len(matches))
        if len(inliers) < needed or found.cam2_from_cam1 is None:
            return _failed(int(found.config))
        motion = found.cam2_from_cam1
        return TwoViewGeometry(
            int(found.config),
            inliers,
            np.array(motion.rotation.quat, np.float64),
            np.array(motion.translation, np.float64),
            float(np.degrees(max(0.0, found.tri_angle))),
        )


def _failed(config: int) -> TwoViewGeometry:
    return TwoViewGeometry(config, np.empty((0, 2), np.uint32), np.array([0.0, 0.0, 0.0, 1.0]), np.zeros(3), 0.0)
