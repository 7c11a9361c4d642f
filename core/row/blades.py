"""Blades of a row told apart: the angle of a blade as a function of place, and the blades that are seen.

In cylinder coordinates about the axis a blade is a sheet ``theta = g(z, r) + k p``: g is a quadratic function, one for
all blades, found by the concentration of the angles left over (the mean resultant length of circular statistics) on
each of their two sides.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from core.row.overlap import Hypothesis, sides
from core.row.sample import SurfaceSample
from core.row.turn import Axis

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Flags = NDArray[np.bool_]

SLOPES = np.linspace(-2.0, 2.0, 9)
"""Trial slopes of the angle, in pitches over the standard deviation of the place; squared 81 pairs."""
BINS, SMOOTHED = 60, 4
"""Of the histogram of phases, and bins to each side that smooth it."""
STARTS, EVALUATIONS = 8, 600
"""Trial slopes that the lean is sought from, and evaluations from each: several optima are local ones."""
LEAST_SHARE = 0.02
"""Of the points on blades: what has fewer is no blade that was seen."""
LEAST_POINTS = 12


@dataclass(frozen=True)
class Sheet:
    """The angle of blade 0 as a function of height and radius."""

    axis: Axis
    pitch_rad: float
    lean: F64
    """(5,) rad per unit, and per unit squared: of height, radius, height squared, both, radius squared."""
    middle: tuple[float, float]
    """Height and radius where the terms are zero."""
    start_rad: float
    """Angle of blade 0 there."""
    cut_rad: float
    """Opposite to it angles are cut: the row that is seen lies within half a turn of it."""

    def position(self, points: F64) -> F64:
        """(n,) number of pitches from blade 0, not rounded."""
        angle, radius, height = self.axis.cylinder(points)
        terms = _terms(height - self.middle[0], radius - self.middle[1])
        turned = np.angle(np.exp(1j * (angle - self.cut_rad))) + self.cut_rad
        position: F64 = (turned - terms @ self.lean - self.start_rad) / self.pitch_rad
        return position

    def blade(self, points: F64) -> I64:
        """(n,) the nearest blade's index."""
        blade: I64 = np.round(self.position(points)).astype(np.int64)
        return blade


def fit_sheet(sample: SurfaceSample, row: Hypothesis) -> Sheet:
    """The sheet that most of the blades' points agree on."""
    on_blade = sides(sample, row.axis)
    angle, radius, height = row.axis.cylinder(on_blade.points)
    middle = (float(np.median(height)), float(np.median(radius)))
    terms = _terms(height - middle[0], radius - middle[1])
    spread = np.maximum(terms.std(axis=0), 1e-12)
    scaled = terms / spread
    phase = angle / row.pitch_rad
    # Each side of the blades by itself: together, a blade's back may be laid onto its neighbour's front. Both count: a
    # wrong lean may lay what many blades show of one side onto each other, and scatters the other side.
    ahead = (row.axis.tangential(on_blade.points) * on_blade.normals).sum(axis=1) > 0

    def off(lean: F64) -> float:
        turned = np.exp(2j * np.pi * (phase - scaled @ lean))
        return -float(np.abs(turned[ahead].sum()) + np.abs(turned[~ahead].sum())) / len(turned)

    trials = [np.array([a, b, 0.0, 0.0, 0.0]) for a in SLOPES for b in SLOPES]
    lean = min((_descended(off, first) for first in sorted(trials, key=off)[:STARTS]), key=off)
    cut = float(np.angle(np.exp(1j * angle).mean()))
    start = (_emptiest(phase - scaled @ lean) + 0.5) * row.pitch_rad
    start += round((cut - start) / row.pitch_rad) * row.pitch_rad
    return Sheet(row.axis, row.pitch_rad, lean / spread * row.pitch_rad, middle, start, cut)


def _descended(off: Callable[[F64], float], first: F64) -> F64:
    """The best lean near a first one (Nelder and Mead 1965)."""
    simplex = np.vstack([first, first + np.diag([0.2, 0.2, 0.1, 0.1, 0.1])])
    found = minimize(off, first, method="Nelder-Mead", options={"maxfev": EVALUATIONS, "initial_simplex": simplex})
    return np.asarray(found.x, np.float64)


def _emptiest(phase: F64) -> float:
    """The fractional part that the fewest phases are near: between blades, whose two sides fill most of a pitch."""
    counts, edges = np.histogram(phase % 1.0, bins=BINS, range=(0.0, 1.0))
    wide = np.convolve(
        np.concatenate([counts[-SMOOTHED:], counts, counts[:SMOOTHED]]), np.hanning(2 * SMOOTHED + 3)[1:-1]
    )
    smooth = wide[2 * SMOOTHED : 2 * SMOOTHED + BINS]
    return float(edges[int(smooth.argmin())]) + 0.5 / BINS


def seen_blades(sheet: Sheet, sample: SurfaceSample) -> I64:
    """(k,) indices of the blades that enough points lie on, ascending."""
    index = sheet.blade(sides(sample, sheet.axis).points)
    values, counts = np.unique(index, return_counts=True)
    return np.asarray(values[counts >= max(LEAST_POINTS, LEAST_SHARE * len(index))], np.int64)


def _terms(height: F64, radius: F64) -> F64:
    return np.stack([height, radius, height**2, height * radius, radius**2], axis=1)
