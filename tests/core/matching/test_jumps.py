"""A jump by whole blades leaves verified matches, but far too few; dark, blurred and fast stretches are no jumps."""

from __future__ import annotations

import numpy as np
import pytest

from core.matching.jumps import (
    dense_enough,
    find_jumps,
    match_density,
    positions,
    spans_any,
)
from core.videos import moment
from core.viewgraph import PairTable
from core.windows import sequential_pairs

N, WIDTH, HEIGHT = 40, 400, 300
KEYPOINTS = 1000
RNG = np.random.default_rng(0)
PLACES = RNG.uniform([0, 0], [WIDTH, HEIGHT], (KEYPOINTS, 2)).astype(np.float32)


def made(counts: dict[tuple[int, int], int], step_px: float = 4.0) -> tuple[PairTable, list[np.ndarray]]:
    """Pairs with so many inliers; keypoint k is the same point in every frame, moved on by `step_px` a frame."""
    keypoints = [PLACES + np.array([step_px * frame, 0.0], np.float32) for frame in range(N)]
    inliers = [np.repeat(np.arange(n, dtype=np.uint32)[:, None], 2, axis=1) for n in counts.values()]
    m = len(counts)
    table = PairTable(
        np.array(list(counts), np.int32),
        np.zeros(m, np.uint8),
        np.array(list(counts.values()), np.int32),
        np.full(m, 2, np.uint8),
        np.cumsum([0, *counts.values()]).astype(np.int64),
        np.concatenate(inliers),
        np.tile([0.0, 0.0, 0.0, 1.0], (m, 1)),
        np.zeros((m, 3)),
        np.zeros(m, np.float32),
    )
    return table, keypoints


def usual(gap: int) -> int:
    return 500 - 40 * gap


def jumps_of(counts: dict[tuple[int, int], int], step_px: float = 4.0) -> list[int]:
    table, keypoints = made(counts, step_px)
    density = match_density(table, keypoints, WIDTH, HEIGHT)
    return find_jumps(table, density, np.arange(N, dtype=float), N)


SEQUENCE = {(a, b): usual(b - a) for a, b in sequential_pairs(N, 5)}


def test_few_matches_over_one_cut_are_a_jump() -> None:
    over = {pair: 80 if pair[0] <= 19 < pair[1] else n for pair, n in SEQUENCE.items()}
    assert jumps_of(SEQUENCE) == []
    assert jumps_of(over) == [19]
    table, _ = made(over)
    dropped = spans_any(table, np.arange(N, dtype=float), [19])
    assert dropped.sum() == 15
    assert all(a <= 19 < b for a, b in table.pairs[dropped])


def test_blurred_frames_dark_stretches_and_breaks_are_none() -> None:
    blurred = {(a, b): 40 if 20 in (a, b) else n for (a, b), n in SEQUENCE.items()}
    assert jumps_of(blurred) == []
    broken = {(a, b): 0 if a <= 19 < b else n for (a, b), n in SEQUENCE.items()}
    assert jumps_of(broken) == []
    stretch = {(a, b): n // 8 if {a, b} & set(range(16, 24)) else n for (a, b), n in SEQUENCE.items()}
    assert jumps_of(stretch) == []
    weak = {pair: n // 5 if 10 < pair[0] < 30 and 10 < pair[1] < 30 else n for pair, n in SEQUENCE.items()}
    assert jumps_of(weak) == []


def test_matches_are_counted_by_what_the_frames_share() -> None:
    """Fast motion leaves little in common: few matches are all that there can be."""
    table, keypoints = made({(0, 1): 100}, step_px=200.0)
    assert match_density(table, keypoints, WIDTH, HEIGHT) == pytest.approx([200.0])
    table, keypoints = made({(0, 1): 0})
    assert match_density(table, keypoints, WIDTH, HEIGHT).tolist() == [0.0]


def test_pairs_sought_over_a_gap_need_their_matches_too() -> None:
    position = np.arange(N, dtype=float)
    table, keypoints = made({pair: n for pair, n in SEQUENCE.items() if not pair[0] <= 19 < pair[1]})
    density = match_density(table, keypoints, WIDTH, HEIGHT)
    extra, _ = made({(15, 25): 200, (14, 26): 40})
    found = match_density(extra, keypoints, WIDTH, HEIGHT)
    assert dense_enough(extra, found, table, density, position).tolist() == [True, False]


def test_frames_added_later_stand_where_their_time_falls() -> None:
    times = [0.0, 1.0, 2.0, 3.0, 1.5]
    assert positions(times, 4).tolist() == [0.0, 1.0, 2.0, 3.0, 1.5]


def test_a_frame_added_at_the_end_of_a_video_stays_before_the_cut() -> None:
    times = [0.0, 1.0, moment(1, 0.0), moment(1, 1.0), 1.5, moment(1, 0.5), moment(1, -0.0)]
    videos = [0, 0, 1, 1, 0, 1, 1]
    assert positions(times, 4, videos).tolist() == [0.0, 1.0, 2.0, 3.0, 1.0, 2.5, 2.0]
