"""Patches taken from and aligned with images, as compiled loops over many at a time.

Images are float32 of shape (height, width) with pixel centres at integers; places are (x, y) in that frame.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.jit import compiled

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

FLAT = 1.0
"""Contrast (grey levels) below which a patch shows nothing."""
MIN_EIGENVALUE = 0.005
"""Least eigenvalue of a patch's structure tensor over its variance: below, it can slide along an edge."""
SMALL_STEP_PX, LARGE_STEP_PX = 0.005, 1.0
"""A smaller step ends the iteration, a larger one is cut."""


@compiled
def _sample(image: F32, x: float, y: float) -> float:
    """Bilinear value at a place inside the image."""
    column, row = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - column, y - row
    top = image[row, column] * (1.0 - fx) + image[row, column + 1] * fx
    bottom = image[row + 1, column] * (1.0 - fx) + image[row + 1, column + 1] * fx
    return float(top * (1.0 - fy) + bottom * fy)


@compiled
def take_patches(image: F32, places: F64, patches: F32) -> None:
    """Fill `patches` (m, s, s), s odd, with the surroundings of (m, 2) `places`; NaN where one leaves the image."""
    side = patches.shape[1]
    half = side // 2
    height, width = image.shape
    for k in range(len(places)):
        x, y = places[k, 0], places[k, 1]
        if not (half <= x < width - 1 - half and half <= y < height - 1 - half):
            patches[k] = np.nan
            continue
        for row in range(side):
            for column in range(side):
                patches[k, row, column] = _sample(image, x + column - half, y + row - half)


@compiled
def align_patches(image: F32, patches: F32, warps: F64, weights: F64, most: int, reach: float, places: F64) -> F64:
    """Move `places` in place to where the patches are in `image`; (m,) correlations, -1 where none was found.

    Lucas and Kanade's iteration in its inverse compositional form (Baker and Matthews 2004) with a translation
    alone free, on patches of zero mean and equal contrast: the lamp moves with the camera.

    Args:
        image: (height, width).
        patches: (m, s + 2, s + 2) with a border of one pixel for the gradient.
        warps: (m, 2, 2) from offsets in the patch to offsets in the image.
        weights: (s * s,) of the patch's pixels, row by row; they sum to one.
        most: iterations.
        reach: px a place may move.
        places: (m, 2), changed.
    """
    side = patches.shape[1] - 2
    half, n = side // 2, side * side
    height, width = image.shape
    found = np.full(len(places), -1.0)
    template, dx, dy, seen = np.empty(n), np.empty(n), np.empty(n), np.empty(n)
    for k in range(len(places)):
        at = 0
        for row in range(1, side + 1):
            for column in range(1, side + 1):
                template[at] = patches[k, row, column]
                dx[at] = 0.5 * (patches[k, row, column + 1] - patches[k, row, column - 1])
                dy[at] = 0.5 * (patches[k, row + 1, column] - patches[k, row - 1, column])
                at += 1
        template -= (weights * template).sum()
        contrast = np.sqrt((weights * template * template).sum())
        if not contrast >= FLAT:
            continue
        # What a change of brightness or contrast explains is no shift.
        dx -= (weights * dx).sum()
        dy -= (weights * dy).sum()
        dx -= (weights * dx * template).sum() / contrast**2 * template
        dy -= (weights * dy * template).sum() / contrast**2 * template
        xx, xy, yy = (weights * dx * dx).sum(), (weights * dx * dy).sum(), (weights * dy * dy).sum()
        determinant = xx * yy - xy * xy
        least = 0.5 * (xx + yy - np.sqrt(max((xx + yy) ** 2 - 4.0 * determinant, 0.0)))
        if not least >= MIN_EIGENVALUE * contrast**2:
            continue
        a, b, c, d = warps[k, 0, 0], warps[k, 0, 1], warps[k, 1, 0], warps[k, 1, 1]
        move_x, move_y, correlation, last = 0.0, 0.0, -1.0, False
        for step in range(most + 1):
            at, inside = 0, True
            for row in range(-half, half + 1):
                for column in range(-half, half + 1):
                    x = places[k, 0] + move_x + a * column + b * row
                    y = places[k, 1] + move_y + c * column + d * row
                    if not (0.0 <= x < width - 1 and 0.0 <= y < height - 1):
                        inside = False
                        break
                    seen[at] = _sample(image, x, y)
                    at += 1
                if not inside:
                    break
            if not inside:
                correlation = -1.0
                break
            seen -= (weights * seen).sum()
            spread = np.sqrt((weights * seen * seen).sum())
            if spread < 0.5 * FLAT:
                correlation = -1.0
                break
            correlation = (weights * seen * template).sum() / (spread * contrast)
            if last or step == most:
                break
            right_x = (weights * dx * (seen * (contrast / spread) - template)).sum()
            right_y = (weights * dy * (seen * (contrast / spread) - template)).sum()
            step_x, step_y = (yy * right_x - xy * right_y) / determinant, (xx * right_y - xy * right_x) / determinant
            length = np.sqrt(step_x * step_x + step_y * step_y)
            if length > LARGE_STEP_PX:
                step_x, step_y = step_x / length, step_y / length
            move_x -= a * step_x + b * step_y
            move_y -= c * step_x + d * step_y
            if move_x * move_x + move_y * move_y > reach * reach:
                correlation = -1.0
                break
            last = length < SMALL_STEP_PX
        found[k] = correlation
        if correlation > -1.0:
            places[k, 0] += move_x
            places[k, 1] += move_y
    return found
