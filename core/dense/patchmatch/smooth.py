"""Local plane fits: normals that the fusion can trust, from depths that agree with their neighbours."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.dense.patchmatch.jit import kernel

f32 = np.float32
F32 = NDArray[np.float32]
Mask = NDArray[np.bool_]
MIN_SAMPLES = 8
"""Fewer agreeing neighbours leave the pixel's plane as it is."""


@kernel
def fit_rows(
    planes: F32, valid: Mask, radius: int, wide: np.float32, narrow: np.float32, out: F32, y0: int, y1: int
) -> None:
    """Fit a plane to the inverse depths around every valid pixel of rows [y0, y1).

    Two rounds of weighted least squares over the (2 radius + 1)^2 window: first over the neighbours within `wide` of
    the pixel's own plane or depth, then over those within `narrow` of the first fit (both relative). Better matches
    count more.

    Args:
        planes: (h, w, 4) w, gu, gv, cost. valid: (h, w) bool.
        out: (h, w, 4), written where valid; the cost is copied.
    """
    H, W = valid.shape
    for v in range(y0, y1):
        for u in range(W):
            if not valid[v, u]:
                continue
            w, gu, gv = planes[v, u, 0], planes[v, u, 1], planes[v, u, 2]
            centre = w
            for attempt in range(2):
                tolerance = (wide if attempt == 0 else narrow) * centre
                n = 0
                s, sx, sy, sxx, sxy, syy = f32(0), f32(0), f32(0), f32(0), f32(0), f32(0)
                t, tx, ty = f32(0), f32(0), f32(0)
                for y in range(max(0, v - radius), min(H, v + radius + 1)):
                    for x in range(max(0, u - radius), min(W, u + radius + 1)):
                        if not valid[y, x]:
                            continue
                        dx, dy = f32(x - u), f32(y - v)
                        off = planes[y, x, 0] - w
                        if abs(off - gu * dx - gv * dy) > tolerance and (attempt == 1 or abs(off) > tolerance):
                            continue
                        k = max(f32(1.05) - planes[y, x, 3], f32(0.05))
                        n += 1
                        s += k
                        sx += k * dx
                        sy += k * dy
                        sxx += k * dx * dx
                        sxy += k * dx * dy
                        syy += k * dy * dy
                        t += k * off
                        tx += k * off * dx
                        ty += k * off * dy
                if n < MIN_SAMPLES:
                    continue
                # Normal equations about the weighted mean, so that they stay well conditioned in float32.
                mx, my, mt = sx / s, sy / s, t / s
                a, b, c = sxx - s * mx * mx, sxy - s * mx * my, syy - s * my * my
                p, q = tx - s * mx * mt, ty - s * my * mt
                det = a * c - b * b
                if det <= f32(1e-3) * a * c:
                    continue
                gu = (p * c - q * b) / det
                gv = (q * a - p * b) / det
                w = w + mt - gu * mx - gv * my
            if abs(w - centre) > narrow * centre:
                w = centre
            out[v, u, 0], out[v, u, 1], out[v, u, 2], out[v, u, 3] = w, gu, gv, planes[v, u, 3]
