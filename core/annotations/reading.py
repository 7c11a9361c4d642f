"""One clock put to the keys of a file: which frame each key means by it, and how well that explains them."""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from core.annotations.clocks import Clock, Ruler, ruler_of
from core.geometry.nearest import nearest_index
from core.video.table import FrameTable

_LAST_DIGIT = re.compile(r"(?:\.(?P<decimals>\d*))?(?:e(?P<exponent>[+-]?\d+))?\s*$", re.IGNORECASE)
_HALF = Fraction(1, 2)
_ROUNDINGS = (Fraction(0), _HALF, -_HALF)
"""Where the middle of what a key may stand for lies, in its last decimals from it: rounded, cut, rounded up."""


@dataclass(frozen=True)
class Reading:
    """How well one clock explains the keys."""

    clock: Clock
    frames: Mapping[str, int | None]
    """Source frame of each key; None = outside the video."""
    misses: Mapping[str, Fraction]
    """What each key inside the video is off by, s: key - time of its frame on this clock."""
    strays: tuple[str, ...]
    """Keys off by more than their last decimal and a tenth of the shortest frame."""
    shared: tuple[str, ...] = ()
    """Keys on a frame that a key of another value has already."""
    early: tuple[str, ...] = ()
    """Keys before the first frame."""
    blurred: tuple[str, ...] = ()
    """Keys too coarse to say which frame: cut and rounded numbers would be different ones."""
    exact: bool = True
    """Whether every key but the strays is explained by its last decimal alone."""

    @property
    def max_miss(self) -> Fraction:
        """Largest deviation, s, over the keys that are no strays."""
        strays = set(self.strays)
        return max((abs(miss) for key, miss in self.misses.items() if key not in strays), default=Fraction(0))

    @property
    def rounding(self) -> str:
        """``exact``, ``nearest``, ``floor`` or ``ceil``, by the signs of what is left."""
        strays = set(self.strays)
        left = [miss for key, miss in self.misses.items() if key not in strays]
        if not any(left):
            return "exact"
        return "floor" if max(left) <= 0 else "ceil" if min(left) >= 0 else "nearest"

    @property
    def n_unexplained(self) -> int:
        """Keys in the video that this clock does not explain: strays, and those that share a frame."""
        return len({*self.strays, *self.shared})

    @property
    def n_lost(self) -> int:
        """The same and the keys outside the video."""
        return self.n_unexplained + sum(frame is None for frame in self.frames.values())

    @property
    def hit(self) -> frozenset[int]:
        """Frames that have a key."""
        return frozenset(frame for frame in self.frames.values() if frame is not None)


def read(clock: Clock, keys: Mapping[str, Fraction], table: FrameTable) -> Reading:
    """Put a clock to the keys (exact values by key).

    Raises:
        BadInput: the video does not declare the rate that the clock needs.
    """
    ruler = ruler_of(clock, table)
    values = {key: value * ruler.unit for key, value in keys.items()}
    begin = ruler.times[0] - ruler.step / 2
    inside = {key: value for key, value in values.items() if begin <= value < ruler.end}
    early = tuple(key for key, value in values.items() if value < begin)
    if clock == "displayed":
        shown = {key: max(0, bisect_right(ruler.times, value) - 1) for key, value in inside.items()}
        misses = {key: value - ruler.times[shown[key]] for key, value in inside.items()}
        return Reading(clock, {key: shown.get(key) for key in keys}, misses, (), early=early)
    quanta = {key: quantum(key) * ruler.unit for key in inside}
    frames, blurred = _assign(inside, quanta, ruler)
    misses = {key: value - ruler.times[frames[key]] for key, value in inside.items()}
    strays = {key for key, miss in misses.items() if abs(miss) > quanta[key] + ruler.slack}
    return Reading(
        clock,
        {key: frames.get(key) for key in keys},
        misses,
        strays=tuple(key for key in inside if key in strays),
        shared=_shared(inside, frames),
        early=early,
        blurred=blurred,
        exact=all(abs(miss) <= quanta[key] for key, miss in misses.items() if key not in strays),
    )


def quantum(key: str) -> Fraction:
    """The unit of a key's last digit, in the key's own unit: what rounding may have taken.

    1 for ``3``, 1/1000 for ``00:00:01.500``, 10 for ``1e1``. Programs that drop zeros write ``0.5`` among keys of
    four decimals; such a key says less about the clock than it could, and its nearest frame is the same.
    """
    last = _LAST_DIGIT.search(key)
    decimals = len(last["decimals"] or "") if last else 0
    exponent = int(last["exponent"] or 0) if last else 0
    return Fraction(10) ** (exponent - decimals)


def _assign(
    values: Mapping[str, Fraction], quanta: Mapping[str, Fraction], ruler: Ruler
) -> tuple[dict[str, int], tuple[str, ...]]:
    """Frame of every key, and the keys that are too coarse to say.

    While the last decimal of the keys is small beside a frame, the nearest frame is meant, however they were
    rounded. Where it is not, a cut key lies nearer to the frame before: the rounding is then fitted over all keys.
    """
    nearest = {key: nearest_index(ruler.times, value) for key, value in values.items()}
    coarse = [key for key in values if quanta[key] + ruler.slack > ruler.shortest / 2]
    if all(abs(values[key] - ruler.times[nearest[key]]) <= ruler.slack for key in coarse):
        return nearest, ()  # none, or all are times of frames, as whole seconds of a clip of 25 frames/s are
    tried = []
    for shift in _ROUNDINGS:
        centres = {key: value + shift * quanta[key] for key, value in values.items()}
        frames = {key: nearest_index(ruler.times, centre) for key, centre in centres.items()}
        off = {
            key
            for key, centre in centres.items()
            if abs(centre - ruler.times[frames[key]]) > quanta[key] / 2 + ruler.slack
        }
        tried.append((len(off | set(_shared(values, frames))), frames))
    fewest = min(off for off, _ in tried)
    fitting = [frames for off, frames in tried if off == fewest]
    return fitting[0], tuple(key for key in values if len({frames[key] for frames in fitting}) > 1)


def _shared(values: Mapping[str, Fraction], frames: Mapping[str, int]) -> tuple[str, ...]:
    taken: dict[int, Fraction] = {}
    return tuple(key for key, frame in frames.items() if taken.setdefault(frame, values[key]) != values[key])
