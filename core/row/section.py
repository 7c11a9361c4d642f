"""The section of a row's blades: which side is concave, and where the edges are, by laying all blades onto each other.

The blades are equal, so the points of all of them, each turned back by its number of pitches, show one blade. At a
radius its section is a curve in the plane of height along the axis and arc; the chord runs along the sheet of
`core.row.blades`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, pairwise

import numpy as np
from numpy.typing import NDArray

from core.row.blades import Sheet
from core.row.overlap import sides
from core.row.sample import SurfaceSample
from core.scene.on_row import Side

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

FACING = 0.3
"""Cosine between a normal and that of the sheet, below which a place faces neither way."""
MIDDLE_PERCENT = (10.0, 90.0)
"""Of the chord: nearer to an edge the roundness of the edge bends either side."""
MIN_SAGITTA = 0.015
"""Of the chord that is seen: a side that bends less is flat as far as can be told."""
LEAST_POINTS = 60
"""On a side, or in a strip across the chord that an edge is sought in."""
BANDS = 8
"""Radii at which the edges are sought."""
STRIP_SPACINGS = 3.0
"""Width of the strip at the end of a chord, in spacings of the points."""
END_PERCENT = 2.0
"""What lies beyond is astray."""
BOTH, LEAST_DENSE = 0.1, 0.5
"""The surface goes round an edge where the lesser of both sides has this share of the points in that strip, and the
strip this share of the points that are usual. True edges have 0.15 to 0.5, where the view ends it is up to 0.09."""
TURNED, DENSE = 0.15, 1.0
"""The same where this share of them looks along the chord, and the strip is no thinner than usual. Where the view ends
the faces of a torn border look anywhere (up to 0.7), and points are few (0.3 to 0.85 of what is usual)."""

SHARP = 1.1
"""The same where the strip is denser than usual, whichever way it looks: of an edge that is seen from one side alone.
On the smoothed inspection of 360 frames its leading edge has 1.1 to 1.4 and the border of the view up to 0.8."""


@dataclass(frozen=True)
class Edge:
    """One edge of the blades: its place along the chord as a linear function of the radius."""

    at: float
    """Chord coordinate at the sheet's middle radius, scene units."""
    slope: float
    """Change of it with the radius."""
    sigma: float
    """Standard deviation of the coordinate."""

    def chord(self, from_middle: F64) -> F64:
        """(n,) chord coordinate of the edge at (n,) radii, given less the middle one."""
        found: F64 = self.at + self.slope * from_middle
        return found


@dataclass(frozen=True)
class Section:
    """What is known of the section that all blades share."""

    sides: Mapping[int, Side]
    """Of the side that faces growing angles (1) and of that facing falling ones (-1)."""
    edges: Mapping[str, Edge | None]
    """`a`, the edge lower along the axis, and `b`; None where what was seen does not reach round it."""


def on_sheet(sheet: Sheet, points: F64) -> tuple[F64, F64, F64]:
    """(n,) coordinates along the chord and across it, and radii less the sheet's middle one, scene units.

    Zero of the first two is the middle of the sheet of the nearest blade.
    """
    _, radius, height = sheet.axis.cylinder(points)
    position = sheet.position(points)
    z, rho = height - sheet.middle[0], radius - sheet.middle[1]
    terms = np.stack([z, rho, z**2, z * rho, rho**2], axis=1)
    arc = ((position - np.round(position)) * sheet.pitch_rad + terms @ sheet.lean) * radius
    slope = _slope(sheet, radius, rho)
    length = np.hypot(1.0, slope)
    lifted = arc - (sheet.lean[1] * rho + sheet.lean[4] * rho**2) * radius
    return (z + slope * lifted) / length, (lifted - slope * z) / length, rho


def _slope(sheet: Sheet, radius: F64, rho: F64) -> F64:
    """(n,) arc per height of the chord."""
    slope: F64 = radius * (sheet.lean[0] + sheet.lean[3] * rho)
    return slope


def facing(sheet: Sheet, points: F64, normals: F64) -> F64:
    """(n,) cosine between normals and that of the sheet, which looks towards growing angles."""
    _, radius, height = sheet.axis.cylinder(points)
    z, rho = height - sheet.middle[0], radius - sheet.middle[1]
    along_z = radius * (sheet.lean[0] + 2.0 * sheet.lean[2] * z + sheet.lean[3] * rho)
    along_r = radius * (sheet.lean[1] + sheet.lean[3] * z + 2.0 * sheet.lean[4] * rho)
    normal = sheet.axis.tangential(points) - along_z[:, None] * sheet.axis.direction
    normal = normal - along_r[:, None] * sheet.axis.radial(points)
    cosine: F64 = (normal * normals).sum(axis=1) / np.linalg.norm(normal, axis=1)
    return cosine


def section_of(sheet: Sheet, sample: SurfaceSample) -> Section:
    """The section of the blades that a sample shows."""
    on_blade = sides(sample, sheet.axis)
    chord, across, rho = on_sheet(sheet, on_blade.points)
    cosine = facing(sheet, on_blade.points, on_blade.normals)
    bends = {way: _bend(chord, across, rho, way * cosine > FACING, way) for way in (1, -1)}
    edges = {name: _edge(chord, rho, cosine, on_blade.spacing, end) for name, end in (("a", -1), ("b", 1))}
    return Section(_sides(bends), edges)


def _bend(chord: F64, across: F64, rho: F64, own: Flags, way: int) -> float | None:
    """How far the middle of a side stands out from its ends, over the chord; None where hardly any of it is seen."""
    if own.sum() < LEAST_POINTS:
        return None
    low, high = np.percentile(chord[own], MIDDLE_PERCENT)
    own = own & (chord > low) & (chord < high)
    x, rest = chord[own] - chord[own].mean(), across[own]
    terms = np.stack([np.ones_like(x), x, x**2, rho[own], rho[own] * x, rho[own] ** 2], axis=1)
    weight = np.ones_like(x)
    found = np.zeros(6)
    for _ in range(8):
        found = np.linalg.lstsq(terms * weight[:, None], rest * weight, rcond=None)[0]
        residual = rest - terms @ found
        scale = max(1.4826 * float(np.median(np.abs(residual))), 1e-300)
        weight = 1.0 / np.sqrt(1.0 + (residual / (2.0 * scale)) ** 2)
    seen = float(high - low)
    return -way * float(found[2]) * (seen / 2) ** 2 / seen


def _sides(bends: Mapping[int, float | None]) -> dict[int, Side]:
    """Concave and convex by the bends; a blade has one of each at most, so two alike tell nothing."""
    found = {}
    for way, bend in bends.items():
        found[way] = Side.UNKNOWN
        if bend is not None and abs(bend) > MIN_SAGITTA:
            found[way] = Side.CONVEX if bend > 0 else Side.CONCAVE
    if found[1] == found[-1]:
        return {1: Side.UNKNOWN, -1: Side.UNKNOWN}
    for way in (1, -1):
        if found[way] == Side.UNKNOWN and found[-way] == Side.CONCAVE:
            found[way] = Side.CONVEX
    return found


def _edge(chord: F64, rho: F64, cosine: F64, spacing: float, end: int) -> Edge | None:
    """The edge at one end (-1 low, 1 high) of the chord, where the surface goes round it at most of the radii."""
    bounds = np.percentile(rho, np.linspace(0.0, 100.0, BANDS + 1))
    places = []
    for low, high in pairwise(bounds.tolist()):
        own = (rho >= low) & (rho <= high)
        if own.sum() < LEAST_POINTS:
            continue
        last = float(np.percentile(end * chord[own], 100.0 - END_PERCENT))
        strip = own & (end * chord > last - STRIP_SPACINGS * spacing)
        dense = strip.sum() / (STRIP_SPACINGS * _usual_count(chord[own], spacing))
        both = min(float((way * cosine[strip] > FACING).mean()) for way in (1, -1))
        turned = float((np.abs(cosine[strip]) < 2.0 * FACING).mean())
        if dense > SHARP or (both > BOTH and dense > LEAST_DENSE) or (turned > TURNED and dense > DENSE):
            places.append((float(np.median(rho[own])), end * last))
    if len(places) <= BANDS / 2:
        return None
    x, y = np.array(places).T
    # The median of the slopes between all pairs (Theil 1950, Sen 1968): a band where it is torn does not count.
    slope = float(np.median([(y[j] - y[i]) / (x[j] - x[i]) for i, j in combinations(range(len(x)), 2)]))
    at = float(np.median(y - slope * x))
    scatter = 1.4826 * float(np.median(np.abs(y - at - slope * x)))
    return Edge(at, slope, float(np.hypot(scatter, spacing)))


def _usual_count(chord: F64, spacing: float) -> float:
    """Points within one spacing along the chord, about the median point: what strays off the blade counts little."""
    cell = np.floor((chord - chord.min()) / spacing).astype(np.int64)
    return float(np.median(np.bincount(cell)[cell]))
