"""Compiled matching kernels: bilateral NCC under the local affine warp of a plane, and one checkerboard sweep.

Speed comes from four choices. A hypothesis is an inverse-depth plane (`planes`), so the warped patch centre and its
Jacobian are a few multiplications. Source images are interleaved: one 32-bit word holds the four grey values around a
sample, so bilinear interpolation is one load. The window is 24 samples in a disc, a multiple of the
vector width, so the compiler vectorises the loop over it. The bounds test is made once a patch.

Propagation follows ACMH (Xu and Tao, 2019): eight regions of the other colour of the checkerboard, in each the best
hypothesis. The bilateral weights are those of COLMAP's PatchMatch.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from core.dense.patchmatch.jit import inlined, kernel

f32 = np.float32
F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
Source = int | np.int64
"""Number of a source view."""

_SAMPLES = [(x, y) for y in range(-5, 6, 2) for x in range(-5, 6, 2) if abs(x) + abs(y) <= 6]
TAPS = len(_SAMPLES)
"""24 samples at odd offsets in a disc of radius 5.1 px."""
DX = np.array([x for x, _ in _SAMPLES], np.float32)
DY = np.array([y for _, y in _SAMPLES], np.float32)
IX, IY = DX.astype(np.int32), DY.astype(np.int32)
RADIUS = 5
SPATIAL = np.exp(-(DX**2 + DY**2) / (2.0 * 5.0**2)).astype(np.float32)
NOISE_VARIANCE = f32(2.0)
"""Grey levels squared, added to both variances: patches without texture cannot correlate well by chance."""
MIN_COSINE = f32(0.12)
"""Planes seen at more than 83 degrees are not tried."""
NO_MATCH = f32(2.0)
"""Cost of a patch that leaves the source image."""
MAX_GEOMETRIC_ERROR = f32(3.0)
"""Cap of the forward-backward error, px (COLMAP)."""

_NEAR = ((0, -1), (-1, -2), (1, -2), (-2, -3), (2, -3), (-3, -4), (3, -4))
_FAR = tuple((0, -3 - 2 * i) for i in range(11))
_QUARTER_TURNS = ((1, 0, 0, 1), (0, -1, 1, 0), (-1, 0, 0, -1), (0, 1, -1, 0))
_REGIONS = [
    [(a * x + b * y, c * x + d * y) for x, y in region] for region in (_NEAR, _FAR) for a, b, c, d in _QUARTER_TURNS
]
REGION_START = np.cumsum([0] + [len(region) for region in _REGIONS]).astype(np.int32)
"""Eight regions of pixels of the other colour: four near wedges, four far strips (ACMH)."""
REGION_X = np.array([x for region in _REGIONS for x, _ in region], np.int32)
REGION_Y = np.array([y for region in _REGIONS for _, y in region], np.int32)


class Sources(NamedTuple):
    """Source images at one scale, and how to warp into them and back. Pixel centres at whole numbers."""

    A: F32
    """(S, 3, 3): source pixel ~ A @ (u, v, 1) + b * inverse_depth."""
    b: F32
    """(S, 3)"""
    packed: NDArray[np.uint32]
    """(S * h * w,) interleaved grey images, see `pack`."""
    inverse_depth: F32
    """(S, h, w) of the sources' own depth maps, 0 = unknown; (S, 1, 1) when `consistency` is 0."""
    back: F32
    """(S, 3, 3): reference pixel ~ back @ (x, y, 1) + shift * inverse_depth."""
    shift: F32
    """(S, 3)"""
    consistency: np.float32
    """Weight of the forward-backward error, cost per px."""


class Patch(NamedTuple):
    """Scratch for one reference patch and the rays through its centre."""

    weight: F32
    """(TAPS,) bilateral weights, sum 1."""
    weighted: F32
    """(TAPS,) weight x grey."""
    q: F32
    """(S, 3) A @ (u, v, 1)."""
    costs: F32
    """(best,) smallest costs over the sources, ascending."""
    order: NDArray[np.int32]
    """(best,) the sources they belong to."""
    trial: F32
    """(3,) the plane under test."""


def scratch(n_sources: int, best: int) -> Patch:
    """Room for one thread's patches; kernels allocate nothing themselves."""
    return Patch(
        np.empty(TAPS, np.float32),
        np.empty(TAPS, np.float32),
        np.empty((n_sources, 3), np.float32),
        np.empty(best, np.float32),
        np.empty(best, np.int32),
        np.empty(3, np.float32),
    )


@kernel
def pack(grey: U8, out: NDArray[np.uint32]) -> None:
    """Interleave a (h, w) uint8 image: out[y * w + x] holds the 2 x 2 block at (x, y), one byte each."""
    h, w = grey.shape
    for y in range(h):
        y1 = min(y + 1, h - 1)
        for x in range(w):
            x1 = min(x + 1, w - 1)
            low = np.uint32(grey[y, x]) | (np.uint32(grey[y, x1]) << np.uint32(8))
            high = (np.uint32(grey[y1, x]) << np.uint32(16)) | (np.uint32(grey[y1, x1]) << np.uint32(24))
            out[y * w + x] = low | high


@inlined
def reference_patch(
    grey: U8, guide: U8, u: int, v: int, A: F32, colour_weight: F32, patch: Patch
) -> tuple[np.float32, np.float32]:
    """Fill `patch` for pixel (u, v) of the (h, w) uint8 reference; returns weighted mean and variance.

    `guide` is the (h, w) uint8 picture whose grey differences to the centre choose the bilateral weights from
    the (256,) `colour_weight`.
    """
    centre = np.int32(guide[v, u])
    total, first, second = f32(0), f32(0), f32(0)
    for i in range(TAPS):
        value = np.int32(grey[v + IY[i], u + IX[i]])
        w = SPATIAL[i] * colour_weight[abs(np.int32(guide[v + IY[i], u + IX[i]]) - centre)]
        patch.weight[i] = w
        patch.weighted[i] = w * f32(value)
        total += w
        first += w * f32(value)
        second += w * f32(value) * f32(value)
    scale = f32(1) / total
    for i in range(TAPS):
        patch.weight[i] *= scale
        patch.weighted[i] *= scale
    for s in range(A.shape[0]):
        for i in range(3):
            patch.q[s, i] = A[s, i, 0] * f32(u) + A[s, i, 1] * f32(v) + A[s, i, 2]
    mean = first * scale
    return mean, second * scale - mean * mean


@inlined
def patch_cost(
    packed: NDArray[np.uint32],
    base: Source,
    W: int,
    x: np.float32,
    y: np.float32,
    xu: np.float32,
    yu: np.float32,
    xv: np.float32,
    yv: np.float32,
    patch: Patch,
    mean: np.float32,
    variance: np.float32,
) -> np.float32:
    """1 - NCC of the reference patch and the source patch at (x, y) with Jacobian (xu, xv; yu, yv)."""
    weight, weighted = patch.weight, patch.weighted
    s1, s2, s12 = f32(0), f32(0), f32(0)
    for i in range(TAPS):
        px = x + xu * DX[i] + xv * DY[i]
        py = y + yu * DX[i] + yv * DY[i]
        ix, iy = np.int32(px), np.int32(py)
        fx, fy = px - f32(ix), py - f32(iy)
        block = packed[np.uint32(np.int32(base) + iy * np.int32(W) + ix)]
        a = f32(np.int32(block & np.uint32(255)))
        b = f32(np.int32((block >> np.uint32(8)) & np.uint32(255)))
        c = f32(np.int32((block >> np.uint32(16)) & np.uint32(255)))
        d = f32(np.int32(block >> np.uint32(24)))
        top, bottom = a + fx * (b - a), c + fx * (d - c)
        value = top + fy * (bottom - top)
        s1 += weight[i] * value
        s2 += weight[i] * value * value
        s12 += weighted[i] * value
    source_variance = max(s2 - s1 * s1, f32(0)) + NOISE_VARIANCE
    cost: np.float32 = f32(1) - (s12 - s1 * mean) / np.sqrt(source_variance * (variance + NOISE_VARIANCE))
    return cost


@inlined
def view_cost(
    s: Source,
    w: np.float32,
    gu: np.float32,
    gv: np.float32,
    u: np.float32,
    v: np.float32,
    sources: Sources,
    W: int,
    H: int,
    patch: Patch,
    mean: np.float32,
    variance: np.float32,
) -> np.float32:
    """Cost of a plane at pixel (u, v) in source s: 1 - NCC plus the weighted forward-backward error."""
    A, b, q = sources.A, sources.b, patch.q
    X, Y, Z = q[s, 0] + b[s, 0] * w, q[s, 1] + b[s, 1] * w, q[s, 2] + b[s, 2] * w
    if f32(1e-3) >= Z:
        return NO_MATCH
    r = f32(1) / Z
    x, y = X * r, Y * r
    zu, zv = A[s, 2, 0] + b[s, 2] * gu, A[s, 2, 1] + b[s, 2] * gv
    xu, xv = (A[s, 0, 0] + b[s, 0] * gu - x * zu) * r, (A[s, 0, 1] + b[s, 0] * gv - x * zv) * r
    yu, yv = (A[s, 1, 0] + b[s, 1] * gu - y * zu) * r, (A[s, 1, 1] + b[s, 1] * gv - y * zv) * r
    ex, ey = f32(RADIUS) * (abs(xu) + abs(xv)), f32(RADIUS) * (abs(yu) + abs(yv))
    if x - ex < f32(0) or y - ey < f32(0) or x + ex >= f32(W - 1) or y + ey >= f32(H - 1):
        return NO_MATCH
    cost = patch_cost(sources.packed, s * W * H, W, x, y, xu, yu, xv, yv, patch, mean, variance)
    if sources.consistency > f32(0):
        cost += sources.consistency * forward_backward(s, x, y, u, v, sources)
    return cost


@inlined
def forward_backward(
    s: Source, x: np.float32, y: np.float32, u: np.float32, v: np.float32, sources: Sources
) -> np.float32:
    """Distance in px between (u, v) and the pixel seen from where source s sees its own surface at (x, y); capped."""
    inverse = sources.inverse_depth[s, np.int32(y + f32(0.5)), np.int32(x + f32(0.5))]
    if inverse <= f32(0):
        return MAX_GEOMETRIC_ERROR
    back, shift = sources.back, sources.shift
    X = back[s, 0, 0] * x + back[s, 0, 1] * y + back[s, 0, 2] + shift[s, 0] * inverse
    Y = back[s, 1, 0] * x + back[s, 1, 1] * y + back[s, 1, 2] + shift[s, 1] * inverse
    Z = back[s, 2, 0] * x + back[s, 2, 1] * y + back[s, 2, 2] + shift[s, 2] * inverse
    if f32(1e-3) >= Z:
        return MAX_GEOMETRIC_ERROR
    du, dv = X / Z - u, Y / Z - v
    return min(np.sqrt(du * du + dv * dv), MAX_GEOMETRIC_ERROR)


@inlined
def plane_cost(
    w: np.float32,
    gu: np.float32,
    gv: np.float32,
    u: np.float32,
    v: np.float32,
    sources: Sources,
    W: int,
    H: int,
    patch: Patch,
    mean: np.float32,
    variance: np.float32,
    first: Source,
    second: Source,
    limit: np.float32,
) -> np.float32:
    """Mean cost over the best sources, so that a highlight or an occlusion in one does not decide.

    `first` and `second` are the sources that match best so far at this pixel. They are tried at once; when
    their mean is above `limit` the plane is given up without looking at the others, since it would have to be
    hidden in both to be right.
    """
    best = patch.costs.size
    for i in range(best):
        patch.costs[i] = f32(1e9)
        patch.order[i] = 0
    for k in range(sources.A.shape[0]):
        s: Source = k
        if k == 0:
            s = first
        elif k == 1:
            s = second
        elif k <= max(first, second):
            s = _kth_other(k, first, second)
        c = view_cost(s, w, gu, gv, u, v, sources, W, H, patch, mean, variance)
        for i in range(best):
            if c < patch.costs[i]:
                c, patch.costs[i] = patch.costs[i], c
                s, patch.order[i] = patch.order[i], s
        if k == 1 and patch.costs[0] + patch.costs[1 % best] > f32(2) * limit:
            return f32(1e9)
    total = f32(0)
    for i in range(best):
        total += patch.costs[i]
    return total / f32(best)


@inlined
def _kth_other(k: int, first: Source, second: Source) -> Source:
    """The source at place k >= 2 when `first` and `second` come first and the rest keep their order."""
    low, high = min(first, second), max(first, second)
    s = k - 2
    if s >= low:
        s += 1
    if s >= high:
        s += 1
    return s
