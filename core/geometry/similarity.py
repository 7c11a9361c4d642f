"""Similarity transforms between the frames of two models."""

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
