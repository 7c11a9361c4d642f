"""Axis-aligned boxes: their overlap in an image, and the points that lie in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

Box = tuple[float, float, float, float]
"""Left, upper, right, lower."""


def bounding_box(corners: Sequence[tuple[float, float]]) -> Box:
    """Smallest box around corners (x, y), of which there is at least one."""
    xs, ys = [x for x, _ in corners], [y for _, y in corners]
    return (min(xs), min(ys), max(xs), max(ys))


def box_iou(a: Sequence[float] | NDArray[np.float64], b: Sequence[float] | NDArray[np.float64]) -> float:
    """Intersection over union of two boxes, in [0, 1]; 0 when they only touch."""
    width = min(a[2], b[2]) - max(a[0], b[0])
    height = min(a[3], b[3]) - max(a[1], b[1])
    if width <= 0 or height <= 0:
        return 0.0
    common = width * height
    return float(common / ((a[2] - a[0]) * (a[3] - a[1]) + (b[2] - b[0]) * (b[3] - b[1]) - common))


def in_box(points: NDArray[np.float64], box: ArrayLike, *, border: bool = True) -> NDArray[np.bool_]:
    """Which points lie in a box; a point that is not a number lies in none.

    Args:
        points: (..., d), d = 2 in an image.
        box: (..., 2 d) lower bounds, then upper ones: left, upper, right, lower. Its leading axes are broadcast
            against those of the points.
        border: whether the box's border belongs to it.

    Returns:
        (...) flags.
    """
    corners = np.asarray(box, np.float64)
    low, high = np.split(corners, 2, axis=-1)
    with np.errstate(invalid="ignore"):
        if border:
            return np.asarray(((points >= low) & (points <= high)).all(axis=-1))
        return np.asarray(((points > low) & (points < high)).all(axis=-1))
