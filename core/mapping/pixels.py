"""The pixels of a detection: of its mask, or of the ellipse in its box, on a regular grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import Box, in_box

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Outline = Literal["mask", "box"]

CELLS = 17
"""Grid cells on the longer side of a detection, at most."""
MIN_CELLS = 7
"""And on either side, at least: small boxes are sampled below the pixel."""
SHRINK = 0.9
"""The ellipse's axes over the box's sides: boxes are drawn around a defect, and its corners show other things."""


@dataclass(frozen=True)
class Footprint:
    """Sampled pixels of a detection."""

    xy: F64
    """(n, 2) crop pixels, all on the exported frame."""
    cell: I64
    """(n, 2) column and row of the grid."""
    step_px: float
    """Longer side of a grid cell."""
    offered: int
    """Samples before those beyond the exported frame were left out."""
    outline: Outline


def footprint(
    box_px: Box, width: int, height: int, polygon_px: Sequence[tuple[float, float]] | None = None
) -> Footprint:
    """Sample a detection.

    Args:
        box_px: x1, y1, x2, y2 in crop pixels; it may reach beyond the frame.
        width: of the exported frame.
        height: of the exported frame.
        polygon_px: its mask in crop pixels, when it has one.
    """
    polygon = None if polygon_px is None or len(polygon_px) < 3 else np.asarray(polygon_px, np.float64)
    low, high = (np.array(box_px[:2]), np.array(box_px[2:])) if polygon is None else (polygon.min(0), polygon.max(0))
    side = np.maximum(high - low, 1e-6)
    longest = float(side.max())
    counts = [int(np.clip(ceil(CELLS * float(s) / longest), MIN_CELLS, CELLS)) for s in side]
    column, row = np.meshgrid(np.arange(counts[0]), np.arange(counts[1]))
    cell = np.stack([column.ravel(), row.ravel()], axis=1)
    step = side / counts
    xy = low + (cell + 0.5) * step
    inside = _in_ellipse(xy, low, high) if polygon is None else in_polygon(xy, polygon)
    xy, cell = xy[inside], cell[inside]
    if polygon is not None and len(xy) < MIN_CELLS:  # a sliver of a mask, thinner than the grid
        xy, cell = _along_outline(polygon, low, step, counts)
    on_frame = in_box(xy, (0, 0, width, height), border=False)
    return Footprint(xy[on_frame], cell[on_frame], float(step.max()), len(xy), "box" if polygon is None else "mask")


def _in_ellipse(xy: F64, low: F64, high: F64) -> NDArray[np.bool_]:
    scaled = (xy - (low + high) / 2) / (SHRINK * (high - low) / 2)
    inside: NDArray[np.bool_] = (scaled**2).sum(axis=1) <= 1.0
    return inside


def _along_outline(polygon: F64, low: F64, step: F64, counts: Sequence[int]) -> tuple[F64, I64]:
    """One point of the outline in each grid cell that it passes through, and the cells."""
    ends = np.roll(polygon, -1, axis=0)
    points = []
    for start, end in zip(polygon, ends, strict=True):
        n = 2 * ceil(float((np.abs(end - start) / step).max())) + 1
        points.append(start + (end - start) * (np.arange(n)[:, None] + 0.5) / n)
    xy = np.concatenate(points)
    cell = np.clip(np.floor((xy - low) / step), 0, np.array(counts) - 1).astype(np.int64)
    _, first = np.unique(cell, axis=0, return_index=True)
    return xy[first], cell[first]


def in_polygon(xy: F64, polygon: F64) -> NDArray[np.bool_]:
    """(n,) which points lie inside a closed polygon of (k, 2) corners, by the even-odd rule."""
    x, y = xy[:, :1], xy[:, 1:]
    ax, ay = polygon[:, 0], polygon[:, 1]
    bx, by = np.roll(ax, -1), np.roll(ay, -1)
    crosses = (ay > y) != (by > y)
    with np.errstate(divide="ignore", invalid="ignore"):
        at = ax + (y - ay) * (bx - ax) / (by - ay)
    odd: NDArray[np.bool_] = (crosses & (x < at)).sum(axis=1) % 2 == 1
    return odd
