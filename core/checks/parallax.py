"""`no_parallax`: views that do not differ in place show no depth."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.flags import Flag

CALIBRATED = 2
"""COLMAP's two-view configuration of a pair that moved past a surface that is not a plane."""

MIN_INLIERS = 30
MIN_PAIR_ANGLE_DEG = 0.25
"""A pair of neighbouring frames below this median angle has no parallax worth the name."""
MIN_PARALLAX_SHARE = 0.02
MIN_MODEL_ANGLE_DEG = 1.8
"""COLMAP drops points below 1.5 degrees, so a median just above it means that little is left."""


def graph_parallax(graph: Mapping[str, NDArray[Any]]) -> Flag | None:
    """Whether the verified pairs show parallax at all; for runs that end without a model.

    Args:
        graph: arrays of ``graph.npz``: config, offsets, triangulation_angle_deg, each over (m,) pairs.

    Returns:
        `no_parallax` with the share of strong pairs that are calibrated and see their points under
        a sufficient angle; None when the share suffices or no pair is strong enough to tell.
    """
    strong = np.diff(graph["offsets"]) >= MIN_INLIERS
    if not strong.any():
        return None
    angle = np.nan_to_num(graph["triangulation_angle_deg"])
    with_depth = strong & (graph["config"] == CALIBRATED) & (angle >= MIN_PAIR_ANGLE_DEG)
    share = float(with_depth.sum() / strong.sum())
    if share >= MIN_PARALLAX_SHARE:
        return None
    return Flag("no_parallax", "error", share, MIN_PARALLAX_SHARE, f"{int(strong.sum())} pairs of frames")


def model_parallax(angles_deg: NDArray[np.float64]) -> Flag | None:
    """Whether a model's points are seen under sufficient angles; `angles_deg` (n,) is the largest of each point."""
    if not len(angles_deg):
        return None
    median = float(np.median(angles_deg))
    if median >= MIN_MODEL_ANGLE_DEG:
        return None
    return Flag("no_parallax", "error", median, MIN_MODEL_ANGLE_DEG, f"{len(angles_deg)} points")


def largest_angle_deg(point: NDArray[np.float64], centers: NDArray[np.float64]) -> float:
    """Largest angle between the rays from (n, 3) camera centres to a (3,) point."""
    rays = centers - point
    rays = rays / np.linalg.norm(rays, axis=1, keepdims=True)
    return float(np.degrees(np.arccos(np.clip((rays @ rays.T).min(), -1.0, 1.0))))
