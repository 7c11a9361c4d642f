"""Fused layers of DISK's U-Net between its convolutions, as compiled loops over channels-last arrays.

Arrays are float32 of shape (height, width, channels). Every kernel works on the rows [start, stop) so that
callers can share rows among threads (the interpreter lock is released); no sum crosses a row block, so
results do not depend on the number of threads. `scale`, `shift` and `slope` are per channel and
mean `x * scale + shift` followed by PReLU.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.jit import Function, compiled

Array = NDArray[np.float32]


def _jit(function: Function) -> Function:
    return compiled(function, fastmath={"contract", "reassoc", "nsz", "arcp"}, error_model="numpy")


@_jit
def pool(x: Array, out: Array, start: int, stop: int) -> None:
    """Mean of 2 x 2 pixels."""
    quarter = np.float32(0.25)
    for i in range(start, stop):
        for j in range(out.shape[1]):
            for c in range(out.shape[2]):
                top = x[2 * i, 2 * j, c] + x[2 * i, 2 * j + 1, c]
                out[i, j, c] = (top + x[2 * i + 1, 2 * j, c] + x[2 * i + 1, 2 * j + 1, c]) * quarter


@_jit
def row_moments(x: Array, reference: Array, out: Array, start: int, stop: int) -> None:
    """Per row: sums of `x - reference` (out[i, 0]) and of its square (out[i, 1]); out is (height, 2, channels)."""
    for i in range(start, stop):
        first, second = out[i, 0], out[i, 1]
        for j in range(x.shape[1]):
            for c in range(x.shape[2]):
                v = x[i, j, c] - reference[c]
                first[c] += v
                second[c] += v * v


@_jit
def row_moments_doubled(x: Array, reference: Array, out: Array, start: int, stop: int) -> None:
    """`row_moments` of the bilinearly doubled image, without making it; out is (2 * height, 2, channels).

    Along a row a sample meets its left and right neighbour with weights 3/4 and 1/4 each, so the two new
    pixels sum to 2 x / 4 * 3 + (left + right) / 4 and their squares to the quadratic form below.
    """
    width, channels = x.shape[1], x.shape[2]
    row = np.empty((width, channels), np.float32)
    for i in range(start, stop):
        _doubled_row(x, i, reference, row)
        first, second = out[i, 0], out[i, 1]
        for j in range(width):
            left, right = max(j - 1, 0), min(j + 1, width - 1)
            for c in range(channels):
                v, a, b = row[j, c], row[left, c], row[right, c]
                first[c] += np.float32(1.5) * v + np.float32(0.25) * (a + b)
                low = np.float32(0.75) * v + np.float32(0.25) * a
                high = np.float32(0.75) * v + np.float32(0.25) * b
                second[c] += low * low + high * high


@_jit
def _doubled_row(x: Array, i: int, reference: Array, out: Array) -> None:
    """Row `i` of the image doubled vertically, minus `reference`."""
    near = i // 2
    far = min(max(near - 1 if i % 2 == 0 else near + 1, 0), x.shape[0] - 1)
    for j in range(x.shape[1]):
        for c in range(x.shape[2]):
            out[j, c] = np.float32(0.75) * x[near, j, c] + np.float32(0.25) * x[far, j, c] - reference[c]


@_jit
def activate(x: Array, scale: Array, shift: Array, slope: Array, start: int, stop: int) -> None:
    """Instance norm and PReLU in place."""
    for i in range(start, stop):
        for j in range(x.shape[1]):
            for c in range(x.shape[2]):
                v = x[i, j, c] * scale[c] + shift[c]
                x[i, j, c] = v if v >= 0 else v * slope[c]


@_jit
def join(low: Array, skip: Array, scale: Array, shift: Array, slope: Array, out: Array, start: int, stop: int) -> None:
    """Double `low`, append the channels of `skip`, norm and PReLU: rows [start, stop) into out[0 : stop - start]."""
    width, channels = low.shape[1], low.shape[2]
    row = np.empty((width, channels), np.float32)
    zero = np.zeros(channels, np.float32)
    for i in range(start, stop):
        _doubled_row(low, i, zero, row)
        target = out[i - start]
        for j in range(2 * width):
            near = j // 2
            far = min(max(near - 1 if j % 2 == 0 else near + 1, 0), width - 1)
            for c in range(channels):
                v = np.float32(0.75) * row[near, c] + np.float32(0.25) * row[far, c]
                v = v * scale[c] + shift[c]
                target[j, c] = v if v >= 0 else v * slope[c]
            for c in range(skip.shape[2]):
                k = channels + c
                v = skip[i, j, c] * scale[k] + shift[k]
                target[j, k] = v if v >= 0 else v * slope[k]


@_jit
def patches(
    low: Array, skip: Array, scale: Array, shift: Array, slope: Array, pixels: NDArray[np.int64], out: Array
) -> None:
    """What `join` gives in the 5 x 5 pixels around each (x, y) of `pixels`; out is (n, 25, channels), zero outside."""
    height, width, channels = 2 * low.shape[0], 2 * low.shape[1], low.shape[2]
    for n in range(pixels.shape[0]):
        for tap in range(25):
            i, j = pixels[n, 1] + tap // 5 - 2, pixels[n, 0] + tap % 5 - 2
            target = out[n, tap]
            if i < 0 or j < 0 or i >= height or j >= width:
                target[:] = 0
                continue
            y, x = i // 2, j // 2
            yf = min(max(y - 1 if i % 2 == 0 else y + 1, 0), low.shape[0] - 1)
            xf = min(max(x - 1 if j % 2 == 0 else x + 1, 0), low.shape[1] - 1)
            for c in range(channels):
                here = np.float32(0.75) * low[y, x, c] + np.float32(0.25) * low[yf, x, c]
                beside = np.float32(0.75) * low[y, xf, c] + np.float32(0.25) * low[yf, xf, c]
                v = (np.float32(0.75) * here + np.float32(0.25) * beside) * scale[c] + shift[c]
                target[c] = v if v >= 0 else v * slope[c]
            for c in range(skip.shape[2]):
                k = channels + c
                v = skip[i, j, c] * scale[k] + shift[k]
                target[k] = v if v >= 0 else v * slope[k]


@_jit
def add_taps(taps: Array, width: int, heat: Array, start: int) -> None:
    """Add the 25 partial products (25, rows * width) of input rows from `start` on to the heat map they belong to."""
    rows = taps.shape[1] // width
    for k in range(25):
        dy, dx = k // 5 - 2, k % 5 - 2
        left, right = max(0, dx), min(width, width + dx)
        for r in range(rows):
            i = start + r - dy
            if 0 <= i < heat.shape[0]:
                for j in range(left, right):
                    heat[i, j - dx] += taps[k, r * width + j]


@_jit
def strict_maxima(heat: Array, radius: int, threshold: float, out: NDArray[np.int64]) -> int:
    """Pixels above `threshold` that exceed every other pixel of their window, in raster order.

    Pixels whose window leaves the image are none (as in kornia's `nms2d`). Fills out (n, 2) with (x, y) and
    returns how many there are.
    """
    count = 0
    for i in range(radius, heat.shape[0] - radius):
        for j in range(radius, heat.shape[1] - radius):
            v = heat[i, j]
            if not v > threshold or v <= heat[i, j - 1] or v <= heat[i, j + 1]:
                continue
            best = True
            for di in range(-radius, radius + 1):
                for dj in range(-radius, radius + 1):
                    if (di != 0 or dj != 0) and heat[i + di, j + dj] >= v:
                        best = False
                        break
                if not best:
                    break
            if best:
                out[count, 0] = j
                out[count, 1] = i
                count += 1
    return count
