from __future__ import annotations

import numpy as np

from core.sparse.initial_pair import APART_FRAMES, rank_initial_pairs
from core.viewgraph import PairTable


def table(rows: list[tuple[int, int, int, int, float]]) -> PairTable:
    """Pairs of (a, b, inliers, config, angle)."""
    counts = [row[2] for row in rows]
    n = len(rows)
    return PairTable(
        np.array([row[:2] for row in rows], np.int32),
        np.zeros(n, np.uint8),
        np.array(counts, np.int32),
        np.array([row[3] for row in rows], np.uint8),
        np.cumsum([0, *counts]).astype(np.int64),
        np.zeros((sum(counts), 2), np.uint32),
        np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)),
        np.zeros((n, 3)),
        np.array([row[4] for row in rows], np.float32),
    )


def test_a_wide_calibrated_pair_with_many_inliers_comes_first() -> None:
    graph = table([(0, 1, 900, 2, 1.6), (20, 25, 500, 2, 8.0), (40, 45, 60, 2, 9.0), (60, 65, 800, 4, 12.0)])
    assert rank_initial_pairs(graph, 40) == [(20, 25), (40, 45), (0, 1), (60, 65)]


def test_weak_narrow_and_panoramic_pairs_are_no_candidates() -> None:
    graph = table([(0, 1, 39, 2, 9.0), (20, 21, 500, 2, 1.4), (40, 41, 500, 5, 9.0), (60, 61, 500, 2, float("nan"))])
    assert rank_initial_pairs(graph, 40) == []


def test_candidates_are_different_places_and_few() -> None:
    graph = table([(i, i + 5, 500, 2, 5.0 + i / 100) for i in range(80)])
    chosen = rank_initial_pairs(graph, 40, n_best=3)
    assert chosen[0] == (79, 84)
    assert len(chosen) == 3
    firsts = [a for a, _ in chosen]
    assert min(abs(a - b) for i, a in enumerate(firsts) for b in firsts[:i]) >= APART_FRAMES


def test_beyond_colmaps_angle_more_inliers_win() -> None:
    assert rank_initial_pairs(table([(0, 5, 100, 2, 40.0), (30, 35, 400, 2, 17.0)]), 40)[0] == (30, 35)
