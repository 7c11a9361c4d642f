"""Initial pairs of a window, ranked from the verified graph instead of searched by trial."""

from __future__ import annotations

import numpy as np

from core.verification import CALIBRATED, PLANAR
from core.viewgraph import PairTable

ENOUGH_ANGLE_DEG = 16.0
"""COLMAP's `init_min_tri_angle`: a wider median angle is no better start."""

MIN_ANGLE_DEG = 1.5
"""COLMAP drops points seen under less (`filter_min_tri_angle`): a narrower pair leaves nothing to go on from."""

ENOUGH_INLIERS = 200
"""Inliers at which a pair earns half of what inliers can earn."""

APART_FRAMES = 10
"""Candidates start at least this far from each other, so that a second try is a different place."""


def rank_initial_pairs(graph: PairTable, min_inliers: int, n_best: int = 4) -> list[tuple[int, int]]:
    """The best pairs to start from, best first: calibrated before planar, wide median angle, many inliers.

    Two views of a plane allow two motions, so planar pairs come last; on a nearly flat surface there are no others.

    Args:
        graph: of the window.
        min_inliers: pairs with fewer are no candidates.
        n_best: how many to return, at most.

    Returns:
        frame indices (a, b), each at least `APART_FRAMES` from the ones before.
    """
    inliers = graph.n_inliers
    score = np.minimum(graph.triangulation_angle_deg, ENOUGH_ANGLE_DEG) * inliers / (inliers + ENOUGH_INLIERS)
    score += ENOUGH_ANGLE_DEG * (graph.config == CALIBRATED)
    usable = np.isin(graph.config, (CALIBRATED, PLANAR)) & (inliers >= min_inliers)
    usable &= graph.triangulation_angle_deg >= MIN_ANGLE_DEG
    order = np.lexsort((np.arange(len(score)), -score))
    chosen: list[tuple[int, int]] = []
    for row in order[usable[order]]:
        a, b = (int(frame) for frame in graph.pairs[row])
        if all(abs(a - other) >= APART_FRAMES for other, _ in chosen):
            chosen.append((a, b))
        if len(chosen) == n_best:
            break
    return chosen
