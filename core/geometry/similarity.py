"""Similarity transforms between the frames of two models, and how they are estimated."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.pose import transform

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Similarity:
    """``x_first = scale * rotation @ x_second + shift``."""

    scale: float
    rotation: F64
    """(3, 3)"""
    shift: F64
    """(3,)"""

    def apply(self, points: F64) -> F64:
        """(n, 3) points of the second frame in the first."""
        return transform(self.scale * points, self.rotation, self.shift)


def umeyama(second: F64, first: F64) -> Similarity | None:
    """Least-squares similarity from one (n, 3) point set to another (Umeyama 1991, eq. 40-43).

    None when it is not determined: fewer than three points, or all in one place or on one line.
    """
    if len(second) < 3:
        return None
    mean_second, mean_first = second.mean(axis=0), first.mean(axis=0)
    a, b = second - mean_second, first - mean_first
    spread = np.linalg.svd(a, compute_uv=False)
    if spread[1] <= 1e-9 * max(spread[0], np.finfo(float).tiny):
        return None
    u, d, vt = np.linalg.svd(b.T @ a / len(second))
    sign = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = (u * sign) @ vt
    scale = float((d * sign).sum() / (a**2).sum() * len(second))
    return Similarity(scale, rotation, mean_first - scale * rotation @ mean_second)
