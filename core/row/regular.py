"""Whether the blades of a row are equally far apart: where a model is bent or welded wrongly they are not.

Every blade is turned onto every other one by the whole pitches between them. Where both show the same place, the two
lie on each other; what is left over is a shift, a tilt or a turn that no row has.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from heapq import nlargest
from itertools import combinations
from math import ceil
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray

from core.row.blades import Sheet, seen_blades
from core.row.overlap import sides
from core.row.sample import SurfaceSample

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MAX_OFF_PITCHES = 0.07
"""True surfaces have 0.001, with waves of 0.3 to 1 mm on them 0.01 to 0.05, and up to 0.06 between blades of 13 or 16
that are half seen; the reconstructed surface of three blades has 0.001. Two groups of blades that are joined 0.2
pitches, 5 mm along the axis, 8 mm along the radius, 5 degrees or a tenth of their size off have 0.09 and more."""
END_OFF_PITCHES = 0.14
"""The same beside the first or the last blade, of which the view shows a part, aslant, where `ENDS_OF` were seen: of
right models one has 0.073 and one 0.067 there, and 0.02 between all others. A part that was joined wrongly has more
blades than one."""
ENDS_OF = 6
CANDIDATES = 8
"""Nearest points that are asked for one facing the same way: the two sides of a thin blade lie close together."""
MIN_COSINE = 0.7
"""Of the angle between the normals of two points that are one place of a blade."""
REACH_SPACINGS = 4.0
"""Largest distance between them along the surface."""
LEAST_LEVER = 0.3
"""Cosine of the angle between the surface's normal and the turn: where it is less a turn hardly moves the surface."""
ANOTHER_BLADE = 0.6
"""Of a pitch: what lies farther beside a place is of another blade."""
LEAST_SHARED = 60
"""Places that two blades must share to be compared: of a blade that is hardly seen a plane says too little."""
REWEIGHTED = 5
"""Times that the plane is fitted to the differences, with Cauchy weights."""


@dataclass(frozen=True)
class Irregularity:
    """The two blades that fit the row's pitch worst."""

    off_pitches: float
    """By how much they lie beside each other after the whole pitches between them, in pitches (root mean square)."""
    blades: tuple[int, int]
    """Their places in order of the angle, from 1."""
    seen: int
    """Number of blades that were seen."""

    @property
    def limit(self) -> float:
        """What it may be of a right model, in pitches."""
        of_end = self.seen >= ENDS_OF and not {1, self.seen}.isdisjoint(self.blades)
        return END_OFF_PITCHES if of_end else MAX_OFF_PITCHES

    @property
    def over(self) -> float:
        """Of the limit: above 1 the model is no row."""
        return self.off_pitches / self.limit

    @property
    def where(self) -> str:
        """For people."""
        one, other = self.blades
        return f"blades {one} and {other} of the {self.seen} seen, counted about the axis"


@dataclass(frozen=True)
class Differences:
    """By how much the blades of a row lie beside each other after the whole pitches between them."""

    blades: I64
    """(k,) indices on the sheet of those that were seen, ascending."""
    of_pair: Mapping[tuple[int, int], F64]
    """By the places in `blades` of two of them, the lower first: at the places that both show, in pitches, how far the
    first one lies ahead of the second; those that share too little are left out."""

    @property
    def worst(self) -> Irregularity | None:
        """The two blades that lie on each other worst, by their limit; None where no two show the same places.

        A third of the pairs of a blade, and of two one, may lie worse than the pair that it counts by. A blade that
        lies wrong does so beside all others, one of a part that was joined wrongly beside half of them; two that share
        little, far apart and both half seen, may be turned against each other by their edges alone.
        """
        of_blade: dict[int, list[Irregularity]] = {}
        for pair, off in self.of_pair.items():
            one, other = pair
            found = Irregularity(float(np.sqrt((off**2).mean())), (one + 1, other + 1), len(self.blades))
            for blade in pair:
                of_blade.setdefault(blade, []).append(found)
        off_pitches = attrgetter("off_pitches")
        told = [nlargest(max(2, ceil(len(pairs) / 3)), pairs, key=off_pitches)[-1] for pairs in of_blade.values()]
        return max(told, key=attrgetter("over"), default=None)

    @property
    def steps(self) -> F64:
        """(n,) by how much the step from a blade to the next one seen is larger than the pitch, in pitches."""
        following = [-float(off.mean()) for (one, other), off in self.of_pair.items() if other == one + 1]
        return np.array(following or [0.0])


def differences(sheet: Sheet, sample: SurfaceSample) -> Differences:
    """Turn every blade of a row onto every other one.

    Args:
        sheet: the blades.
        sample: points of the surface.
    """
    on_blade = sides(sample, sheet.axis)
    index, blades = sheet.blade(on_blade.points), seen_blades(sheet, sample)
    apart = [on_blade.of(index == blade) for blade in blades]
    found = {}
    for one, other in combinations(range(len(blades)), 2):
        angle = float(blades[other] - blades[one]) * sheet.pitch_rad
        off = _off(sheet, apart[one], apart[other], angle, REACH_SPACINGS * sample.spacing)
        if off is not None:
            found[one, other] = off
    return Differences(blades, found)


def _off(sheet: Sheet, here: SurfaceSample, there: SurfaceSample, angle_rad: float, reach: float) -> F64 | None:
    """(n,) by how much a blade turned onto another lies ahead of it, in pitches; None where they share too little.

    The differences are smoothed by a plane over radius and height, so that roughness averages out and a tilt stays.
    """
    moved = sheet.axis.turned(here.points, angle_rad)
    normals = here.normals @ sheet.axis.matrix(angle_rad).T
    rows = there.tree.query(moved, k=min(CANDIDATES, len(there)))[1].reshape(len(moved), -1)
    facing = (normals[:, None] * there.normals[rows]).sum(axis=2) > MIN_COSINE
    nearest = rows[np.arange(len(rows)), facing.argmax(axis=1)]
    gap, normal = moved - there.points[nearest], there.normals[nearest]
    across = (gap * normal).sum(axis=1)
    along = np.sqrt(np.maximum((gap**2).sum(axis=1) - across**2, 0.0))
    lever = (sheet.axis.tangential(moved) * normal).sum(axis=1)
    shared = facing.any(axis=1) & (along < reach) & (np.abs(lever) > LEAST_LEVER)
    _, radius, height = sheet.axis.cylinder(moved)
    off = across / np.where(shared, lever * radius * sheet.pitch_rad, np.inf)
    shared &= np.abs(off) < ANOTHER_BLADE
    if int(shared.sum()) < LEAST_SHARED:
        return None
    off, radius, height = off[shared], radius[shared], height[shared]
    terms = np.stack([np.ones(len(off)), radius - radius.mean(), height - height.mean()], axis=1)
    return _robust_fit(terms, off)


def _robust_fit(terms: F64, values: F64) -> F64:
    """(n,) the values that a linear combination of the (n, k) terms has, fitted with Cauchy weights."""
    weight = np.ones(len(values))
    fitted = np.zeros(len(values))
    for _ in range(REWEIGHTED):
        solution = np.linalg.lstsq(terms * weight[:, None], values * weight, rcond=None)[0]
        fitted = terms @ solution
        residual = np.abs(values - fitted)
        weight = 1.0 / np.sqrt(1.0 + (residual / max(1.5 * float(np.median(residual)), 1e-6)) ** 2)
    return fitted
