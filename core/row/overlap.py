"""How well a surface fits itself after a turn: the measure that a row of blades is found by.

Regular structures show as turns under which a shape maps onto itself (Mitra, Guibas and Pauly, SIGGRAPH 2006; Pauly et
al., SIGGRAPH 2008). The overlap alone is largest for no turn at all, so the pitch is the turn with the best contrast:
overlap after one and two pitches, less that half way between blades. A surface of revolution, such as a hub, overlaps
after every turn alike and has none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.row.sample import SurfaceSample
from core.row.turn import Axis

F64 = NDArray[np.float64]

KERNEL_SHARE = 0.06
"""Width of the kernel across the surface, of the arc from blade to blade."""
KERNEL_SPACINGS = 0.5
"""The least width: what lies between the points of a sample cannot be told apart better."""
REACH_SPACINGS = 2.0
"""A point has a partner when one lies within so many spacings along the surface."""
MIN_COSINE = 0.7
"""Of the angle between the normals of partners."""
RADIAL_COSINE = 0.8
"""A normal nearer than this to the radial direction is that of a hub, a casing, a shroud or a tip."""
LEAST_SIDES = 0.05
"""Of the points: with fewer on sides of blades there is nothing to compare."""


@dataclass(frozen=True)
class Hypothesis:
    """A row: turned about this axis by this angle, the surface should fit itself."""

    axis: Axis
    pitch_rad: float

    def kernel(self, sample: SurfaceSample) -> float:
        """Width of the overlap's kernel, scene units."""
        radius = float(np.median(self.axis.cylinder(sample.points)[1]))
        return max(KERNEL_SHARE * self.pitch_rad * radius, KERNEL_SPACINGS * sample.spacing)


@dataclass(frozen=True)
class Partners:
    """For turned points of a sample their partners in it."""

    rows: NDArray[np.int64]
    """(n,) of the nearest point."""
    across: F64
    """(n,) signed distance from its plane, scene units."""
    fits: NDArray[np.bool_]
    """(n,) whether it is near enough along the surface and faces the same way."""


def partners(points: F64, normals: F64, sample: SurfaceSample) -> Partners:
    """Nearest points of a sample to (n, 3) points with (n, 3) unit normals."""
    rows = np.asarray(sample.tree.query(points)[1], np.int64)
    away = points - sample.points[rows]
    across = (away * sample.normals[rows]).sum(axis=1)
    along = np.sqrt(np.maximum((away**2).sum(axis=1) - across**2, 0.0))
    facing = (normals * sample.normals[rows]).sum(axis=1) > MIN_COSINE
    return Partners(rows, across, facing & (along < REACH_SPACINGS * sample.spacing))


def overlap(sample: SurfaceSample, axis: Axis, angles_rad: Sequence[float], kernel: float) -> F64:
    """(k,) share of the surface that lies on itself after each turn, in [0, 1]."""
    points = np.concatenate([axis.turned(sample.points, angle) for angle in angles_rad])
    normals = np.concatenate([sample.normals @ axis.matrix(angle).T for angle in angles_rad])
    found = partners(points, normals, sample)
    weight = np.where(found.fits, np.exp(-((found.across / kernel) ** 2)), 0.0)
    shares: F64 = weight.reshape(len(angles_rad), -1).mean(axis=1)
    return shares


def radial(axis: Axis, points: F64, normals: F64) -> NDArray[np.bool_]:
    """(n,) whether a surface faces the axis, or away from it: the hub, a casing, a shroud, the tips."""
    flags: NDArray[np.bool_] = np.abs((axis.radial(points) * normals).sum(axis=1)) > RADIAL_COSINE
    return flags


def sides(sample: SurfaceSample, axis: Axis) -> SurfaceSample:
    """Those of the points that face neither the axis nor away from it.

    A hub lies on itself after every turn, so where much of it is seen it would hide how the blades repeat.
    """
    return sample.of(~radial(axis, sample.points, sample.normals))


CONTRAST_TURNS = (1.0, 2.0, 0.5, 1.5)


def contrast(sample: SurfaceSample, row: Hypothesis) -> float:
    """(s(p) + s(2p) - s(p/2) - s(3p/2)) / 2 of the overlap s of the blades' sides at the pitch p; 0 without sides."""
    blades = sides(sample, row.axis)
    if len(blades) < LEAST_SIDES * len(sample):
        return 0.0
    return _contrast(blades, row)


def _contrast(sample: SurfaceSample, row: Hypothesis) -> float:
    one, two, half, half_on = overlap(
        sample, row.axis, [turn * row.pitch_rad for turn in CONTRAST_TURNS], row.kernel(sample)
    )
    return float(one + two - half - half_on) / 2
