"""First guesses of a row: motions that carry what one camera saw onto what another saw alike.

The path of the camera alone does not tell the axis, because the probe moves too; a motion between two views that puts
blade upon blade does, once it is fitted to the surface.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.geometry.similarity import Similarity
from core.row.motion import fitted_motion
from core.row.overlap import Hypothesis, contrast
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
    moving = sample.of(np.arange(0, len(sample), max(1, len(sample) // MOVED)))
    widths = np.geomspace(4.0, 0.5, STEPS) * sample.spacing
    for i, j in pairs_of_views(len(rotations)):
        rotation = rotations[j].T @ rotations[i]
        start = Similarity(1.0, rotation, rotations[j].T @ (translations[i] - translations[j]))
        motion = fitted_motion(sample, moving, start, widths, moving.points.mean(axis=0))
        found += [(contrast(sample, row), row) for row in _rows_of(sample, motion)]
    found.sort(key=lambda item: -item[0])
    return _different([row for _, row in found])


def _rows_of(sample: SurfaceSample, motion: Similarity) -> list[Hypothesis]:
    screw = screw_of(motion.rotation, motion.shift)
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
