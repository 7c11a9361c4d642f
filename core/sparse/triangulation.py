"""Points of known tracks from known poses, all at once.

COLMAP's triangulator walks the correspondence graph image by image, makes several points of most tracks and merges
them afterwards. With the tracks known (`core.sparse.tracks`) each is solved directly: the point nearest to its rays,
observations that do not fit removed one by one.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import numpy.typing as npt
import pycolmap

from core.sparse.tracks import Tracks
from core.sparse.view_graph import Frames

MAX_ERROR_PX = 4.0
"""COLMAP's `filter_max_reproj_error`."""

MIN_ANGLE_DEG = 1.5
"""COLMAP's `filter_min_tri_angle`."""

MIN_LENGTH = 3
"""Two views cannot contradict each other: COLMAP's `ignore_two_view_tracks`."""


def add_track_points(model: Any, tracks: Tracks, frames: Frames) -> int:
    """Add the points of `tracks` that the registered images of `model` see well; returns how many.

    Args:
        model: with poses and without points; image_id = frame index + 1.
        tracks: keypoint indices are those of the model's images.
        frames: keypoints of these images, and maybe of more.
    """
    ids = sorted(model.reg_image_ids())
    if not ids or len(tracks.frame) == 0:
        return 0
    row = np.full(int(max(ids[-1], tracks.frame.max() + 1)) + 1, -1, dtype=np.int64)
    row[ids] = np.arange(len(ids))
    observation_row = row[tracks.frame + 1]
    rays, centers = _world_rays(model, ids, tracks, frames, observation_row)
    focal = next(iter(model.cameras.values())).mean_focal_length()
    limits = (MAX_ERROR_PX / focal, np.cos(np.radians(MIN_ANGLE_DEG)))
    points, kept = _solve(tracks.offsets, observation_row, rays, centers, *limits)
    for track in np.flatnonzero(np.isfinite(points[:, 0])):
        elements = pycolmap.Track()
        for o in range(tracks.offsets[track], tracks.offsets[track + 1]):
            if kept[o]:
                elements.add_element(int(tracks.frame[o]) + 1, int(tracks.keypoint[o]))
        model.add_point3D(points[track], elements)
    return int(np.isfinite(points[:, 0]).sum())


def _world_rays(
    model: Any, ids: list[int], tracks: Tracks, frames: Frames, row: npt.NDArray[np.int64]
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
    """Unit rays (total, 3) in the world of all observations in registered images, and centres (images, 3)."""
    keypoints = dict(zip(frames.indices, frames.keypoints, strict=True))
    rays = np.zeros((len(row), 3))
    centers = np.zeros((len(ids), 3))
    order = np.argsort(row, kind="stable")
    starts = np.searchsorted(row[order], np.arange(len(ids) + 1))
    for i, image_id in enumerate(ids):
        image = model.image(image_id)
        centers[i] = image.projection_center()
        mine = order[starts[i] : starts[i + 1]]
        if len(mine) == 0:
            continue
        xy = keypoints[image_id - 1][tracks.keypoint[mine]]
        in_camera = np.asarray(image.camera.cam_ray_from_img(xy))
        rays[mine] = in_camera @ image.cam_from_world().rotation.matrix()
    return rays / np.maximum(np.linalg.norm(rays, axis=1, keepdims=True), 1e-12), centers


def _solve_python(
    offsets: npt.NDArray[np.int64],
    row: npt.NDArray[np.int64],
    rays: npt.NDArray[np.float64],
    centers: npt.NDArray[np.float64],
    max_error: float,
    max_cosine: float,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.bool_]]:
    """Points (n, 3), NaN where there is none, and which observations belong to them.

    Least squares of the distances to the rays, weighted by the inverse distance to the centre, so that angles
    count; the observation that fits worst goes while its angle exceeds `max_error`, down to `MIN_LENGTH`.
    """
    n = len(offsets) - 1
    points = np.full((n, 3), np.nan)
    kept = row >= 0
    for t in range(n):
        first, last = offsets[t], offsets[t + 1]
        count = 0
        for o in range(first, last):
            count += kept[o]
        weight = np.ones(last - first)
        solved = False
        point: npt.NDArray[Any] = np.zeros(3)
        while count >= MIN_LENGTH:
            for _ in range(3):
                normal = np.zeros((3, 3))
                side = np.zeros(3)
                for o in range(first, last):
                    if kept[o]:
                        d, c, w = rays[o], centers[row[o]], weight[o - first]
                        for i in range(3):
                            for j in range(3):
                                m = w * ((1.0 if i == j else 0.0) - d[i] * d[j])
                                normal[i, j] += m
                                side[i] += m * c[j]
                if abs(np.linalg.det(normal)) < 1e-12:
                    break
                point = np.linalg.solve(normal, side)
                for o in range(first, last):
                    v = point - centers[row[o]]
                    weight[o - first] = 1.0 / max(v[0] * v[0] + v[1] * v[1] + v[2] * v[2], 1e-12)
            worst, worst_error = -1, max_error
            for o in range(first, last):
                if kept[o]:
                    v = point - centers[row[o]]
                    length = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
                    d = rays[o]
                    error = np.sqrt(
                        (v[0] / length - d[0]) ** 2 + (v[1] / length - d[1]) ** 2 + (v[2] / length - d[2]) ** 2
                    )
                    if not error <= worst_error:
                        worst, worst_error = o, error
            if worst < 0:
                solved = True
                break
            kept[worst] = False
            count -= 1
        smallest = 1.0
        if solved:
            for a in range(first, last):
                if kept[a]:
                    for b in range(a + 1, last):
                        if kept[b]:
                            u, v = point - centers[row[a]], point - centers[row[b]]
                            smallest = min(smallest, np.dot(u, v) / np.sqrt(np.dot(u, u) * np.dot(v, v)))
        if smallest < max_cosine:
            points[t] = point
        else:
            kept[first:last] = False
    return points, kept


_solve: Any = numba.njit(cache=True)(_solve_python)
