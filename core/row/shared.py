"""Two models of one row: the similarity that lays the blades of one onto those of the other, but for whole pitches.

Models that no picture joins have a frame and a unit each. Blades are equal, so one blade, on which all those of its
model are laid, can be laid onto that of another model; which blade of one is which of the other it does not tell.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.similarity import Similarity
from core.row.blades import Sheet
from core.row.model import BladeRow
from core.row.motion import SCALED, fitted_motion
from core.row.overlap import Hypothesis, partners, sides
from core.row.sample import SurfaceSample, thinned
from core.row.turn import Axis

F64 = NDArray[np.float64]

BLADE_POINTS = 2000
SCALES = (0.85, 0.93, 1.0, 1.08, 1.18)
"""Scales that are begun with, over the one at which the middle radii are equal: one model may show more of the root."""
COARSE_STEPS, FINE_STEPS = 8, 20
WIDEST, NARROWEST = 6.0, 0.5
"""Widths of the weights of the first and the last step, in spacings of the points."""
WORTH_FITTING = 2
"""Starts that are fitted to the end."""
HELD_SHARE = 0.8
"""Of the overlap of a free motion, with which that of one that holds the axes is good enough."""


@dataclass(frozen=True)
class OneBlade:
    """All blades of a row, each turned by its whole pitches onto that of index 0."""

    row: BladeRow
    points: SurfaceSample

    @property
    def middle(self) -> F64:
        """(3,) mean of the points."""
        mean: F64 = self.points.points.mean(axis=0)
        return mean

    @property
    def kernel(self) -> float:
        """Width across the surface within which two places are one, scene units."""
        return Hypothesis(self.row.axis, self.row.pitch_rad).kernel(self.points)

    def frame(self, way: int) -> tuple[F64, F64]:
        """(3, 3) rows: away from the axis, round it and along it, the last two reversed for `way` -1; (3,) on the axis.

        The point is the one of the axis beside the middle.
        """
        axis, middle = self.row.axis, self.middle[None]
        rows = np.stack([axis.radial(middle)[0], way * axis.tangential(middle)[0], way * axis.direction])
        return rows, axis.nearest_to(middle[0]).foot

    @property
    def radius(self) -> float:
        """Of the middle, scene units."""
        return float(self.row.axis.cylinder(self.middle[None])[1][0])


def one_blade(row: BladeRow, sample: SurfaceSample) -> OneBlade:
    """The blade that all of a row's show together.

    Args:
        row: of the model.
        sample: points of its surface.
    """
    sheet = row.sheet
    on_blade = sides(sample, sheet.axis)
    index = sheet.blade(on_blade.points)
    kept = on_blade.of(np.isin(index, list(row.numbers)))
    return OneBlade(row, thinned(_turned_back(sheet, kept), BLADE_POINTS))


def _turned_back(sheet: Sheet, sample: SurfaceSample) -> SurfaceSample:
    index = sheet.blade(sample.points)
    points, normals = sample.points.copy(), sample.normals.copy()
    for blade in np.unique(index).tolist():
        own, angle = index == blade, -blade * sheet.pitch_rad
        points[own] = sheet.axis.turned(sample.points[own], angle)
        normals[own] = sample.normals[own] @ sheet.axis.matrix(angle).T
    return SurfaceSample(points, normals)


@dataclass(frozen=True)
class Laid:
    """How a blade of a second model lies on that of a first one."""

    motion: Similarity
    """From the second to the first: blade 0 onto blade 0."""
    overlap: float
    """Share of the blades that lies on each other, in [0, 1]."""
    way: int
    """1 where the axes have one direction, -1 where indices of the second fall as those of the first rise."""


def laid_onto(first: OneBlade, second: OneBlade) -> dict[int, Laid]:
    """The best way to lay one blade onto another, for either direction of the axis.

    The axes are held on each other: turn, shift and scale are fitted. Where a free motion lies much better, one of the
    axes is off, and it is taken.
    """
    return {way: _best(first, second, way) for way in (1, -1)}


def _best(first: OneBlade, second: OneBlade, way: int) -> Laid:
    direction, on_axis = first.row.axis.direction, first.frame(1)[1]
    held = np.zeros((7, 3))
    held[:3, 0] = held[3:6, 1] = direction
    held[6, 2] = 1.0

    def fitted(start: Similarity, steps: int, free: F64) -> Laid:
        widths = np.geomspace(WIDEST, NARROWEST, steps) * first.points.spacing
        about = on_axis if free is held else first.middle
        return _laid(first, second, fitted_motion(first.points, second.points, start, widths, about, free), way)

    begun = [fitted(start, COARSE_STEPS, held) for start in _starts(first, second, way)]
    begun.sort(key=lambda one: one.overlap, reverse=True)
    best = max([fitted(one.motion, FINE_STEPS, held) for one in begun[:WORTH_FITTING]], key=lambda one: one.overlap)
    free = fitted(best.motion, FINE_STEPS, SCALED)
    return best if best.overlap >= HELD_SHARE * free.overlap else free


def _starts(first: OneBlade, second: OneBlade, way: int) -> Iterator[Similarity]:
    (here, on_axis), (there, other) = first.frame(1), second.frame(way)
    rotation = here.T @ there
    for share in SCALES:
        scale = share * first.radius / second.radius
        yield Similarity(scale, rotation, on_axis - scale * rotation @ other)


def _laid(first: OneBlade, second: OneBlade, motion: Similarity, way: int) -> Laid:
    """Both ways count: a blade shrunk onto a part of the other lies on it, but the other one does not."""
    here, there = first.points, second.points
    moved = SurfaceSample(motion.apply(there.points), there.normals @ motion.rotation.T)
    shares = []
    for one, other in ((here, moved), (moved, here)):
        found = partners(one.points, one.normals, other)
        shares.append(float(np.where(found.fits, np.exp(-((found.across / first.kernel) ** 2)), 0.0).mean()))
    return Laid(motion, float(np.mean(shares)), way)


def off_axis(first: Axis, second: Axis, laid: Laid, middle: F64) -> tuple[float, float]:
    """Angle between two axes, degrees, and their distance beside the (3,) middle of the blade, once it is laid on.

    The distance is a share of the radius there.
    """
    direction = laid.motion.rotation @ second.direction
    angle = float(np.degrees(np.arccos(min(1.0, abs(float(direction @ first.direction))))))
    mapped = Axis(direction, laid.motion.apply(second.foot[None])[0]).nearest_to(middle).foot
    _, off, _ = first.cylinder(mapped[None])
    _, radius, _ = first.cylinder(middle[None])
    return angle, float(off[0] / radius[0])
