"""First guesses of a row: motions that carry what one camera saw onto what another saw alike.

The path of the camera alone does not tell the axis, because the probe moves too; a motion between two views that puts
blade upon blade does, once it is fitted to the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.geometry.pose import transform
from core.row.overlap import Hypothesis, contrast, partners
from core.row.sample import SurfaceSample
from core.row.turn import screw_of

F64 = NDArray[np.float64]

PAIRS = 240
MOVED = 600
"""Points of the coarse sample that a motion is fitted with, to all of it."""
STEPS = 14
KEPT = 4
FEW_PITCHES = (1, 2, 3)
"""A motion may carry a blade by so many pitches."""
PITCH_RANGE_RAD = (np.radians(2.0), np.radians(50.0))
"""From 180 blades in a row down to 7."""
MAX_SHIFT_SHARE = 0.25
"""Of the arc of the turn: a larger shift along the axis is no turn of a row."""
MAX_RADIUS_SIZES = 20.0
"""An axis farther off than so many sizes of the surface is a shift, not a turn."""
ALIKE_DIRECTION = np.cos(np.radians(8.0))
ALIKE_PITCH = 0.08


def pairs_of_views(count: int, pairs: int = PAIRS) -> list[tuple[int, int]]:
    """Ordered pairs (i, j), i < j, of `count` views in order of time, evenly over all distances between them."""
    every = [(i, i + step) for step in range(1, count) for i in range(count - step)]
    if len(every) <= pairs:
        return every
    return [every[k] for k in np.linspace(0, len(every) - 1, pairs).round().astype(int)]


def seeds(sample: SurfaceSample, rotations: F64, translations: F64) -> list[Hypothesis]:
    """The rows of best contrast that the motions between views lead to, best first, at most `KEPT` different ones.

    Args:
        sample: a coarse one.
        rotations: (f, 3, 3) cam_from_world in order of time.
        translations: (f, 3)
    """
    found: list[tuple[float, Hypothesis]] = []
    for i, j in pairs_of_views(len(rotations)):
        rotation = rotations[j].T @ rotations[i]
        fitted = _fitted(sample, rotation, rotations[j].T @ (translations[i] - translations[j]))
        found += [(contrast(sample, row), row) for row in _rows_of(sample, *fitted)]
    found.sort(key=lambda item: -item[0])
    return _different([row for _, row in found])


def _fitted(sample: SurfaceSample, rotation: F64, translation: F64) -> tuple[F64, F64]:
    """A motion fitted to the surface point to plane (Chen and Medioni 1992), with Cauchy weights that narrow."""
    some = slice(None, None, max(1, len(sample) // MOVED))
    points, facing = sample.points[some], sample.normals[some]
    middle = points.mean(axis=0)
    widths = np.geomspace(4.0, 0.5, STEPS) * sample.spacing
    for width in widths:
        moved = transform(points, rotation, translation)
        found = partners(moved, facing @ rotation.T, sample)
        use = np.flatnonzero(found.fits & (np.abs(found.across) < 6.0 * width))
        if len(use) < 30:
            break
        normals, residual = sample.normals[found.rows[use]], found.across[use]
        arms = moved[use] - middle
        jacobian = np.hstack([np.cross(arms, normals), normals])
        weight = 1.0 / (1.0 + (residual / width) ** 2)
        weighted = jacobian * weight[:, None]
        size = max(float((arms**2).sum(axis=1).mean()), 1e-300)
        damping = 1e-3 * weight.sum() * np.diag([size, size, size, 1.0, 1.0, 1.0])
        step = -np.linalg.solve(weighted.T @ jacobian + damping, weighted.T @ residual)
        turn = Rotation.from_rotvec(step[:3]).as_matrix()
        rotation, translation = turn @ rotation, turn @ (translation - middle) + middle + step[3:]
    return rotation, translation


def _rows_of(sample: SurfaceSample, rotation: F64, translation: F64) -> list[Hypothesis]:
    screw = screw_of(rotation, translation)
    if screw is None:
        return []
    axis = screw.axis.nearest_to(sample.points.mean(axis=0))
    radius = float(np.median(axis.cylinder(sample.points)[1]))
    size = float(np.linalg.norm(np.ptp(sample.points, axis=0)))
    if radius > MAX_RADIUS_SIZES * size or abs(screw.shift) > MAX_SHIFT_SHARE * screw.angle_rad * radius:
        return []
    low, high = PITCH_RANGE_RAD
    pitches = [screw.angle_rad / few for few in FEW_PITCHES]
    return [Hypothesis(axis, pitch) for pitch in pitches if low <= pitch <= high]


def _different(rows: Sequence[Hypothesis]) -> list[Hypothesis]:
    """The first of every group of rows that are alike."""
    kept: list[Hypothesis] = []
    for row in rows:
        if len(kept) < KEPT and not any(_alike(row, other) for other in kept):
            kept.append(row)
    return kept


def _alike(one: Hypothesis, other: Hypothesis) -> bool:
    """Whether two rows have nearly one axis and pitch."""
    parallel = abs(float(one.axis.direction @ other.axis.direction)) > ALIKE_DIRECTION
    return parallel and abs(one.pitch_rad / other.pitch_rad - 1.0) < ALIKE_PITCH
