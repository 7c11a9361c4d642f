"""Points of known tracks from known poses, all at once.

COLMAP's triangulator walks the correspondence graph image by image, makes several points of most tracks and merges
them afterwards. With the tracks known (`core.sparse.tracks`) each is solved directly: the point nearest to its rays,
observations that do not fit removed one by one.
"""

from __future__ import annotations

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


def add_track_points(model: pycolmap.Reconstruction, tracks: Tracks, frames: Frames) -> int:
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
    model: pycolmap.Reconstruction, ids: list[int], tracks: Tracks, frames: Frames, row: npt.NDArray[np.int64]
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
        in_camera = np.asarray(model.camera(image.camera_id).cam_ray_from_img(xy))
        rays[mine] = in_camera @ image.cam_from_world().rotation.matrix()
    return rays / np.maximum(np.linalg.norm(rays, axis=1, keepdims=True), 1e-12), centers


F64 = npt.NDArray[np.float64]
I64 = npt.NDArray[np.int64]
Bool = npt.NDArray[np.bool_]


def _solve(offsets: I64, row: I64, rays: F64, centers: F64, max_error: float, max_cosine: float) -> tuple[F64, Bool]:
    """Points (n, 3) of all tracks, NaN where there is none, and which observations (total,) belong to them.

    The observation of a track that fits worst goes while its angle exceeds `max_error` (rad); all tracks that lost
    one are solved again together.
    """
    n = len(offsets) - 1
    track = np.repeat(np.arange(n), np.diff(offsets))
    points = np.full((n, 3), np.nan)
    kept = row >= 0
    pending = np.ones(n, dtype=bool)
    while pending.any():
        some = np.flatnonzero(kept & pending[track])
        pending[:] = False
        names, starts = np.unique(track[some], return_index=True)
        points[names] = _nearest(starts, rays[some], centers[row[some]])
        error = np.linalg.norm(_toward(points[track[some]], centers[row[some]]) - rays[some], axis=1)
        largest = np.maximum.reduceat(error, starts) if len(some) else np.zeros(0)
        bad = names[largest > max_error]
        of_bad = np.isin(track[some], bad) & (error >= np.repeat(largest, np.diff([*starts, len(some)])))
        kept[some[of_bad]] = False
        pending[bad] = np.bincount(track[kept], minlength=n)[bad] >= MIN_LENGTH
        points[bad[~pending[bad]]] = np.nan
    count = np.bincount(track[kept], minlength=n)
    points[(count < MIN_LENGTH) | (_cosine_of_intersection(track, row, kept, points, centers) >= max_cosine)] = np.nan
    return points, kept & np.isfinite(points[track, 0])


def _nearest(starts: I64, rays: F64, centers: F64) -> F64:
    """Points (n, 3) with the least squared distance to their rays, in angle; NaN where the rays are parallel.

    Rows of `rays` and `centers` from one of `starts` to the next belong together. Distances are weighted by the
    inverse distance to the centre, so that angles count: three rounds.
    """
    if len(starts) == 0:
        return np.zeros((0, 3))
    lengths = np.diff([*starts, len(rays)])
    across = np.eye(3) - rays[:, :, None] * rays[:, None, :]
    weight = np.ones(len(rays))
    for _ in range(3):
        weighted = weight[:, None, None] * across
        normal = np.add.reduceat(weighted, starts)
        side = np.add.reduceat(np.einsum("nij,nj->ni", weighted, centers), starts)
        scale = np.add.reduceat(weight, starts)
        solvable = np.linalg.det(normal) > 1e-12 * scale**3
        normal[~solvable] = np.eye(3)
        points = np.linalg.solve(normal, side[:, :, None])[:, :, 0]
        points[~solvable] = np.nan
        distance = np.linalg.norm(np.repeat(points, lengths, axis=0) - centers, axis=1)
        weight = 1.0 / np.maximum(np.where(np.isfinite(distance), distance, 1.0) ** 2, 1e-12)
    found: F64 = points
    return found


def _toward(points: F64, centers: F64) -> F64:
    """Unit vectors (n, 3) from the centres to the points."""
    lines = points - centers
    unit: F64 = lines / np.maximum(np.linalg.norm(lines, axis=1, keepdims=True), 1e-12)
    return unit


def _cosine_of_intersection(track: I64, row: I64, kept: Bool, points: F64, centers: F64) -> F64:
    """Cosine of the angle (n,) under which the kept views of each point lie apart; 1 for points without views.

    Measured from the view that is farthest from the first one, to which the widest pair of a path nearly belongs.
    """
    cosine = np.ones(len(points))
    some = np.flatnonzero(kept & np.isfinite(points[track, 0]))
    if len(some) == 0:
        return cosine
    names, starts = np.unique(track[some], return_index=True)
    lengths = np.diff([*starts, len(some)])
    toward = _toward(points[track[some]], centers[row[some]])
    reference = starts
    for _ in range(2):
        apart = (toward * np.repeat(toward[reference], lengths, axis=0)).sum(axis=1)
        smallest = np.minimum.reduceat(apart, starts)
        at_smallest = np.flatnonzero(apart == np.repeat(smallest, lengths))
        owner = track[some][at_smallest]
        reference = at_smallest[np.unique(owner, return_index=True)[1]]
    cosine[names] = smallest
    return cosine
