"""Synthetic views of a bumpy wall through a fisheye lens, with exact correspondences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pycolmap

from core.verification import CameraFields, camera_from_dict

CAMERA_VALUES: CameraFields = {
    "model": "OPENCV_FISHEYE",
    "width": 640,
    "height": 480,
    "params": [400.0, 400.0, 330.0, 236.0, -0.01, 0.002, 0.0, 0.0],
}


def fisheye() -> pycolmap.Camera:
    return camera_from_dict(CAMERA_VALUES)


def bumpy_points(count: int, seed: int = 0, depth: float = 0.8) -> np.ndarray:
    """(count, 3) points about 3 units before the first camera; `depth` 0 makes them a plane."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform((-2.0, -1.4), (3.2, 1.4), (count, 2))
    return np.column_stack([xy, 3 + depth * rng.uniform(-1, 1, count)])


def pose(index: int, step: float = 0.15) -> Any:
    """`cam_from_world` of a camera that moves along x and turns a little."""
    angle = 0.02 * index
    rotation = pycolmap.Rotation3d(np.array([0.0, np.sin(angle / 2), 0.0, np.cos(angle / 2)]))
    centre = np.array([step * index, 0.02 * index, 0.05 * np.sin(index)])
    return pycolmap.Rigid3d(rotation, -(rotation.matrix() @ centre))


def view(
    points: np.ndarray, cam_from_world: Any, noise_px: float = 0.2, seed: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    """(n, 2) keypoints in view and the (n,) indices of their points."""
    camera = fisheye()
    local = points @ cam_from_world.rotation.matrix().T + cam_from_world.translation
    pixels = np.array([camera.img_from_cam(p) for p in local]).reshape(-1, 2)
    pixels = pixels + np.random.default_rng(seed).normal(scale=noise_px, size=pixels.shape)
    seen = (local[:, 2] > 0.1) & (pixels > 0).all(axis=1) & (pixels < (camera.width, camera.height)).all(axis=1)
    return pixels[seen].astype(np.float32), np.flatnonzero(seen)


def true_matches(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """(k, 2) keypoint indices of the points that both views see."""
    _, a, b = np.intersect1d(first, second, return_indices=True)
    return np.column_stack([a, b]).astype(np.uint32)
