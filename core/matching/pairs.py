"""Which pairs of frames are matched."""

from __future__ import annotations

from collections.abc import Sequence

from core.windows import sequential_pairs


def match_pairs(times_s: Sequence[float], n_search: int, window: int) -> list[tuple[int, int]]:
    """All pairs (i, j), i < j, sorted.

    Search frames (index below `n_search`) are paired with their `window` followers. Frames after them were
    added for their annotations, out of order: each is paired with the `window` search frames nearest before
    it and the `window` nearest after it in time (a search frame at the same time counts as before).

    Args:
        times_s: presentation time of every frame by index, rising over the search frames.
        n_search: number of search frames.
        window: neighbours on each side.
    """
    pairs = set(sequential_pairs(n_search, window))
    for added in range(n_search, len(times_s)):
        order = sorted(range(n_search), key=lambda i: (times_s[i], i))
        before = [i for i in order if times_s[i] <= times_s[added]]
        after = [i for i in order if times_s[i] > times_s[added]]
        pairs.update((i, added) for i in [*before[-window:], *after[:window]])
    return sorted(pairs)


def pairs_of_chunk(pairs: Sequence[tuple[int, int]], start: int, end: int) -> list[tuple[int, int]]:
    """The pairs whose first frame lies in [start, end): every pair belongs to exactly one chunk."""
    return [pair for pair in pairs if start <= pair[0] < end]
