"""Which source frames take part: the clip interval, uniform sampling, and frames with detections."""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate

from core.errors import BadInput
from core.flags import Flag, Severity
from core.scene.frame import Role, SourceFrame
from core.settings.groups import FrameSettings
from core.video.table import FrameTable

MIN_CLIPPED_S = 10
"""A preset's interval that keeps less than this of the video says nothing about it; the whole is used."""


@dataclass(frozen=True)
class Interval:
    """Source frames first ... last, both used, and what had to be said about choosing them."""

    first: int
    last: int
    flags: tuple[Flag, ...] = ()

    @property
    def n_frames(self) -> int:
        """Frames in the interval."""
        return self.last - self.first + 1


@dataclass(frozen=True)
class ChosenFrame:
    """One frame of the run. `index` numbers the exported images."""

    index: int
    source: SourceFrame
    role: Role


@dataclass(frozen=True)
class Stretch:
    """What may be chosen of one video."""

    interval: Interval
    annotated: Collection[int] = ()
    """Its source frames with a detection; those outside the interval are left alone."""
    reach: int = 0
    """Source frames within which an annotated frame has a chosen one on either side, as far as the budget goes: alone
    between distant samples it could not be matched with any. 0 adds none."""


def clip_interval(table: FrameTable, settings: FrameSettings, overrides: Collection[str]) -> Interval:
    """The used interval of one video.

    A bound that the user set (its name is in `overrides`) must lie within the video. A preset's bounds
    are cut to it; when that leaves under `MIN_CLIPPED_S` seconds, the preset's bounds are dropped.

    Raises:
        BadInput: `interval_outside`, `interval_empty`.
    """
    end_s = Fraction(table.info.duration_s)
    bounds = {
        name: None if value is None else Fraction(value)
        for name, value in (("clip_start_s", settings.clip_start_s), ("clip_end_s", settings.clip_end_s))
    }
    given = {name for name in bounds if f"frames.{name}" in overrides and bounds[name] is not None}
    for name in sorted(given):
        value = bounds[name]
        if value is not None and (value < 0 or value > end_s or (name == "clip_start_s" and value == end_s)):
            raise BadInput(
                f"frames.{name} = {float(value):g} s lies outside the video (0 to {float(end_s):.3f} s)",
                code="interval_outside",
                where=f"frames.{name}",
            )
    start, end = bounds["clip_start_s"] or Fraction(0), bounds["clip_end_s"]
    end = end_s if end is None else end
    flags: tuple[Flag, ...] = ()
    if len(given) < 2 and (end > end_s or start >= end_s or (given and start >= end)):
        flags = (
            Flag("interval_clipped", Severity.WARNING, float(end), float(end_s), f"{float(start):g}-{float(end):g} s"),
        )
        end = min(end, end_s)
        if end - start < MIN_CLIPPED_S:
            start = start if "clip_start_s" in given else Fraction(0)
            end = end if "clip_end_s" in given else end_s
    if start >= end:
        raise BadInput(
            f"the interval {float(start):g} to {float(end):g} s is empty", code="interval_empty", where="frames"
        )
    first, last = _frame_of(table, start, settings), _frame_of(table, end, settings)
    if last <= first:
        raise BadInput(
            f"the interval {float(start):g} to {float(end):g} s holds only one frame of the video",
            code="interval_empty",
            where="frames",
        )
    return Interval(first, last, flags)


def _frame_of(table: FrameTable, time_s: Fraction, settings: FrameSettings) -> int:
    if settings.time_rule == "average_rate":
        return min(round(time_s * table.info.average_rate), table.info.n_frames - 1)
    return table.nearest(time_s)


def sample_uniformly(first: int, last: int, count: int) -> list[int]:
    """`count` source frames from `first` to `last`, evenly by rounding; all of them when there are fewer.

    450 over 60-3606 is the thesis's choice. Strictly increasing: the spacing is at least one frame.
    Exactly half is rounded up, in integers, so that no machine rounds differently.
    """
    count = min(count, last - first + 1)
    if count == 1:
        return [first]
    steps = count - 1
    return [first + (2 * i * (last - first) + steps) // (2 * steps) for i in range(count)]


def choose_frames(stretches: Sequence[Stretch], settings: FrameSettings) -> list[ChosenFrame]:
    """Sampled and annotated frames and neighbours by time, then the annotated ones that the budget leaves over.

    Several videos are sampled as if the used parts followed each other without a gap, so that each gets frames in
    proportion to the length of its part; the budget is one for all.

    Args:
        stretches: of every video, in order.
        settings: count, include_annotated, max_count.

    Returns:
        Frames of the search numbered by time from 0, one video after the other (roles `sampled`, `annotated`, `both`,
        `neighbour`), followed by those to register afterwards (role `added`), by time too.
    """
    sampled = _sample_over(stretches, settings.count)
    wanted: set[SourceFrame] = set()
    if settings.include_annotated:
        wanted = {
            SourceFrame(video, i)
            for video, one in enumerate(stretches)
            for i in one.annotated
            if one.interval.first <= i <= one.interval.last
        }
    extra = sorted(wanted.difference(sampled))
    room = max(0, settings.max_count - len(sampled))
    taken = _spread(extra, room)
    known = {*sampled, *taken}
    missing = [
        SourceFrame(video, i)
        for video, one in enumerate(stretches)
        for i in _missing_neighbours(_of(video, known), _of(video, wanted & known), one.interval, one.reach)
    ]
    neighbours = set(_spread(missing, max(0, room - len(taken))))
    search = sorted(known | neighbours)
    in_sample = set(sampled)
    chosen: list[ChosenFrame] = []
    for source in search:
        role = Role.BOTH if source in wanted else Role.SAMPLED
        if source not in in_sample:
            role = Role.NEIGHBOUR if source in neighbours else Role.ANNOTATED
        chosen.append(ChosenFrame(len(chosen), source, role))
    for source in sorted(set(extra).difference(taken)):
        chosen.append(ChosenFrame(len(chosen), source, Role.ADDED))
    return chosen


def _sample_over(stretches: Sequence[Stretch], count: int) -> list[SourceFrame]:
    """`sample_uniformly` over the used parts of all videos, one after the other."""
    sampled, begin = [], 0
    ends = list(accumulate(one.interval.n_frames for one in stretches))
    chosen = sample_uniformly(0, ends[-1] - 1, count)
    for video, (one, end) in enumerate(zip(stretches, ends, strict=True)):
        own = chosen[bisect_left(chosen, begin) : bisect_left(chosen, end)]
        sampled += [SourceFrame(video, one.interval.first + position - begin) for position in own]
        begin = end
    return sampled


def _of(video: int, frames: Collection[SourceFrame]) -> list[int]:
    """Numbers in their video of the frames that are of it."""
    return [frame.source_index for frame in frames if frame.video == video]


def _missing_neighbours(chosen: Collection[int], centers: Collection[int], interval: Interval, reach: int) -> list[int]:
    """Frames at `reach` from the centers, on the sides where no chosen or already missing frame is nearer."""
    have, missing = sorted(chosen), set[int]()
    for center in sorted(centers) if reach else []:
        for side in (-reach, reach):
            low, high = min(center, center + side), max(center, center + side)
            found = have[bisect_left(have, low) : bisect_right(have, high)]
            near = any(frame != center for frame in found) or any(low <= frame <= high for frame in missing)
            if not near and interval.first <= center + side <= interval.last:
                missing.add(center + side)
    return sorted(missing)


def _spread(items: Sequence[SourceFrame], count: int) -> list[SourceFrame]:
    """At most `count` of `items`, evenly by rank."""
    if count == 0 or not items:
        return []
    return [items[i] for i in sample_uniformly(0, len(items) - 1, count)]
