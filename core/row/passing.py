"""How many blades lie between two models of one row: by frames that both have, or by the turn on both sides of a gap.

Both models know the turn of the camera about the axis in pitches, but from a blade of their own. What lies between is
a whole number. A frame that both have tells it; else the turn before the gap and after it are carried on into it, and
what such a prediction is worth is found where the turn is known, inside the models.

Within one model nothing may lie between: a part that was joined whole pitches off makes a perfect row of blades, and
only the turn of the camera, which leaps there, tells of it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from core.flags import between_frames
from core.row.turn import Axis

F64 = NDArray[np.float64]

LEAST_SIGMA = 0.07
"""Of a pitch: blades of two models lie on each other no better, nor do their axes."""
SIGMAS = 3.0
LARGEST_OFF = 0.4
"""Of a pitch: so many standard deviations of a prediction, and what it is off a whole number; then the next one is 0.6
away."""
MOST_PASSED = 1.0
"""Pitches that pass in a gap, at most: with more a turn that hesitates may hide a blade."""
LEAST_FRAMES = 3
"""That a rate is told by."""
FEW_S = 1.0
"""A window may be longer by so much where frames are sparse."""
LEAST_TRIALS = 5
"""Predictions that were tried inside the models."""
WINDOW_GAPS = 1.5
"""A rate is that of so many times the gap, and of at least `LEAST_FRAMES` frames."""
LEAST_LEAP = 0.5
"""Pitches that the step between two frames differs from the steps about it, where a leap is looked for."""
STEPS_ABOUT = 4
"""Steps on each side that tell what a step should be."""


class OffsetFrom(StrEnum):
    """What tells how many blades lie between two models."""

    SHARED_FRAMES = "shared_frames"
    """Frames that are registered in both."""
    TURNING = "turning"
    """The turn before and after the gap between them."""
    USER = "user"


class NoOffset(StrEnum):
    """Why it is not known how many blades lie between two models."""

    NOT_NEXT = "not_next"
    """No frame of one is followed by one of the other."""
    TOO_FAR = "too_far"
    """More than a blade passes between them, or too much time to carry the turn on."""
    NOT_STEADY = "not_steady"
    """The turn cannot be foretold well enough over so long a gap, or falls between two whole numbers."""
    JUMP = "jump"
    """The pictures jump between them, perhaps by whole blades."""
    NO_SUCH_BLADE = "no_such_blade"
    """A person told a blade that the model does not have."""
    DISAGREES = "disagrees"
    """Two gaps tell different numbers."""


@dataclass(frozen=True)
class Offset:
    """A number of whole pitches, and how it is known."""

    pitches: int
    source: OffsetFrom
    off: float
    """What was found less the whole number, in pitches."""
    sigma: float
    """Standard deviation of what was found."""


@dataclass(frozen=True)
class Leap:
    """Two neighbouring frames of one model between which its camera turns by whole pitches more than it should."""

    frames: tuple[int, int]
    pitches: int
    """By which the second lies ahead of where the first and its motion say; never 0."""

    @property
    def where(self) -> str:
        """For people."""
        return f"{between_frames(*self.frames)}, where the camera's turn leaps by {abs(self.pitches)} of the pitches"


@dataclass(frozen=True)
class Turn:
    """The turn of the camera of one model about the axis, in order of time."""

    moments_s: F64
    """(n,) on the one axis of all videos, rising."""
    pitches: F64
    """(n,) from the model's own blade 0."""

    @classmethod
    def of(cls, by_frame: Mapping[int, float], moments_s: Mapping[int, float]) -> Turn:
        """From the turn in each frame, and the moment of each."""
        order = _in_time(by_frame, moments_s)
        return cls(np.array([moments_s[frame] for frame in order]), np.array([by_frame[frame] for frame in order]))

    def rate(self, before: int | None, after: int | None, window_s: float) -> float | None:
        """Pitches a second over a window that ends with the frame `before`, or begins with `after`; None if unknown."""
        t = self.moments_s
        if before is not None:
            low, high = int(np.searchsorted(t, t[before] - window_s)), before + 1
            low = max(0, min(low, high - LEAST_FRAMES))
        else:
            assert after is not None  # one of the two is told
            low, high = after, int(np.searchsorted(t, t[after] + window_s, side="right"))
            high = max(high, low + LEAST_FRAMES)
        own, turn = t[low:high], self.pitches[low:high]
        if len(own) < LEAST_FRAMES or np.ptp(own) <= 0 or np.ptp(own) > 3.0 * window_s + FEW_S:
            return None
        return float(np.polyfit(own - own[0], turn, 1)[0])


def turn_of_camera(axis: Axis, pitch_rad: float, centers: F64) -> F64:
    """(n,) turn of the camera about the axis at its (n, 3) places in order of time, pitches from the first."""
    angle, _, _ = axis.cylinder(centers)
    turn: F64 = np.unwrap(angle) / pitch_rad
    return turn - turn[:1]


def offset_between(
    first: Mapping[int, float],
    second: Mapping[int, float],
    moments_s: Mapping[int, float],
    jumps: Sequence[tuple[int, int]] = (),
) -> Offset | NoOffset:
    """The whole number of pitches that the turn of the second has to grow by to go on in that of the first.

    Args:
        first: turn of the camera in each of its frames, pitches from its own blade 0.
        second: of the other model, in the direction of the first.
        moments_s: of the frames, s; videos lie far apart on this axis. A frame without one counts only where both
            models have it.
        jumps: neighbouring frames between which the pictures jump: nothing is carried on over them.
    """
    both = sorted(first.keys() & second.keys())
    if both:
        apart = np.array([first[frame] - second[frame] for frame in both])
        spread = 1.4826 * float(np.median(np.abs(apart - np.median(apart))))
        found = _whole(float(np.median(apart)), max(LEAST_SIGMA, spread), OffsetFrom.SHARED_FRAMES)
        return found or NoOffset.NOT_STEADY
    turns = (Turn.of(first, moments_s), Turn.of(second, moments_s))
    gaps = list(_gaps(*turns))
    if not gaps:
        return NoOffset.NOT_NEXT
    jumps_s = _moments_of(jumps, moments_s)
    told = [_over(turns, *gap, jumps_s) for gap in gaps]
    known = [one for one in told if isinstance(one, Offset)]
    if not known:
        return next(one for one in (NoOffset.NOT_STEADY, NoOffset.JUMP, NoOffset.TOO_FAR) if one in told)
    if len({one.pitches for one in known}) > 1:
        return NoOffset.DISAGREES
    return min(known, key=lambda one: one.sigma)


def leap_within(
    by_frame: Mapping[int, float], moments_s: Mapping[int, float], jumps: Sequence[tuple[int, int]] = ()
) -> Leap | None:
    """Where the turn of one model leaps by whole pitches though the pictures go on; None where it nowhere does.

    Args:
        by_frame: turn of the camera in each of the model's frames, pitches.
        moments_s: of the frames, s.
        jumps: neighbouring frames between which the pictures jump: a leap there is not the model's.
    """
    frames = _in_time(by_frame, moments_s)
    whole = Turn.of(by_frame, moments_s)
    cuts = [int(cut) + 1 for cut in np.flatnonzero(np.abs(_unlike(whole)) > LEAST_LEAP)]
    bounds = [0, *cuts, len(frames)]
    parts = [Turn(whole.moments_s[a:b], whole.pitches[a:b]) for a, b in pairwise(bounds)]
    jumps_s = _moments_of(jumps, moments_s)
    for cut, turns in zip(cuts, pairwise(parts), strict=True):
        told = _over(turns, 0, len(turns[0].moments_s) - 1, 0, jumps_s)
        if isinstance(told, Offset) and told.pitches:
            return Leap((frames[cut - 1], frames[cut]), -told.pitches)
    return None


def _in_time(by_frame: Mapping[int, float], moments_s: Mapping[int, float]) -> list[int]:
    """The frames of a model whose moments are known, in order of time."""
    return sorted(by_frame.keys() & moments_s.keys(), key=lambda frame: moments_s[frame])


def _moments_of(jumps: Sequence[tuple[int, int]], moments_s: Mapping[int, float]) -> list[tuple[float, float]]:
    """When the pictures jump, of the jumps between frames whose moments are known."""
    return [(moments_s[a], moments_s[b]) for a, b in jumps if a in moments_s and b in moments_s]


def _unlike(turn: Turn) -> F64:
    """(n - 1,) pitches by which each step differs from what the rates of the steps about it say."""
    steps, lasts = np.diff(turn.pitches), np.maximum(np.diff(turn.moments_s), 1e-9)
    rates = steps / lasts
    about = [np.r_[rates[max(0, k - STEPS_ABOUT) : k], rates[k + 1 : k + 1 + STEPS_ABOUT]] for k in range(len(rates))]
    usual = np.array([np.median(part) if len(part) else 0.0 for part in about])
    unlike: F64 = steps - lasts * usual
    return unlike


def _gaps(first: Turn, second: Turn) -> Iterator[tuple[int, int, int]]:
    """Every place where a frame of one model is followed by one of the other.

    Gives which model comes before (0, 1), the row of its frame, and the row of the one after.
    """
    frames = [(float(t), 0, k) for k, t in enumerate(first.moments_s)]
    frames += [(float(t), 1, k) for k, t in enumerate(second.moments_s)]
    for (_, one, row), (_, other, next_row) in pairwise(sorted(frames)):
        if one != other:
            yield one, row, next_row


def _over(
    turns: tuple[Turn, Turn], before: int, row: int, next_row: int, jumps_s: Sequence[tuple[float, float]]
) -> Offset | NoOffset:
    """What one gap tells."""
    here, there = turns[before], turns[1 - before]
    start, end = float(here.moments_s[row]), float(there.moments_s[next_row])
    if any(a < end and b > start for a, b in jumps_s):
        return NoOffset.JUMP
    gap_s = end - start
    window_s = WINDOW_GAPS * gap_s
    rates = here.rate(row, None, window_s), there.rate(None, next_row, window_s)
    if rates[0] is None or rates[1] is None:
        return NoOffset.TOO_FAR
    passed = gap_s * (rates[0] + rates[1]) / 2
    if abs(passed) > MOST_PASSED:
        return NoOffset.TOO_FAR
    errors = [*_trials(turns[0], gap_s, window_s), *_trials(turns[1], gap_s, window_s)]
    if len(errors) < LEAST_TRIALS:
        return NoOffset.TOO_FAR
    sigma = max(LEAST_SIGMA, float(np.sqrt(np.mean(np.square(errors)))))
    apart = float(here.pitches[row]) + passed - float(there.pitches[next_row])
    found = _whole(apart if before == 0 else -apart, sigma, OffsetFrom.TURNING)
    return found or NoOffset.NOT_STEADY


def _trials(turn: Turn, gap_s: float, window_s: float) -> Iterator[float]:
    """Errors of predictions over gaps as long inside a model, whose turn is known there."""
    t = turn.moments_s
    for row in range(LEAST_FRAMES - 1, len(t)):
        next_row = int(np.searchsorted(t, t[row] + gap_s - 1e-9))
        if next_row >= len(t) or t[next_row] - t[row] > 2.0 * gap_s:
            continue
        rates = turn.rate(row, None, window_s), turn.rate(None, next_row, window_s)
        if rates[0] is not None and rates[1] is not None:
            passed = float(t[next_row] - t[row]) * (rates[0] + rates[1]) / 2
            yield float(turn.pitches[row] + passed - turn.pitches[next_row])


def _whole(pitches: float, sigma: float, source: OffsetFrom) -> Offset | None:
    """The whole number that a number of pitches means; None where another one may be meant."""
    whole = round(pitches)
    off = pitches - whole
    if SIGMAS * sigma > LARGEST_OFF or abs(off) > SIGMAS * sigma:
        return None
    return Offset(whole, source, off, sigma)
