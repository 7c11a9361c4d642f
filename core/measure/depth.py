"""How deep the surface of a finding lies below a smooth one through what is around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.measure.shape import Region

F64 = NDArray[np.float64]

RING = (0.08, 0.55)
"""The ring around a region begins and ends at these shares of its length outside its border."""
CORE = 0.02
"""The deepest share of the region that the depth is the median of: one vertex is no bottom."""
SECTORS, MIN_SECTORS = 8, 8
"""The ring has to lie on all sides: beyond an edge nothing says how the surface would go on."""
MIN_POINTS = 40
ROUNDS = 3
"""Of reweighting: points farther off than three robust deviations count less (Huber's weights)."""
STANDS_OUT = 3.0
"""A depth counts above this many times the roughness."""
SMOOTH = 0.08
"""Standard deviation of a depth over the depth: an aerofoil is no quadric, and the deepest spot has a size."""
GLINT = 95.0
"""Percentile of the brightness of the ring that the bottom of a depth does not exceed. The light of a borescope sits at
its tip, and what shiny metal reflects of it lies before or behind the metal by half the radius of its bend: the
reflection on a bump is matched across the views like a mark on the bottom of a hollow."""
BUMP = 0.5
"""A region whose highest spot rises by more than this share of its depth is neither a hollow nor a bump."""
_MAD = 1.4826


@dataclass(frozen=True)
class Depth:
    """A depth with its standard deviation, scene units."""

    value: float
    sigma: float


def depth_of(region: Region, level: F64, smallest: float, brightness: F64 | None = None) -> Depth | None:
    """The depth of a region, None where it is not known.

    It is not where it does not stand out from the roughness, where the ring around is not whole, where the region also
    rises, and where its bottom is brighter than what is around: that is a reflection and not the surface.

    The smooth surface is a quadric height field over the tangent plane, z = a + b x + c y + d x^2 + e x y + f y^2,
    fitted to the ring by robust least squares.

    Args:
        region: the finding.
        level: (n,) of all vertices of its patch, scene units; NaN where no view sees one.
        smallest: roughness that a surface of this spacing has at least, scene units.
        brightness: (n,) of all vertices of its patch, in any unit; None where the surface has no colours.
    """
    patch, length = region.patch, region.straight.length
    local = (patch.vertices - region.middle) @ _frame(region).T
    faces_up = (patch.normals @ region.normal) > 0.3
    ring = faces_up & np.isfinite(level) & (level < -RING[0] * length) & (level > -RING[1] * length)
    inside = region.level > 0
    if ring.sum() < MIN_POINTS or not _all_around(local[ring]):
        return None
    fit = _fit(local[ring])
    residual = local[:, 2] - _terms(local) @ fit
    roughness = max(_MAD * float(np.median(np.abs(residual[ring]))), smallest)
    ordered = np.flatnonzero(inside)[np.argsort(residual[inside], kind="stable")]
    few = max(3, round(CORE * len(ordered)))
    bottom, top = ordered[:few], ordered[-few:]
    value = -float(np.median(residual[bottom]))
    if value <= STANDS_OUT * roughness or float(np.median(residual[top])) > BUMP * value:
        return None
    if brightness is not None and np.median(brightness[bottom]) > np.percentile(brightness[ring], GLINT):
        return None
    return Depth(value, float(np.hypot(roughness, SMOOTH * value)))


def _frame(region: Region) -> F64:
    """(3, 3) rows: along the length, across it, outwards."""
    low, high = region.straight.ends
    along = region.border[high] - region.border[low]
    normal = region.normal
    along = along - (along @ normal) * normal
    along = along / max(float(np.linalg.norm(along)), 1e-300)
    return np.stack([along, np.cross(normal, along), normal])


def _all_around(ring: F64) -> bool:
    sector = ((np.arctan2(ring[:, 1], ring[:, 0]) + np.pi) / (2.0 * np.pi) * SECTORS).astype(int) % SECTORS
    return len(np.unique(sector)) >= MIN_SECTORS


def _terms(local: F64) -> F64:
    x, y = local[:, 0], local[:, 1]
    return np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)


def _fit(local: F64) -> F64:
    terms, height = _terms(local), local[:, 2]
    weight: F64 = np.ones(len(height))
    found: F64 = np.zeros(terms.shape[1])
    for _ in range(ROUNDS):
        found = np.asarray(np.linalg.lstsq(terms * weight[:, None], height * weight, rcond=None)[0], np.float64)
        off = np.abs(height - terms @ found)
        spread = max(_MAD * float(np.median(off)), 1e-300)
        weight = np.sqrt(np.minimum(1.0, 3.0 * spread / np.maximum(off, 1e-300)))
    return np.asarray(found, np.float64)
