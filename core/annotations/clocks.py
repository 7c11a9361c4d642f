"""The clocks that time keys may follow, and when each frame of a video is on them.

Programs write the time of a frame as its presentation time, as its number over a frame rate, or as plain frame
numbers, counted from 0 or from 1. On a video of constant frame rate most of these agree; where the rate varies
or frames were dropped they drift apart by whole frames.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Literal, get_args

from core.errors import BadInput
from core.video.table import FrameTable

Clock = Literal[
    "pts",
    "declared_rate",
    "average_rate",
    "index",
    "milliseconds",
    "container",
    "declared_rate+1",
    "average_rate+1",
    "index+1",
    "displayed",
]
CLOCKS: tuple[Clock, ...] = get_args(Clock)
"""In the order in which equally good ones are preferred; `MEANINGS` says what they are."""

MEANINGS: Mapping[Clock, str] = {
    "pts": "seconds from the first frame",
    "declared_rate": "seconds as frame number / the frame rate that the file declares, from 0",
    "average_rate": "seconds as frame number / the measured average frame rate, from 0",
    "index": "frame numbers from 0",
    "milliseconds": "milliseconds from the first frame",
    "container": "seconds of the file's own clock, on which the first frame is not at 0",
    "declared_rate+1": "seconds as frame number / the frame rate that the file declares, from 1",
    "average_rate+1": "seconds as frame number / the measured average frame rate, from 1",
    "index+1": "frame numbers from 1",
    "displayed": "seconds from the first frame, at any moment at which the frame is on the screen",
}

FROM_ZERO: Mapping[Clock, Clock] = {
    "declared_rate+1": "declared_rate",
    "average_rate+1": "average_rate",
    "index+1": "index",
}
"""Clocks that count frames from 1, with their twins that count from 0."""

FRAME_NUMBERS: tuple[Clock, ...] = ("index", "index+1")
"""Clocks whose keys are numbers of frames."""

SLACK = Fraction(1, 10)
"""Of the shortest frame: what a key may be off beyond its own last decimal. Containers and programs round, too."""

_NUMBER = re.compile(r"\s*\+?[0-9]+\s*")


@dataclass(frozen=True)
class Ruler:
    """A clock applied to a video. All in seconds, in frames for frame numbers."""

    times: tuple[Fraction, ...]
    """Of every frame."""
    end: Fraction
    """When the last frame ends."""
    step: Fraction
    """Usual duration of a frame."""
    shortest: Fraction
    """Shortest duration of a frame."""
    slack: Fraction
    """What a key may be off beyond its own rounding."""
    unit: Fraction = Fraction(1)
    """Of the keys."""


def clock_named(name: str) -> Clock:
    """The clock of this name; `BadInput` lists them all."""
    for clock in CLOCKS:
        if clock == name:
            return clock
    raise BadInput(f"input.time_convention is one of auto, {', '.join(CLOCKS)}", where="input.time_convention")


def possible_clocks(keys: Mapping[str, Fraction], table: FrameTable) -> list[Clock]:
    """Clocks worth trying, in order of preference.

    Frame numbers are whole; they are tried when written as such (``7``, not ``7.0``), or when some key lies beyond
    the video if read as seconds. Milliseconds are tried only then: otherwise all keys would lie in the first
    thousandth of the video. `displayed` explains everything and is no reading to be fitted.
    """
    info = table.info
    beyond = max(keys.values()) > Fraction(info.duration_s)
    whole = all(value.denominator == 1 for value in keys.values())
    numbers = whole and (beyond or all(_NUMBER.fullmatch(key) for key in keys))
    declared = info.declared_rate is not None and info.declared_rate != info.average_rate
    tried = {
        "declared_rate": declared,
        "declared_rate+1": declared,
        "index": numbers,
        "index+1": numbers,
        "milliseconds": beyond,
        "container": table.rows[0].pts != 0,
        "displayed": False,
    }
    return [clock for clock in CLOCKS if tried.get(clock, True)]


def ruler_of(clock: Clock, table: FrameTable) -> Ruler:
    """When each frame is on a clock; `BadInput` when the video does not declare the rate that is asked for."""
    count, info = len(table.rows), table.info
    times = tuple(table.time(i) for i in range(count))
    shortest = min((later - earlier for earlier, later in pairwise(times)), default=1 / info.average_rate)
    slack = SLACK * shortest
    first = 1 if clock in FROM_ZERO else 0
    if clock in FRAME_NUMBERS:
        numbers = tuple(Fraction(i + first) for i in range(count))
        return Ruler(numbers, Fraction(count + first), Fraction(1), Fraction(1), Fraction(0))
    if clock in ("declared_rate", "declared_rate+1", "average_rate", "average_rate+1"):
        step = 1 / _rate(clock, table)
        return Ruler(tuple((i + first) * step for i in range(count)), (count + first) * step, step, step, slack)
    step = 1 / info.average_rate
    start = table.rows[0].pts * info.time_base if clock == "container" else Fraction(0)
    end = max(times[-1] + step, Fraction(info.duration_s))
    unit = Fraction(1, 1000) if clock == "milliseconds" else Fraction(1)
    return Ruler(tuple(start + time for time in times), start + end, step, shortest, slack, unit)


def _rate(clock: Clock, table: FrameTable) -> Fraction:
    if clock in ("average_rate", "average_rate+1"):
        return table.info.average_rate
    if table.info.declared_rate is None:
        raise BadInput(
            f"input.time_convention is {clock}, but the video declares no frame rate", where="input.time_convention"
        )
    return table.info.declared_rate
