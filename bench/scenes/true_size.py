"""True sizes of a scene's defects: of the part of each that its frames show, on the true surface."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, QhullError, cKDTree

from bench.accuracy.surface import drawn_on
from bench.scenes.blades import DENT_DEPTH, Defect, Row, pitch_rad, surface_point
from bench.scenes.render import defects_at
from bench.scenes.spec import Scene

F64 = NDArray[np.float64]

MM = 1e-3
"""Metres."""
SAMPLES = 4000
"""Of the surface around a defect, for its area."""
SEEN_MM = 0.3
"""A sample counts as seen with a pixel's point at most so far away."""
_STEP = 0.01
REACH = 1.3
"""The surface around a defect, in radii."""


def true_size(scene: Scene, defect: Defect, seen: F64, row: Row) -> dict[str, Any]:
    """``length_m``, ``width_m``, ``area_m2`` and, of a dent, ``depth_m``; all None where no frame shows it.

    The length is the largest distance between two of the points seen, the width their extent across it in the plane
    that fits them best, the area that of the true surface which belongs to the defect and was seen.

    Args:
        scene: that it is a defect of.
        defect: the defect.
        seen: (n, 3) points of it that pixels show, mm.
        row: the true surface.
    """
    if len(seen) < 20:
        return dict.fromkeys(("length_m", "width_m", "area_m2", "depth_m"))
    ends = _hull(seen)
    between = np.linalg.norm(ends[:, None] - ends[None], axis=2)
    a, b = np.unravel_index(int(between.argmax()), between.shape)
    along = (ends[b] - ends[a]) / between[a, b]
    normal = np.linalg.svd(seen - seen.mean(axis=0), full_matrices=False)[2][2]
    across = np.cross(normal, along)
    offset = seen @ (across / np.linalg.norm(across))
    area = _area(defect, seen, row, pitch_rad(scene))
    depth = _dent_depth(scene, defect) * MM if defect.kind == "dent" else None
    length, width = float(between[a, b]), float(offset.max() - offset.min())
    return {"length_m": length * MM, "width_m": width * MM, "area_m2": area * MM**2, "depth_m": depth}


def _dent_depth(scene: Scene, defect: Defect) -> float:
    """Of the deepest point below the undamaged surface, mm: the metal is pushed in aslant to it."""
    blade, span, chord, side = defect.blade, defect.span, defect.chord, defect.side
    inward = surface_point(scene, blade, span, chord, -side) - defect.center
    up = surface_point(scene, blade, span + _STEP, chord, side) - surface_point(scene, blade, span - _STEP, chord, side)
    on = surface_point(scene, blade, span, chord + _STEP, side) - surface_point(scene, blade, span, chord - _STEP, side)
    normal = np.cross(up, on)
    aslant = abs(float(inward @ normal)) / float(np.linalg.norm(inward) * np.linalg.norm(normal))
    return DENT_DEPTH * defect.radius_mm * aslant


def _hull(points: F64) -> F64:
    try:
        return np.asarray(points[ConvexHull(points).vertices])
    except QhullError:  # all in one plane
        return points[:: max(1, len(points) // 500)]


def _area(defect: Defect, seen: F64, row: Row, pitch: float) -> float:
    """By samples that are spread evenly over the surface around the defect, mm^2."""
    middle = row.vertices[row.faces].mean(axis=1)
    corners = row.vertices[row.faces[np.linalg.norm(middle - defect.center, axis=1) <= REACH * defect.radius_mm + 1.0]]
    size = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2
    _, points = drawn_on(corners, SAMPLES, defect.number)
    own = defects_at(points, np.ones(SAMPLES, bool), (defect,), pitch) == defect.number
    near = cKDTree(seen).query(points)[0] <= SEEN_MM
    return float(size.sum() * (own & near).mean())
