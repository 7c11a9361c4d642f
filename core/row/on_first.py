"""A further model's row put onto that of the first model, and its blades named by the first one's numbers.

Where pitch, axis and scale of the two agree the rows are one. Which blade is which is a whole number of pitches that
geometry does not tell: frames of both models, a steady turn between them or a person does, or it stays unknown.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cached_property
from math import hypot

import numpy as np
from numpy.typing import NDArray

from core.json_files import JsonObject
from core.row.model import BladeRow, NoRow
from core.row.passing import NoOffset, Offset, OffsetFrom, offset_between, turn_of_camera
from core.row.sample import SurfaceSample, sample_surface, steadied, thinned
from core.row.shared import Laid, OneBlade, laid_onto, off_axis, one_blade
from core.scene.views import Views
from core.settings.row import RowSettings, SameBlade, same_blades
from core.surface.ply import Mesh

F64 = NDArray[np.float64]

POINTS = 6000
"""Of each surface."""
PITCH_SIGMAS = 2.0
"""Two pitches agree within so many standard deviations of their difference."""
LEAST_OVERLAP = 0.5
"""Of the blades of both models. Two parts of equal blades that share half of them have 0.74, whole ones with waves of
0.5 mm on them 0.69, wrongly laid ones less than 0.3."""
OTHER_WAY = 0.7
"""Of that overlap, at most, when the axis is reversed."""
AXIS_WITHIN_DEG = 6.0
AXIS_WITHIN = 0.1
"""Of the radius of the blades."""


class NotOnFirst(StrEnum):
    """Why the blades of a further model have no numbers of the first."""

    NO_ROW = "no_row"
    PITCH_DIFFERS = "pitch_differs"
    SHAPE_DIFFERS = "shape_differs"
    AXIS_DIFFERS = "axis_differs"
    OFFSET_UNKNOWN = "offset_unknown"


NOT_ON_FIRST: Mapping[NotOnFirst | NoOffset, str] = {
    NotOnFirst.NO_ROW: "the row of one of the two models is unknown",
    NotOnFirst.PITCH_DIFFERS: "the angles from blade to blade differ",
    NotOnFirst.SHAPE_DIFFERS: "the blades do not lie on each other at any scale",
    NotOnFirst.AXIS_DIFFERS: "where blades lie on each other the axes do not",
    NotOnFirst.OFFSET_UNKNOWN: "it is the same row, but how many blades lie between is not known",
    NoOffset.NOT_NEXT: "no frame of one model is followed by one of the other",
    NoOffset.TOO_FAR: "too much passes between them",
    NoOffset.NOT_STEADY: "the turn between them is not steady enough",
    NoOffset.JUMP: "the pictures jump between them",
    NoOffset.NO_SUCH_BLADE: "the blade that was told is none of the model",
    NoOffset.DISAGREES: "two gaps between them tell different numbers",
}
"""What each reason means, for people."""


@dataclass(frozen=True)
class ModelOfRow:
    """What the row of a model is compared by."""

    row: BladeRow | NoRow
    mesh: Mesh
    """Its surface, faces counter-clockwise seen from the cameras."""
    views: Views
    seed: int
    """Of the points drawn."""

    @cached_property
    def sample(self) -> SurfaceSample:
        """Points of the surface: drawn when they are asked for, as a result of one model never does."""
        return thinned(sample_surface(steadied(self.mesh, self.seed), self.seed), POINTS)


def of_further(told: RowSettings) -> RowSettings:
    """What is told of the whole row, for a further model: numbers, their direction and edge a are told of the first."""
    return told.model_copy(update={"zero_blade": None, "direction": "as_seen", "edge_a": None})


@dataclass(frozen=True)
class OnFirst:
    """How the row of a further model lies on that of the first."""

    names: Mapping[int, int]
    """Numbers on the first's row by the model's own; empty while unknown, and without those before number 1."""
    reason: NotOnFirst | None = None
    """None where the offset is known."""
    no_offset: NoOffset | None = None
    laid: Laid | None = None
    """None where the rows are not one."""
    offset: Offset | None = None

    def to_dict(self) -> JsonObject:
        """JSON form."""
        reason = None if self.reason is None else NOT_ON_FIRST[self.reason]
        more = "" if self.no_offset is None else f": {NOT_ON_FIRST[self.no_offset]}"
        offset = self.offset
        return {
            "same_row": self.laid is not None,
            "reason": self.reason,
            "reason_text": None if reason is None else reason + more,
            "offset": None if offset is None else offset.pitches,
            "offset_from": None if offset is None else offset.source,
            "names": {str(own): str(name) for own, name in self.names.items()},
            "evidence": {
                "scale": None if self.laid is None else round(self.laid.motion.scale, 6),
                "overlap": None if self.laid is None else round(self.laid.overlap, 4),
                "off_pitches": None if offset is None else round(offset.off, 4),
                "sigma_pitches": None if offset is None else round(offset.sigma, 4),
                "no_offset": self.no_offset,
            },
        }


def put_on_first(
    first: ModelOfRow,
    second: ModelOfRow,
    model: int,
    moments_s: Mapping[int, float],
    told: RowSettings,
    jumps: Sequence[tuple[int, int]] = (),
) -> tuple[BladeRow | NoRow, OnFirst]:
    """Put the row of a further model onto that of the first.

    Args:
        first: the first model.
        second: the further one, described with what `of_further` leaves.
        model: its number.
        moments_s: of the frames, s; videos lie far apart on this axis.
        told: what the user knows of the row.
        jumps: neighbouring frames between which the pictures jump.

    Returns:
        The row of the further model, its edges named as those of the first, and how it lies on it.
    """
    same = next((one for one in same_blades(told.same_blade) if one.model == model), None)
    found = _on_first(first, second, moments_s, same, jumps)
    row = second.row
    if isinstance(row, BladeRow) and found.laid is not None and isinstance(first.row, BladeRow):
        edge = first.row.edge_a
        row = replace(row, edge_a=edge if found.laid.way > 0 else edge.other)
    return row, found


def _on_first(
    first: ModelOfRow,
    second: ModelOfRow,
    moments_s: Mapping[int, float],
    told: SameBlade | None,
    jumps: Sequence[tuple[int, int]],
) -> OnFirst:
    if isinstance(first.row, NoRow) or isinstance(second.row, NoRow):
        return OnFirst({}, NotOnFirst.NO_ROW)
    here, there = one_blade(first.row, first.sample), one_blade(second.row, second.sample)
    laid = _one_row(here, there)
    if isinstance(laid, NotOnFirst):
        return OnFirst({}, laid)
    if told is not None:
        found: Offset | NoOffset = _told_offset(first.row, second.row, laid.way, told)
    else:
        at = laid.motion.apply(there.middle[None])[0]
        turns = (_turn(first, here.row, at, 1), _turn(second, there.row, there.middle, laid.way))
        found = offset_between(*turns, moments_s, jumps)
    if isinstance(found, NoOffset):
        return OnFirst({}, NotOnFirst.OFFSET_UNKNOWN, found, laid)
    names = {number: first.row.number(laid.way * index + found.pitches) for index, number in second.row.numbers.items()}
    return OnFirst({own: name for own, name in names.items() if name is not None}, laid=laid, offset=found)


def _one_row(here: OneBlade, there: OneBlade) -> Laid | NotOnFirst:
    """How one blade lies on the other where the two rows agree."""
    sigma = hypot(*(one.row.pitch_sigma_rad for one in (here, there)))
    if abs(here.row.pitch_rad - there.row.pitch_rad) > max(PITCH_SIGMAS * sigma, 1e-9):
        return NotOnFirst.PITCH_DIFFERS
    ways = laid_onto(here, there)
    best = max(ways.values(), key=lambda one: one.overlap)
    if best.overlap < LEAST_OVERLAP or ways[-best.way].overlap > OTHER_WAY * best.overlap:
        return NotOnFirst.SHAPE_DIFFERS
    angle_deg, off = off_axis(here.row.axis, there.row.axis, best, here.middle)
    return NotOnFirst.AXIS_DIFFERS if angle_deg > AXIS_WITHIN_DEG or off > AXIS_WITHIN else best


def _turn(model: ModelOfRow, row: BladeRow, at: F64, way: int) -> dict[int, float]:
    """Pitches from blade 0, which is at a (3,) place, to the camera, by frame."""
    centers = model.views.centers
    angle, _, _ = row.axis.cylinder(centers[:1])
    start, _, _ = row.axis.cylinder(at[None])
    # The row that is seen lies within half a turn of its blade 0.
    first = float(np.angle(np.exp(1j * (angle[0] - start[0])))) if len(angle) else 0.0
    turn = way * (turn_of_camera(row.axis, row.pitch_rad, centers) + first / row.pitch_rad)
    return dict(zip(model.views.frame_index.tolist(), turn.tolist(), strict=True))


def _told_offset(first: BladeRow, second: BladeRow, way: int, told: SameBlade) -> Offset | NoOffset:
    """The offset that a person tells; numbers that the rows do not have tell none."""
    own = next((index for index, number in second.numbers.items() if number == told.number), None)
    if own is None:
        return NoOffset.NO_SUCH_BLADE
    return Offset(first.index(told.first) - way * own, OffsetFrom.USER, 0.0, 0.0)
