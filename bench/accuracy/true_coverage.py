"""What frames truly show of every blade, on the true surface with the true cameras."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.accuracy.surface import drawn_on
from bench.accuracy.true_row import TrueRow
from bench.accuracy.truth import Truth
from core.mapping.surface import Surface

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Flags = NDArray[np.bool_]

RADIAL_COSINE = 0.8
"""A normal nearer than this to the radial direction is that of a ring, or of a tip."""
USABLE_COSINE = 0.5
"""Of the angle between the surface's normal and the way to the camera: 60 degrees."""
GRAZING_COSINE = 0.17
"""80 degrees: what is seen at less is not reconstructed."""
OWN_MM = 0.1
"""What lies so near before a place is the place itself."""
LEAST_VIEWS = (2, 3, 5)
POINTS = 12_000
"""Of the true surface, that coverage is counted on."""
MOST_VIEWS = 120
"""Frames beyond are thinned evenly, and the counts are of those that are left."""
LEAST_SHARE = 0.05
"""A blade that shows less of itself than this share of what the best one shows was not seen."""


@dataclass(frozen=True)
class TrueCoverage:
    """How well one blade was looked at."""

    share: float
    """Of the surface that the blade with most shows to two frames at all, what this one shows, in [0, 1]."""
    by_views: dict[int, float]
    """Of that surface of its own the share that at least so many frames see at 60 degrees or less."""


def true_sightings(truth: Truth, points: F64, normals: F64, frames: Sequence[int]) -> tuple[Flags, Flags]:
    """(n, f) whether a frame sees a point at all, and whether at a usable angle.

    Args:
        truth: cameras and surface.
        points: (n, 3) of the surface, mm.
        normals: (n, 3) unit, of either sign: the back of a solid is hidden by its front.
        frames: f source frames.
    """
    surface = Surface(truth.vertices, truth.faces)
    x0, y0, x1, y1 = truth.roi
    low = np.array([x0 * truth.lens.width, y0 * truth.lens.height])
    high = np.array([x1 * truth.lens.width, y1 * truth.lens.height])
    at_all, usable = np.zeros((2, len(points), len(frames)), bool)
    for k, frame in enumerate(frames):
        center = truth.centers[frame]
        xy = truth.lens.project((points - center) @ truth.rotations[frame])
        way = center - points
        cosine = np.abs((way * normals).sum(axis=1)) / np.linalg.norm(way, axis=1)
        # A point that no pixel shows has no place on the picture, and is within no bounds.
        rows = np.flatnonzero(((xy >= low) & (xy < high)).all(axis=1) & (cosine > GRAZING_COSINE))
        clear = surface.clear(np.broadcast_to(center, (len(rows), 3)), points[rows], OWN_MM)
        at_all[rows[clear], k] = True
        usable[:, k] = at_all[:, k] & (cosine > USABLE_COSINE)
    return at_all, usable


def true_coverage(truth: Truth, row: TrueRow, frames: Sequence[int], seed: int = 0) -> dict[int, TrueCoverage]:
    """Coverage of every blade that the frames show, by its true number.

    Args:
        truth: cameras and surface.
        row: the truth's.
        frames: source frames, rising.
        seed: of the points drawn.
    """
    points, normals = _drawn(truth, seed)
    if not len(points):
        return {}
    at_all, usable = true_sightings(truth, points, normals, _thinned(frames))
    shown = at_all.sum(axis=1) >= 2
    blades, counts = np.unique(row.blade(points[shown]), return_counts=True)
    found = {}
    for blade, count in zip(blades.tolist(), counts.tolist(), strict=True):
        if count >= LEAST_SHARE * int(counts.max()):
            own = usable[shown][row.blade(points[shown]) == blade].sum(axis=1)
            by_views = {least: float((own >= least).mean()) for least in LEAST_VIEWS}
            found[int(blade)] = TrueCoverage(count / int(counts.max()), by_views)
    return found


def _thinned(frames: Sequence[int]) -> list[int]:
    chosen = np.linspace(0, len(frames) - 1, min(len(frames), MOST_VIEWS)).round().astype(int)
    return [frames[k] for k in chosen]


def _drawn(truth: Truth, seed: int) -> tuple[F64, F64]:
    """Points evenly over the sides of the true blades, with unit normals; none of a hub alone."""
    corners = truth.vertices[truth.faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = cross / np.maximum(np.linalg.norm(cross, axis=1, keepdims=True), 1e-300)
    middle = corners.mean(axis=1)
    outward = middle * np.array([1.0, 1.0, 0.0]) / np.hypot(middle[:, :1], middle[:, 1:2])
    sides = np.flatnonzero(np.abs((outward * normals).sum(axis=1)) <= RADIAL_COSINE)
    if not len(sides):
        return np.zeros((0, 3)), np.zeros((0, 3))
    rows, points = drawn_on(corners[sides], POINTS, seed)
    return points, normals[sides][rows]
