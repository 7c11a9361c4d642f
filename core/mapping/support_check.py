"""How well the sparse points in a detection's box agree in depth with the surface patch found by casting."""

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
"""With fewer points nothing is said about agreement."""


@dataclass(frozen=True)
class Agreement:
    """How many depths were compared with a place, and which share of them agrees with it."""

    share: float | None
    """None with fewer than `MIN_POINTS` depths."""
    count: int


def depth_agreement(distances: F64, expected: float, spacing: float) -> Agreement:
    """Compare the depths of sparse points in a detection's box with that of its patch.

    Points behind the patch are no contradiction where the detection shows two surfaces: only what lies
    before it, or on it, is counted against or for it.

    Args:
        distances: (n,) from the camera, scene units, of the sparse points in the box.
        expected: of the patch.
        spacing: of the fused cloud.
    """
    tolerance = max(AGREE_SPACINGS * spacing, AGREE_SHARE * expected)
    counted = distances[distances < expected + tolerance]
    if len(counted) < MIN_POINTS:
        return Agreement(None, len(counted))
    return Agreement(float((np.abs(counted - expected) <= tolerance).mean()), len(counted))
