"""What is said about a row of blades, and why something is not said."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from core.flags import Flag, Severity
from core.json_files import JsonObject
from core.row.blades import Sheet
from core.row.passing import LEAST_LEAP, Leap
from core.row.regular import Irregularity
from core.row.section import Section
from core.row.turn import Axis

F64 = NDArray[np.float64]

SCHEMA_VERSION = 1


class RowStatus(StrEnum):
    """Where the row comes from."""

    ESTIMATED = "estimated"
    """From the surface alone."""
    USER = "user"
    """From the surface, with the number of blades told."""
    UNKNOWN = "unknown"


class UnknownRow(StrEnum):
    """Why no row is known."""

    NO_SURFACE = "no_surface"
    TOO_FEW_VIEWS = "too_few_views"
    NO_REPETITION = "no_repetition"
    TOO_FEW_BLADES = "too_few_blades"
    PITCH_NOT_CONSTANT = "pitch_not_constant"
    TURN_LEAPS = "turn_leaps"
    NOT_COMPUTED = "not_computed"


UNKNOWN_ROW: Mapping[UnknownRow, str] = {
    UnknownRow.NO_SURFACE: "there is no supported surface",
    UnknownRow.TOO_FEW_VIEWS: "fewer than three images are registered",
    UnknownRow.NO_REPETITION: "no turn lays the surface onto itself: one blade, a hub, or no row",
    UnknownRow.TOO_FEW_BLADES: "the surface shows fewer than three equal blades",
    UnknownRow.NOT_COMPUTED: "the search for the row did not come to its end",
    UnknownRow.PITCH_NOT_CONSTANT: "the angle from blade to blade is not constant: a bent or wrongly joined model",
    UnknownRow.TURN_LEAPS: "the camera leaps by whole blades though the pictures go on: a wrongly joined model",
}
"""What each reason means, for people."""


class EdgeName(StrEnum):
    """What an edge of a blade is."""

    LEADING = "leading"
    TRAILING = "trailing"
    UNKNOWN = "unknown"
    """Geometry does not tell, and nobody did."""

    @property
    def other(self) -> EdgeName:
        """What the opposite edge is then."""
        opposite = {EdgeName.LEADING: EdgeName.TRAILING, EdgeName.TRAILING: EdgeName.LEADING}
        return opposite.get(self, self)


@dataclass(frozen=True)
class Coverage:
    """How well one blade was looked at."""

    blade: int
    """Its number."""
    views: int
    """Registered images that see some of it at a usable angle."""
    share: float
    """Of all the surface of the row that any blade shows, the part seen on this one, in [0, 1]."""
    by_views: Mapping[int, float]
    """Share of its own surface that at least so many images see at a usable angle."""


@dataclass(frozen=True)
class BladeRow:
    """A row of equal blades, in the world frame and unit of its model."""

    status: RowStatus
    sheet: Sheet
    """The angle of the blades as a function of place."""
    pitch_sigma_rad: float
    count: tuple[int, int]
    """Fewest and most blades in the whole row."""
    contrast: float
    overlaps: Mapping[str, float]
    """Share of the surface that lies on itself after so many pitches."""
    root_radius: float
    tip_radius: float
    radius_sigma: float
    """Of both radii."""
    numbers: Mapping[int, int]
    """Of the blades seen by their index on the sheet: from 1 in order of first appearance, or as the user counts."""
    section: Section
    coverage: tuple[Coverage, ...] = ()
    appears_rising: bool = True
    """Whether blades of growing angle come into view later."""
    edge_a: EdgeName = EdgeName.UNKNOWN
    """Of the edge lower along the axis."""
    zero_blade: int | None = None
    """Which blade, in order of first appearance, has the engine's number 1; None = nobody told."""
    direction: str | None = None
    """`as_seen` or `reversed`, where the user numbers the blades."""

    @property
    def axis(self) -> Axis:
        """The axis of the row."""
        return self.sheet.axis

    @property
    def pitch_rad(self) -> float:
        """Angle from blade to blade."""
        return self.sheet.pitch_rad

    @property
    def phases(self) -> F64:
        """(n,) angles of the blades seen where the sheet's lean is zero, rad, in the order of their numbers."""
        ordered = sorted(self.numbers, key=lambda index: self.numbers[index])
        return np.array([self.sheet.start_rad + index * self.pitch_rad for index in ordered])

    @property
    def _rising(self) -> int:
        """1 where numbers rise with the index, else -1."""
        return 1 if self.appears_rising == (self.direction != "reversed") else -1

    def number(self, index: int) -> int | None:
        """Of a blade that need not have been seen; None for one before number 1, where the whole count is not known."""
        known = min(self.numbers)
        number = self.numbers[known] + self._rising * (index - known)
        low, high = self.count
        if low == high:
            return (number - 1) % low + 1
        return number if number >= 1 else None

    def index(self, number: int) -> int:
        """The index that a number counts to from the blades seen."""
        known = min(self.numbers)
        return known + self._rising * (number - self.numbers[known])

    @property
    def seen(self) -> dict[int, int]:
        """Place of every blade in order of first appearance along the row, from 1, by its number."""
        rising = sorted(self.numbers)
        first = rising if self.appears_rising else rising[::-1]
        return {self.numbers[index]: 1 + abs(index - first[0]) for index in first}

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {
            "schema_version": SCHEMA_VERSION,
            "status": str(self.status),
            "reason": None,
            "axis": _numbers(self.axis.direction),
            "point": _numbers(self.axis.foot),
            "pitch_deg": round(float(np.degrees(self.pitch_rad)), 5),
            "pitch_sigma_deg": round(float(np.degrees(self.pitch_sigma_rad)), 5),
            "count": list(self.count),
            "root_radius": round(self.root_radius, 6),
            "tip_radius": round(self.tip_radius, 6),
            "radius_sigma": round(self.radius_sigma, 6),
            "root": "inside",
            "edges": {"a": str(self.edge_a), "b": str(self.edge_a.other)},
            "zero_blade": self.zero_blade,
            "direction": self.direction,
            "sides": {"growing": str(self.section.sides[1]), "falling": str(self.section.sides[-1])},
            "edges_seen": [name for name, edge in self.section.edges.items() if edge is not None],
            "blades": [
                {"number": number, "seen": self.seen[number], "angle_deg": round(float(np.degrees(phase)), 4)}
                for number, phase in zip(sorted(self.numbers.values()), self.phases, strict=True)
            ],
            "coverage": [
                {
                    "blade": one.blade,
                    "views": one.views,
                    "share": round(one.share, 4),
                    **{f"views_{least}": round(part, 4) for least, part in one.by_views.items()},
                }
                for one in self.coverage
            ],
            "evidence": {"contrast": round(self.contrast, 4), "overlaps": dict(self.overlaps)},
        }


@dataclass(frozen=True)
class NoRow:
    """No row is known."""

    reason: UnknownRow
    contrast: float | None = None
    """The best that was found, where it was asked for."""
    irregular: Irregularity | None = None
    """The two blades that speak against a row, where its pitch is not constant."""
    leap: Leap | None = None
    """The two frames that speak against it, where the turn of the camera leaps."""

    @property
    def flags(self) -> list[Flag]:
        """What a reader of the result must know: a surface that ought to be a row, and is none."""
        if self.irregular is not None:
            off, where = self.irregular.off_pitches, self.irregular.where
            return [Flag("row_irregular", Severity.WARNING, off, self.irregular.limit, where)]
        if self.leap is not None:
            leapt = abs(self.leap.pitches)
            return [Flag("row_irregular", Severity.WARNING, leapt, LEAST_LEAP, self.leap.where)]
        return []

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {
            "schema_version": SCHEMA_VERSION,
            "status": str(RowStatus.UNKNOWN),
            "reason": str(self.reason),
            "reason_text": UNKNOWN_ROW[self.reason],
            "evidence": {
                "contrast": None if self.contrast is None else round(self.contrast, 4),
                **({} if self.irregular is None else {"off_pitches": round(self.irregular.off_pitches, 4)}),
                **({} if self.leap is None else {"leap_pitches": self.leap.pitches, "frames": list(self.leap.frames)}),
            },
        }


def _numbers(values: F64) -> list[float]:
    return [round(float(value), 9) for value in values]
