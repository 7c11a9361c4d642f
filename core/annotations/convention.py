"""What the time keys of an annotation file mean: fitted over all of them, since one alone fits everything.

Programs write the time of a frame as its PTS, as its number over a frame rate, counted from 0 or from 1, or as
plain frame numbers, rounded or cut to some decimals. On a video of constant frame rate most of these agree;
on one of variable rate they drift apart by whole frames. Observed conventions: the survey in docs/method.md.
"""

from __future__ import annotations

import re
from bisect import bisect_left, bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from core.annotations.checks import shown
from core.errors import BadInput
from core.flags import Flag
from core.video.table import FrameTable

Clock = Literal["pts", "average_rate", "average_rate+1", "container", "index", "index+1", "displayed"]
CLOCKS: tuple[Clock, ...] = ("pts", "average_rate", "average_rate+1", "container", "index", "index+1", "displayed")
"""In the order in which equally good ones are preferred.

- `pts`: presentation time, seconds from the first frame. - `average_rate`: frame number / average rate; `+1` counts
from 1. - `container`: presentation time as stored, where the first frame is not at 0. - `index`: frame number; `+1`
from 1. - `displayed`: any moment at which the frame was on the screen.
"""

MAX_STRAYS = 0.02
"""Share of the keys that may miss every frame: files are edited by hand."""
MAX_SHARED = 0.1
"""More keys than this that share a frame with another one were not made on this video."""


@dataclass(frozen=True)
class Reading:
    """How well one clock explains the keys."""

    clock: Clock
    frames: Mapping[str, int | None]
    """Source frame of each key; None = outside the video."""
    misses: Mapping[str, Fraction]
    """What each key inside the video is off by, s: key - time of its frame on this clock."""
    strays: tuple[str, ...]
    """Keys off by more than their last decimal and a tick of the video."""

    @property
    def max_miss(self) -> Fraction:
        """Largest deviation, s, over the keys that are no strays."""
        return max((abs(miss) for key, miss in self.misses.items() if key not in set(self.strays)), default=Fraction(0))

    @property
    def rounding(self) -> str:
        """``exact``, ``nearest``, ``floor`` or ``ceil``, by the signs of what is left."""
        left = [miss for key, miss in self.misses.items() if key not in set(self.strays)]
        if not any(left):
            return "exact"
        return "floor" if max(left) <= 0 else "ceil" if min(left) >= 0 else "nearest"


@dataclass(frozen=True)
class Fitted:
    """The convention of a file."""

    reading: Reading
    forced: bool
    rivals: tuple[Clock, ...]
    """Others that explain the keys as well but mean other frames."""
    flags: tuple[Flag, ...]

    def to_dict(self) -> dict[str, Any]:
        """JSON form, times in s."""
        one = self.reading
        return {
            "clock": one.clock,
            "forced": self.forced,
            "rounding": one.rounding,
            "max_miss_s": round(float(one.max_miss), 9),
            "strays": len(one.strays),
            "rivals": list(self.rivals),
        }


def fit_convention(keys: Mapping[str, Fraction], table: FrameTable, forced: str = "auto") -> Fitted:
    """Choose the clock that explains the keys best.

    Args:
        keys: exact value of every key.
        table: of the video.
        forced: a clock by name, taken without asking; ``auto`` fits.

    Raises:
        BadInput: `annotation_times_unclear` when nothing explains the keys; it says what comes nearest.
    """
    if forced != "auto":
        return Fitted(_read(_clock(forced), keys, table), True, (), ())
    if not keys:
        return Fitted(Reading("pts", {}, {}, ()), False, (), ())
    readings = [_read(clock, keys, table) for clock in CLOCKS if _may_be(clock, keys, table)]
    exact = [one for one in readings if one.clock != "displayed"]
    best = min(exact, key=lambda one: (_lost(one), CLOCKS.index(one.clock)))
    allowed = MAX_STRAYS * len(keys)
    if len(best.strays) <= allowed:
        equal = [one for one in exact if one is not best and _lost(one) == _lost(best) and one.frames != best.frames]
        return Fitted(best, False, tuple(one.clock for one in equal), _flags(best, equal))
    shown_at = _read("displayed", keys, table)
    frames = [frame for frame in shown_at.frames.values() if frame is not None]
    if len(frames) - len(set(frames)) > MAX_SHARED * len(frames):
        raise _unclear(best, len(keys), len(frames) - len(set(frames)))
    flag = Flag("annotation_times_inexact", "warning", float(best.max_miss), 0.0, f"{len(best.strays)} keys")
    return Fitted(shown_at, False, (), (flag,))


def _clock(name: str) -> Clock:
    for clock in CLOCKS:
        if clock == name:
            return clock
    raise BadInput(f"input.time_convention is one of auto, {', '.join(CLOCKS)}", where="input.time_convention")


def _may_be(clock: Clock, keys: Mapping[str, Fraction], table: FrameTable) -> bool:
    """Frame numbers are whole, and some of them are no seconds of this video; a container's own time starts late."""
    if clock == "container":
        return table.rows[0].pts != 0
    if clock in ("index", "index+1"):
        whole = all(value.denominator == 1 for value in keys.values())
        return whole and max(keys.values()) > Fraction(table.info.duration_s)
    return True


def _read(clock: Clock, keys: Mapping[str, Fraction], table: FrameTable) -> Reading:
    times, step = _times(clock, table), _step(clock, table)
    tick = Fraction(0) if clock in ("index", "index+1") else table.info.time_base
    end = times[-1] + step
    if clock == "pts":
        end = max(end, Fraction(table.info.duration_s))
    frames: dict[str, int | None] = {}
    misses: dict[str, Fraction] = {}
    strays = []
    for key, value in keys.items():
        if not times[0] - step / 2 <= value < end:
            frames[key] = None
            continue
        frame = max(0, bisect_right(times, value) - 1) if clock == "displayed" else _nearest(times, value)
        frames[key], misses[key] = frame, value - times[frame]
        if clock != "displayed" and abs(misses[key]) > quantum(key) + tick:
            strays.append(key)
    return Reading(clock, frames, misses, tuple(strays))


def _times(clock: Clock, table: FrameTable) -> list[Fraction]:
    """When each frame is, on this clock; for frame numbers, its number."""
    count = len(table.rows)
    if clock in ("pts", "displayed"):
        return [table.time(i) for i in range(count)]
    if clock == "container":
        return [row.pts * table.info.time_base for row in table.rows]
    if clock in ("index", "index+1"):
        return [Fraction(i + (clock == "index+1")) for i in range(count)]
    return [(i + (clock == "average_rate+1")) / table.info.average_rate for i in range(count)]


def _step(clock: Clock, table: FrameTable) -> Fraction:
    return Fraction(1) if clock in ("index", "index+1") else 1 / table.info.average_rate


def _nearest(times: Sequence[Fraction], value: Fraction) -> int:
    right = bisect_left(times, value)
    if right == 0:
        return 0
    if right == len(times):
        return right - 1
    return right - 1 if value - times[right - 1] <= times[right] - value else right


def _lost(one: Reading) -> int:
    """Keys that this clock does not explain: strays, and those outside the video."""
    return len(one.strays) + sum(frame is None for frame in one.frames.values())


def quantum(key: str) -> Fraction:
    """The unit of a key's last decimal: what rounding may have taken."""
    decimals = re.search(r"\.(\d+)\s*$", key)
    return Fraction(1, 10 ** len(decimals[1])) if decimals else Fraction(1)


def _flags(best: Reading, equal: Sequence[Reading]) -> tuple[Flag, ...]:
    flags = []
    if best.strays:
        where = f"first key {shown(best.strays[0])}"
        flags.append(Flag("annotation_times_inexact", "info", float(len(best.strays)), 0.0, where))
    if equal:
        others = ", ".join(one.clock for one in equal)
        flags.append(Flag("annotation_times_ambiguous", "info", None, None, f"{best.clock}, or {others}"))
    return tuple(flags)


def _unclear(best: Reading, count: int, shared: int) -> BadInput:
    examples = ", ".join(shown(key) for key in best.strays[:3])
    return BadInput(
        f"the time keys fit no reading of this video's frames: by the best one, {best.clock}, {len(best.strays)} of "
        f"{count} keys miss every frame (such as {examples}), and {shared} keys share a frame with another; "
        "set input.time_convention to say what they mean",
        code="annotation_times_unclear",
        where=shown(best.strays[0]),
    )
