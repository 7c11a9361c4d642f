"""One red-black sweep over rows of the image: spatial propagation, then refinement."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.dense.patchmatch.jit import inlined, kernel
from core.dense.patchmatch.kernels import (
    RADIUS,
    REGION_START,
    REGION_X,
    REGION_Y,
    Patch,
    Source,
    Sources,
    plane_cost,
    reference_patch,
)
from core.dense.patchmatch.planes import slant_ok, uniform

f32 = np.float32
F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
Mask = NDArray[np.bool_]
DRAWS = 64
"""Random numbers reserved per pixel and sweep."""
MIN_COSINE = f32(0.12)
"""Planes seen at more than 83 degrees are not tried."""
SAME_DEPTH, SAME_SLOPE = f32(2e-4), f32(5e-3)
"""Relative differences below which a neighbour's plane is the pixel's own: a few hundredths of a pixel of disparity."""
SLOPE_SPAN = f32(1.5)
"""Change of slant at full step, relative inverse depth per unit of the image plane."""
EARLY_MARGIN = f32(0.02)
"""The two best views alone may be so much worse before a plane is given up."""


@kernel
def score_rows(
    planes: F32,
    pairs: U8,
    grey: U8,
    guide: U8,
    mask: Mask,
    sources: Sources,
    patch: Patch,
    colour_weight: F32,
    y0: int,
    y1: int,
) -> None:
    """Cost of every present plane of rows [y0, y1) into channel 3, its two best sources into `pairs`."""
    H, W = grey.shape
    S = sources.A.shape[0]
    for v in range(max(y0, RADIUS), min(y1, H - RADIUS)):
        for u in range(RADIUS, W - RADIUS):
            if not mask[v, u] or planes[v, u, 0] <= f32(0):
                continue
            mean, variance = reference_patch(grey, guide, u, v, sources.A, colour_weight, patch)
            planes[v, u, 3] = plane_cost(
                planes[v, u, 0], planes[v, u, 1], planes[v, u, 2], f32(u), f32(v),
                sources, W, H, patch, mean, variance, 0, min(1, S - 1), f32(1e9),
            )  # fmt: skip
            pairs[v, u, 0], pairs[v, u, 1] = _best_two(patch, S)


@kernel
def offer_rows(
    planes: F32,
    pairs: U8,
    others: F32,
    margin: np.float32,
    grey: U8,
    guide: U8,
    mask: Mask,
    sources: Sources,
    patch: Patch,
    colour_weight: F32,
    y0: int,
    y1: int,
) -> None:
    """Take the (n, h, w, 4) `others` of rows [y0, y1) that cost less than the pixel's plane plus `margin`; in place.

    Others without a plane are passed over; `planes`, `pairs` and the rest are as in `sweep_rows`.
    """
    H, W = grey.shape
    for v in range(max(y0, RADIUS), min(y1, H - RADIUS)):
        for u in range(RADIUS, W - RADIUS):
            if not mask[v, u]:
                continue
            first: Source
            second: Source
            first, second, known = np.int64(pairs[v, u, 0]), np.int64(pairs[v, u, 1]), False
            mean, variance = f32(0), f32(0)
            for n in range(others.shape[0]):
                w, gu, gv = others[n, v, u, 0], others[n, v, u, 1], others[n, v, u, 2]
                if w <= f32(0):
                    continue
                if not known:
                    mean, variance = reference_patch(grey, guide, u, v, sources.A, colour_weight, patch)
                    known = True
                c0 = planes[v, u, 3]
                c = plane_cost(w, gu, gv, f32(u), f32(v), sources, W, H, patch, mean, variance, first, second, f32(1e9))
                if c < c0 + margin:
                    planes[v, u, 0], planes[v, u, 1], planes[v, u, 2], planes[v, u, 3] = w, gu, gv, c
                    first, second = _best_two(patch, sources.A.shape[0])
            pairs[v, u, 0], pairs[v, u, 1] = first, second


@inlined
def _best_two(patch: Patch, n_sources: int) -> tuple[Source, Source]:
    """The two best sources of the plane scored last; two different ones wherever there are two."""
    first = patch.order[0]
    second = patch.order[1] if patch.order.size > 1 else (first + 1) % n_sources
    return first, second


@kernel
def sweep_rows(
    planes: F32,
    pairs: U8,
    grey: U8,
    guide: U8,
    mask: Mask,
    sources: Sources,
    patch: Patch,
    colour_weight: F32,
    K: F32,
    limits: F32,
    colour: int,
    key: np.uint64,
    step: np.float32,
    draws: int,
    y0: int,
    y1: int,
) -> None:
    """Update the pixels of one colour in rows [y0, y1), reading only the other colour beside itself.

    Args:
        planes: (h, w, 4) float32: w, gu, gv, cost; updated in place.
        pairs: (h, w, 2) uint8: the two sources that match best; updated in place.
        grey, guide: (h, w) uint8 reference and what guides its bilateral weights.
        mask: (h, w) bool, where a patch lies inside the image.
        sources: `kernels.Sources`.
        patch: `kernels.Patch`, whose `costs` says over how many sources the cost is a mean.
        K: (3,) float32 f, cx, cy with whole-number pixel centres; limits: (2,) smallest and largest inverse depth.
        colour: 0 or 1; key: random key of this view, scale and sweep.
        step: size of refinement, 1 = the whole range; draws: refinements tried per pixel.
    """
    H, W = grey.shape
    S = sources.A.shape[0]
    trial = patch.trial
    for v in range(max(y0, RADIUS), min(y1, H - RADIUS)):
        start = RADIUS + ((RADIUS + v + colour) & 1)
        for u in range(start, W - RADIUS, 2):
            if not mask[v, u]:
                continue
            fu, fv = f32(u), f32(v)
            mean, variance = reference_patch(grey, guide, u, v, sources.A, colour_weight, patch)
            w0, gu0, gv0, c0 = planes[v, u, 0], planes[v, u, 1], planes[v, u, 2], planes[v, u, 3]
            first: Source
            second: Source
            first, second = np.int64(pairs[v, u, 0]), np.int64(pairs[v, u, 1])
            counter = np.uint64(v * W + u) * np.uint64(DRAWS)
            for k in range(8 + draws):
                if k < 8:
                    found = _neighbour(planes, u, v, k, trial)
                else:
                    found = _perturbed(w0, gu0, gv0, K[0], limits, key, counter, k - 8, step, trial)
                w, gu, gv = trial[0], trial[1], trial[2]
                if not found or w < limits[0] or w > limits[1] or not slant_ok(w, gu, gv, fu, fv, K, MIN_COSINE):
                    continue
                slope = SAME_SLOPE * w0 / K[0]
                if abs(w - w0) < SAME_DEPTH * w0 and abs(gu - gu0) < slope and abs(gv - gv0) < slope:
                    continue
                c = plane_cost(
                    w, gu, gv, fu, fv, sources, W, H, patch, mean, variance, first, second, c0 + EARLY_MARGIN
                )
                if c < c0:
                    w0, gu0, gv0, c0 = w, gu, gv, c
                    first, second = _best_two(patch, S)
            planes[v, u, 0], planes[v, u, 1], planes[v, u, 2], planes[v, u, 3] = w0, gu0, gv0, c0
            pairs[v, u, 0], pairs[v, u, 1] = first, second


@inlined
def _neighbour(planes: F32, u: int, v: int, region: int, trial: F32) -> bool:
    """The best plane of a region, continued to (u, v), into `trial`; False when the region is outside."""
    H, W = planes.shape[:2]
    nx, ny, nc = -1, -1, f32(1e9)
    for k in range(REGION_START[region], REGION_START[region + 1]):
        x, y = u + REGION_X[k], v + REGION_Y[k]
        if x >= 0 and y >= 0 and x < W and y < H and planes[y, x, 3] < nc:
            nx, ny, nc = x, y, planes[y, x, 3]
    if nx < 0:
        return False
    trial[1], trial[2] = planes[ny, nx, 1], planes[ny, nx, 2]
    trial[0] = planes[ny, nx, 0] + trial[1] * f32(u - nx) + trial[2] * f32(v - ny)
    return True


@inlined
def _perturbed(
    w0: np.float32,
    gu0: np.float32,
    gv0: np.float32,
    f: np.float32,
    limits: F32,
    key: np.uint64,
    counter: np.uint64,
    k: int,
    step: np.float32,
    trial: F32,
) -> bool:
    """The plane with a random change of depth, of slant, or of both in turn; small changes as often as large ones."""
    at = counter + np.uint64(4 * k)
    size = step * uniform(key, at)
    size *= uniform(key, at + np.uint64(1))
    trial[0], trial[1], trial[2] = w0, gu0, gv0
    if k % 3 != 1:
        trial[0] = w0 + (uniform(key, at + np.uint64(2)) - f32(0.5)) * size * (limits[1] - limits[0])
    if k % 3 != 0:
        angle = uniform(key, at + np.uint64(3)) * f32(2.0 * np.pi)
        slope = SLOPE_SPAN * np.sqrt(size) * w0 / f
        trial[1] += slope * np.cos(angle)
        trial[2] += slope * np.sin(angle)
    return True
