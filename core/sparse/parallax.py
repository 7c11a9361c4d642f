"""Whether the frames of a window differ in place at all, asked before anything is mapped.

A mapper given a camera that only turns (or stands) still returns a model: noise becomes depth. But then one
rotation explains the tracks between two frames, however far apart these are; a camera that moved leaves a residual.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from core.sparse.tracks import Tracks
from core.sparse.view_graph import Frames

MIN_SHARED = 40
"""Tracks two frames must share to be compared."""

N_FIRST = 12
"""First frames that are tried, evenly spread over the window."""

MIN_RESIDUAL_PX = 2.0
"""A median residual below this is the noise of keypoints: no parallax.

Synthetic scenes with 1 px of noise leave 1.6 px when the camera only turns and 4 px when it creeps by 2 % of the
distance; a borescope along blades leaves 8 to 30 px.
"""


def rotation_residual_px(tracks: Tracks, frames: Frames) -> float | None:
    """Median over frame pairs of the median distance that the best rotation leaves between shared tracks.

    Each pair is as far apart as shared tracks allow. None when no two frames share enough tracks.
    """
    rays = _rays_by_frame(tracks, frames)
    n = len(frames.indices)
    focal = float(frames.camera.mean_focal_length())
    residuals = []
    for first in sorted({int(i) for i in np.linspace(0, max(n - 2, 0), N_FIRST)}):
        pair = _widest(rays, first, n)
        if pair is not None:
            residuals.append(focal * _residual(*pair))
    return float(np.median(residuals)) if residuals else None


FrameRays = tuple[npt.NDArray[np.int64], npt.NDArray[np.float64]]


def _rays_by_frame(tracks: Tracks, frames: Frames) -> list[FrameRays]:
    """(track numbers, unit rays (n, 3)) of every frame; of two keypoints in one track the first counts."""
    number = np.repeat(np.arange(len(tracks.offsets) - 1), np.diff(tracks.offsets))
    found = []
    for frame, xy in zip(frames.indices, frames.keypoints, strict=True):
        mine = tracks.frame == frame
        track, first = np.unique(number[mine], return_index=True)
        points = xy[tracks.keypoint[mine][first]]
        rays = np.asarray(frames.camera.cam_ray_from_img(points)) if len(points) else np.zeros((0, 3))
        found.append((track, rays / np.linalg.norm(rays, axis=1, keepdims=True)))
    return found


def _widest(
    rays: list[FrameRays], first: int, n: int
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]] | None:
    """Rays of the shared tracks of `first` and the farthest later frame that shares enough."""
    best = None
    gap = 1
    while first + gap < n:
        (track_a, rays_a), (track_b, rays_b) = rays[first], rays[first + gap]
        _, a, b = np.intersect1d(track_a, track_b, assume_unique=True, return_indices=True)
        if len(a) < MIN_SHARED:
            break
        best = rays_a[a], rays_b[b]
        gap *= 2
    return best


def _residual(first: npt.NDArray[np.float64], second: npt.NDArray[np.float64]) -> float:
    """Median angle (rad) left by the rotation that fits most rays: Kabsch, repeated on the better half."""
    chosen = np.ones(len(first), dtype=bool)
    for _ in range(4):
        u, _, vt = np.linalg.svd(second[chosen].T @ first[chosen])
        rotation = u @ np.diag([1.0, 1.0, np.linalg.det(u @ vt)]) @ vt
        angle = np.linalg.norm(first @ rotation.T - second, axis=1)
        chosen = angle <= np.median(angle)
    return float(np.median(angle))
