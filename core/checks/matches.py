"""Verified matches against the model: is there one rigid scene, and does the model hold together everywhere?

Two views alone say which matches one rigid motion explains; the model says where the two cameras stood. In a right
model of a static scene the two agree for nearly every pair. What bends differently in every frame, or moves on its own,
gives pairs whose matches the model's motion does not explain, although each pair was verified.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.flags import Flag, Severity
from core.geometry.pose import pose_of
from core.viewgraph import PairTable

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MIN_MEDIAN_SHARE = 0.7
MOVED_SHARE = 0.3
"""A pair that fits the model as little as this shows something else than the model."""
MAX_MOVED_PAIRS = 0.1
MIN_PAIRS = 10
TOLERANCE_PX = 4.0
"""Distance from the epipolar curve, at the centre of the picture, up to which a match fits."""
MIN_INLIERS = 30
"""Matches of a pair below which its share says little."""


@dataclass(frozen=True)
class Agreement:
    """How well pairs of registered frames fit the model."""

    pairs: I64
    """(m, 2) frame indices."""
    shares: F64
    """(m,) of their verified matches, those that the model's motion explains."""


def match_agreement(model: pycolmap.Reconstruction, graph: PairTable) -> Agreement:
    """Compare the verified pairs of ``graph.npz`` with a model (`pycolmap.Reconstruction`, image_id = index + 1)."""
    views = {image_id - 1: _View(model, image_id) for image_id in model.reg_image_ids()}
    pairs, shares = [], []
    offsets = graph.offsets
    for row, (first, second) in enumerate(graph.pairs.tolist()):
        start, end = int(offsets[row]), int(offsets[row + 1])
        if end - start < MIN_INLIERS or first not in views or second not in views:
            continue
        matches = graph.inliers[start:end].astype(np.int64)
        angles = _epipolar_angles(views[first], views[second], matches)
        pairs.append((first, second))
        shares.append(float((angles * views[first].focal <= TOLERANCE_PX).mean()))
    return Agreement(np.array(pairs, np.int64).reshape(-1, 2), np.array(shares))


def check_matches(agreement: Agreement) -> list[Flag]:
    """Flags of a model by its pairs.

    Returns:
        `not_static` when a typical pair fits the model badly: no rigid scene explains the video;
        `two_motions` when a typical pair fits and many do not fit at all: what they show moves on its own, or is put
        into the wrong place.
    """
    shares = agreement.shares
    if len(shares) < MIN_PAIRS:
        return []
    typical = float(np.median(shares))
    if typical < MIN_MEDIAN_SHARE:
        return [Flag("not_static", Severity.ERROR, typical, MIN_MEDIAN_SHARE, f"{len(shares)} pairs")]
    moved = shares < MOVED_SHARE
    if moved.mean() <= MAX_MOVED_PAIRS:
        return []
    frames = agreement.pairs[moved]
    where = f"{int(moved.sum())} pairs of frames {frames.min()}-{frames.max()}"
    return [Flag("two_motions", Severity.ERROR, float(moved.mean()), MAX_MOVED_PAIRS, where)]


class _View:
    """Pose and keypoint rays of one registered image."""

    def __init__(self, model: pycolmap.Reconstruction, image_id: int) -> None:
        image = model.image(image_id)
        camera = model.camera(image.camera_id)
        keypoints = np.array([point.xy for point in image.points2D]).reshape(-1, 2)
        rays = np.asarray(camera.cam_ray_from_img(keypoints)).reshape(-1, 3)
        self.rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
        self.pose = pose_of(image)
        self.focal = float(camera.mean_focal_length())


def _epipolar_angles(first: _View, second: _View, matches: I64) -> F64:
    """(n,) rad between each match's rays and the other's epipolar plane, the larger of the two; inf behind a camera."""
    moved = second.pose.relative_to(first.pose)
    rotation, shift = moved.R, moved.t
    length = float(np.linalg.norm(shift))
    a, b = first.rays[matches[:, 0]] @ rotation.T, second.rays[matches[:, 1]]
    if length < 1e-9:
        return np.asarray(np.arccos(np.clip((a * b).sum(axis=1), -1.0, 1.0)))
    direction = shift / length
    return np.maximum(_from_plane(a, b, direction), _from_plane(b, a, direction))


def _from_plane(inside: F64, ray: F64, direction: F64) -> F64:
    """Angles of `ray` off the plane of `inside` and `direction`."""
    normal = np.cross(inside, direction)
    size = np.linalg.norm(normal, axis=1)
    sine = np.abs((normal * ray).sum(axis=1)) / np.maximum(size, 1e-12)
    return np.asarray(np.arcsin(np.clip(sine, 0.0, 1.0)))
