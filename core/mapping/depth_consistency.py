"""Depth consistency of a place: is there a surface at a place, or does a map see through it?

Poisson closes gaps with surface that nobody saw, and stray depths leave sheets before the blades. A depth
map that measures something farther away in the direction of a place has seen through it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

NEAREST_MAPS = 6
"""Depth maps asked about a place: those nearest in the sequence, which saw it from about the same side."""
AGREE_SPACINGS = 6.0
"""Depths agree within this many point spacings,"""
AGREE_SHARE = 0.015
"""or within this share of the distance."""
MIN_POINTS = 8


@dataclass(frozen=True)
class DepthMaps:
    """Depth maps by frame index."""

    frames: NDArray[np.int64]
    """(d,) frame indices that have one, rising."""
    distances: Callable[[int, F64], tuple[F64, F64]]
    """Of a frame and (n, 3) world points: distance of the map's surface (0 = none) and of each point."""

    def near(self, frame_index: int) -> list[int]:
        """The frames with a map nearest in the sequence, nearest first."""
        order = np.argsort(np.abs(self.frames - frame_index), kind="stable")
        return [int(frame) for frame in self.frames[order[:NEAREST_MAPS]]]


def no_depth_maps() -> DepthMaps:
    """For a run without any."""
    return DepthMaps(np.zeros(0, np.int64), lambda _frame, points: (np.zeros(len(points)), np.zeros(len(points))))


def seen_share(maps: DepthMaps, frame_index: int, points: F64, spacing: float) -> float | None:
    """Share of the looks that met a surface at the points rather than behind them; None with too few looks.

    A look that ends before a point is hidden from it and says nothing.

    Args:
        maps: depth maps.
        frame_index: the maps nearest to it are asked.
        points: (n, 3) of a patch.
        spacing: of the fused cloud.
    """
    agree = through = 0
    for frame in maps.near(frame_index):
        found, own = maps.distances(frame, points)
        tolerance = np.maximum(AGREE_SPACINGS * spacing, AGREE_SHARE * own)
        measured = found > 0
        agree += int((measured & (np.abs(found - own) <= tolerance)).sum())
        through += int((measured & (found > own + tolerance)).sum())
    looks = agree + through
    return agree / looks if looks >= MIN_POINTS else None
