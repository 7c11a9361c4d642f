"""What the time keys of an annotation file mean: fitted over all of them, since one alone fits everything.

The rules, and the programs whose keys they were made for, are in docs/method.md under "Time keys".
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

from core.annotations.checks import shown
from core.annotations.clocks import CLOCKS, FRAME_NUMBERS, FROM_ZERO, MEANINGS, Clock, clock_named, possible_clocks
from core.annotations.reading import Reading, read
from core.errors import BadInput
from core.flags import Flag, Severity
from core.video.table import FrameTable

MAX_STRAYS = 0.02
"""Share of the keys that may miss every frame: files are edited by hand."""
MIN_CONSECUTIVE = 10
"""As many numbers from 1 on, without a gap, are no chance of which pictures had something on them."""
MAX_SHARED = 0.1
"""More keys than this that share a frame with another one were not made on this video."""


@dataclass(frozen=True)
class KeyHit:
    """A key and its frame."""

    key: str
    source_index: int
    time_s: float
    """Of the frame, from the first frame."""


@dataclass(frozen=True)
class Fitted:
    """The convention of a file."""

    reading: Reading
    forced: bool
    others: tuple[Reading, ...] = ()
    """Readings that explain the keys as well but mean other frames."""
    flags: tuple[Flag, ...] = ()
    first: KeyHit | None = None
    """Of the first frame that has a key; None when no key lies in the video."""
    last: KeyHit | None = None
    ambiguous: bool = False
    """Whether the other readings are as good, and not only the same shifted by a frame."""

    @property
    def rivals(self) -> tuple[Clock, ...]:
        """Clocks of the other readings."""
        return tuple(one.clock for one in self.others)

    def to_dict(self) -> dict[str, object]:
        """JSON form, times in s."""
        one = self.reading
        return {
            "clock": one.clock,
            "meaning": MEANINGS[one.clock],
            "forced": self.forced,
            "rounding": one.rounding,
            "max_miss_s": round(float(one.max_miss), 9),
            "strays": len(one.strays),
            "rivals": list(self.rivals),
            "frames_hit": len(one.hit),
            "first": None if self.first is None else dict(self.first.__dict__),
            "last": None if self.last is None else dict(self.last.__dict__),
        }


def fit_convention(
    keys: Mapping[str, Fraction], table: FrameTable, forced: str = "auto", among: Sequence[str] = ()
) -> Fitted:
    """Choose the clock that explains the keys best.

    Args:
        keys: exact value of every key.
        table: of the video.
        forced: a clock by name, taken without asking; ``auto`` fits.
        among: names of the only clocks that the file's format leaves; none leaves all.

    Raises:
        BadInput: `annotation_times_unclear` when nothing explains the keys; it says what comes nearest.
    """
    if forced == "auto" and len(among) == 1:
        forced = among[0]
    if forced != "auto":
        return _fitted(read(clock_named(forced), keys, table), table, forced=True)
    if not keys:
        return Fitted(Reading("pts", {}, {}, ()), False)
    readings = [
        read(clock, keys, table) for clock in [clock_named(one) for one in among] or possible_clocks(keys, table)
    ]
    best = min(readings, key=_rank)
    if tuple(among) == FRAME_NUMBERS and _count_from_one(keys):
        from_one = next(one for one in readings if one.clock == "index+1")
        if from_one.n_lost == best.n_lost:
            rivals = () if from_one.frames == best.frames else (best,)
            return _fitted(from_one, table, others=rivals, flags=_flags(from_one, rivals, ambiguous=False))
    if len(best.strays) <= MAX_STRAYS * len(keys):
        others, ambiguous = _others(best, readings, table)
        return _fitted(best, table, others=others, ambiguous=ambiguous, flags=_flags(best, others, ambiguous))
    displayed = read("displayed", keys, table)
    frames = [frame for frame in displayed.frames.values() if frame is not None]
    if len(frames) - len(displayed.hit) > MAX_SHARED * len(frames):
        raise _unclear(best, len(keys), len(frames) - len(displayed.hit))
    flag = Flag("annotation_times_inexact", Severity.WARNING, float(best.max_miss), 0.0, f"{len(best.strays)} keys")
    return _fitted(displayed, table, flags=(flag,))


def _count_from_one(keys: Mapping[str, Fraction]) -> bool:
    """Whether the numbers of pictures are 1, 2, 3 and so on without a gap, as programs write them that count from 1."""
    return len(keys) >= MIN_CONSECUTIVE and set(keys.values()) == set(range(1, len(keys) + 1))


def _rank(one: Reading) -> tuple[int, int, bool, int]:
    """Fewest keys unexplained, then fewest before the video, which no cut-off file excuses; then the tighter fit."""
    return one.n_lost, len(one.early), not one.exact, CLOCKS.index(one.clock)


def _others(best: Reading, readings: Sequence[Reading], table: FrameTable) -> tuple[tuple[Reading, ...], bool]:
    """Readings that may be meant as well, one for each set of frames; and whether that makes the times ambiguous.

    What fits by the keys' decimals alone is not disputed by what needs the slack as well. Every file in seconds from
    the first frame is also one of frame numbers over the rate, counted from 1: such a shift is no ambiguity while the
    form that is documented fits and nothing speaks for the other.
    """
    fit = {one.clock: one for one in readings if _fits_like(one, best)}
    if best.clock in FROM_ZERO and len(best.hit) < len(table.rows):
        # Only the one key that is past the end from 0 tells the two apart, and players write that one as well.
        usual = [one for one in readings if one.clock in ("pts", FROM_ZERO[best.clock])]
        fit |= {one.clock: one for one in usual[:1] if one.n_lost == best.n_lost + 1}
    documented = fit.get("pts")
    others: dict[tuple[int | None, ...], Reading] = {}
    ambiguous = False
    for clock, one in fit.items():
        frames = tuple(one.frames.values())
        if one.frames == best.frames or frames in others or (best.exact and not one.exact):
            continue
        others[frames] = one
        twin = fit.get(FROM_ZERO.get(clock, clock))
        shift = documented is not None and clock in FROM_ZERO and twin is not None and twin.frames == documented.frames
        ambiguous |= not shift
    return tuple(others.values()), ambiguous


def _fits_like(one: Reading, best: Reading) -> bool:
    allowed = max(MAX_STRAYS * len(one.frames), best.n_unexplained)
    return _rank(one)[:2] == _rank(best)[:2] and one.n_unexplained <= allowed


def _flags(best: Reading, others: Sequence[Reading], ambiguous: bool) -> tuple[Flag, ...]:
    flags = []
    if best.strays:
        where = f"first key {shown(best.strays[0])}"
        flags.append(Flag("annotation_times_inexact", Severity.INFO, float(len(best.strays)), 0.0, where))
    if best.blurred:
        where = f"too few decimals to tell frames apart; first key {shown(best.blurred[0])}"
        flags.append(Flag("annotation_times_inexact", Severity.WARNING, float(len(best.blurred)), 0.0, where))
    if others:
        names = ", or ".join(f"{one.clock} ({MEANINGS[one.clock]})" for one in (best, *others))
        where = f"{names}; input.time_convention says which"
        severity = Severity.WARNING if ambiguous else Severity.INFO
        flags.append(Flag("annotation_times_ambiguous", severity, None, None, where))
    return tuple(flags)


def _fitted(
    one: Reading,
    table: FrameTable,
    *,
    forced: bool = False,
    others: tuple[Reading, ...] = (),
    ambiguous: bool = False,
    flags: tuple[Flag, ...] = (),
) -> Fitted:
    hits = {frame: key for key, frame in one.frames.items() if frame is not None}
    first, last = (
        (KeyHit(hits[frame], frame, table.rows[frame].time_s) for frame in (min(hits), max(hits)))
        if hits
        else (None, None)
    )
    return Fitted(one, forced, others, flags, first, last, ambiguous)


def _unclear(best: Reading, count: int, shared: int) -> BadInput:
    examples = ", ".join(shown(key) for key in best.strays[:3])
    return BadInput(
        f"the time keys fit no reading of this video's frames: by the best one, {best.clock} ({MEANINGS[best.clock]}), "
        f"{len(best.strays)} of {count} keys miss every frame (such as {examples}), and {shared} keys share a frame "
        "with another; set input.time_convention to say what they mean",
        code="annotation_times_unclear",
        where=shown(best.strays[0]),
    )
