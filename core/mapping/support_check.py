"""The thesis's sparse support and the depth map as witnesses for a place found by casting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

AGREE_SPACINGS = 6.0
"""Depths agree within this many point spacings,"""
AGREE_SHARE = 0.02
"""or within this share of the distance."""
MIN_POINTS = 3


@dataclass(frozen=True)
class Agreement:
    """Share of independent depths near a place that agree with it; None when there are too few."""

    share: float | None
    count: int


def depth_agreement(distances: F64, expected: float, spacing: float) -> Agreement:
    """Compare depths measured under a detection with that of its patch.

    Points behind the patch are no contradiction where the detection shows two surfaces: only what lies
    before it, or on it, is counted against or for it.

    Args:
        distances: (n,) from the camera, scene units, of sparse points or depth pixels in the box.
        expected: of the patch.
        spacing: of the fused cloud.
    """
    tolerance = max(AGREE_SPACINGS * spacing, AGREE_SHARE * expected)
    counted = distances[distances < expected + tolerance]
    if len(counted) < MIN_POINTS:
        return Agreement(None, len(counted))
    return Agreement(float((np.abs(counted - expected) <= tolerance).mean()), len(counted))
