"""`no_parallax`: views that do not differ in place show no depth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.flags import Flag, Severity
from core.products.search import CaseProduct
from core.scene.case import CaseReason, CaseStatus

MAX_STILL_SHARE = 0.5
"""More cases than this that end without parallax speak for the whole clip."""

MIN_MODEL_ANGLE_DEG = 1.8
"""COLMAP drops points below 1.5 degrees, so a median just above it means that little is left."""


DEGENERATE_CONFIGS = (4, 5, 6)
"""COLMAP's two-view configurations: planar, panoramic, one of the two."""
MAX_PLANAR_SHARE = 0.95
MIN_PLANAR_PAIRS = 10


def cases_parallax(cases: Sequence[CaseProduct]) -> Flag | None:
    """Whether the search found no model because the views do not differ in place.

    A pair of neighbouring frames cannot tell: keypoint noise of a turning camera triangulates under up to 0.3
    degrees. Each case therefore tries one rotation on its longest tracks (`core.sparse.parallax`).

    Args:
        cases: those that ended.

    Returns:
        `no_parallax` with the share of such cases, when none has a model and most end for that reason.
    """
    still = sum(case.reason == CaseReason.NO_PARALLAX for case in cases)
    if not cases or any(case.status == CaseStatus.SUCCEEDED for case in cases) or still <= MAX_STILL_SHARE * len(cases):
        return None
    return Flag("no_parallax", Severity.ERROR, still / len(cases), MAX_STILL_SHARE, f"{still} of {len(cases)} cases")


def model_parallax(angles_deg: NDArray[np.float64]) -> Flag | None:
    """Whether a model's points are seen under sufficient angles; `angles_deg` (n,) is the largest of each point."""
    if not len(angles_deg):
        return None
    median = float(np.median(angles_deg))
    if median >= MIN_MODEL_ANGLE_DEG:
        return None
    return Flag("no_parallax", Severity.ERROR, median, MIN_MODEL_ANGLE_DEG, f"{len(angles_deg)} points")


def check_planar(
    pairs: NDArray[np.int32], n_inliers: NDArray[np.int64], config: NDArray[np.uint8], frames: NDArray[np.int64]
) -> Flag | None:
    """`planar_start` when a plane or a turn explains nearly all pairs of a model's frames as well as a motion does.

    The motion between two such images has two solutions and the lens hardly any hold; where the mapper starts, it
    cannot choose well.

    Args:
        pairs: (m, 2) frame indices of matched pairs.
        n_inliers: (m,) of each pair; pairs without any have no say.
        config: (m,) COLMAP's two-view configuration of each pair.
        frames: (n,) indices of the registered frames.
    """
    inside = np.isin(pairs, frames).all(axis=1) & (n_inliers > 0)
    if inside.sum() < MIN_PLANAR_PAIRS:
        return None
    share = float(np.isin(config[inside], DEGENERATE_CONFIGS).mean())
    if share <= MAX_PLANAR_SHARE:
        return None
    return Flag("planar_start", Severity.WARNING, share, MAX_PLANAR_SHARE, f"{int(inside.sum())} pairs")


def largest_angle_deg(point: NDArray[np.float64], centers: NDArray[np.float64]) -> float:
    """Largest angle between the rays from (n, 3) camera centres to a (3,) point."""
    rays = centers - point
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return float(np.degrees(np.arccos(np.clip((rays @ rays.T).min(), -1.0, 1.0))))
