"""Which pairs of frames are matched."""

from __future__ import annotations

from collections.abc import Sequence

from core.windows import sequential_pairs


def match_pairs(
    times_s: Sequence[float], n_search: int, window: int, videos: Sequence[int] = ()
) -> list[tuple[int, int]]:
    """All pairs (i, j), i < j, sorted.

    Search frames (index below `n_search`) are paired with their `window` followers. Frames after them were
    added for their annotations, out of order: each is paired with the `window` search frames nearest before
    it and the `window` nearest after it in time (a search frame at the same time counts as before).

    Frames of two videos are no neighbours, whatever their numbers: the probe or the rotor may have been moved between,
    as at a jump. Pairs over the cut are sought by the stage `bridge` and believed by its rules only.

    Args:
        times_s: time of every frame by index, on one axis, rising over the search frames.
        n_search: number of search frames.
        window: neighbours on each side.
        videos: video of every frame by index; none = all are of one.
    """
    video_of = videos or [0] * len(times_s)
    pairs = {(i, j) for i, j in sequential_pairs(n_search, window) if video_of[i] == video_of[j]}
    for added in range(n_search, len(times_s)):
        own = [i for i in range(n_search) if video_of[i] == video_of[added]]
        order = sorted(own, key=lambda i: (times_s[i], i))
        before = [i for i in order if times_s[i] <= times_s[added]]
        after = [i for i in order if times_s[i] > times_s[added]]
        pairs.update((i, added) for i in [*before[-window:], *after[:window]])
    return sorted(pairs)


def pairs_of_chunk(pairs: Sequence[tuple[int, int]], start: int, end: int) -> list[tuple[int, int]]:
    """The pairs whose first frame lies in [start, end): every pair belongs to exactly one chunk."""
    return [pair for pair in pairs if start <= pair[0] < end]
