"""`weak_join`: the place where a model hangs together by the fewest points.

Registered images and reprojection errors do not see it: two halves that share a handful of points, or points that do
not move in the picture and so fix nothing, fit as well as one model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.flags import Flag, Severity, between_frames

if TYPE_CHECKING:
    import pycolmap

I64 = NDArray[np.int64]
F64 = NDArray[np.float64]

MIN_MOTION_PX = 3.0
"""A point whose keypoints all lie within this of each other has no parallax to show."""
WEAK_POINTS = 30
"""Fewer across a cut: COLMAP's least for registering an image."""
BROKEN_POINTS = 10


@dataclass(frozen=True)
class Tracks:
    """Where each point is first and last seen, and how far it moves in the picture between."""

    first: I64
    """(n,) frame index."""
    last: I64
    motion_px: F64
    """(n,) diagonal of the box around its keypoints."""


def tracks_of(model: pycolmap.Reconstruction) -> Tracks:
    """Of all points of a model (`pycolmap.Reconstruction`, image_id = index + 1)."""
    point, frame, xy = [], [], []
    for image_id in model.reg_image_ids():
        for keypoint in model.image(image_id).get_observation_points2D():
            point.append(keypoint.point3D_id)
            frame.append(image_id - 1)
            xy.append(keypoint.xy)
    if not point:
        return Tracks(np.zeros(0, np.int64), np.zeros(0, np.int64), np.zeros(0))
    order = np.argsort(np.array(point), kind="stable")
    _, starts = np.unique(np.array(point)[order], return_index=True)
    frames, places = np.array(frame, np.int64)[order], np.array(xy)[order]
    low, high = np.minimum.reduceat(places, starts), np.maximum.reduceat(places, starts)
    return Tracks(
        np.minimum.reduceat(frames, starts),
        np.maximum.reduceat(frames, starts),
        np.asarray(np.linalg.norm(high - low, axis=1)),
    )


def points_across(tracks: Tracks, frames: I64, least_motion_px: float = MIN_MOTION_PX) -> I64:
    """(n - 1,) points seen both up to each of the (n,) rising frames and after it that move at least so far.

    The points of a stall count by what they do before or after it.
    """
    moving = tracks.motion_px >= least_motion_px
    begins = np.searchsorted(np.sort(tracks.first[moving]), frames[:-1], side="right")
    ended = np.searchsorted(np.sort(tracks.last[moving]), frames[:-1], side="right")
    return np.asarray(begins - ended, np.int64)


def check_joins(tracks: Tracks, frames: I64, n_search: int) -> Flag | None:
    """`weak_join` at the cut with the fewest moving points, when these are too few.

    It is an error only where hardly any point, moving or not, reaches across: while the rotor stands, nothing moves.

    Args:
        tracks: of the model.
        frames: (n,) registered frames, rising.
        n_search: frames from this on are out of order and make no cut.
    """
    ordered = frames[frames < n_search]
    if len(ordered) < 2:
        return None
    across = points_across(tracks, ordered)
    weakest = int(np.argmin(across))
    if across[weakest] >= WEAK_POINTS:
        return None
    broken = points_across(tracks, ordered, 0.0).min() < BROKEN_POINTS
    severity = Severity.ERROR if broken else Severity.WARNING
    where = between_frames(ordered[weakest], ordered[weakest + 1])
    return Flag("weak_join", severity, float(across[weakest]), float(WEAK_POINTS), where)
