"""How well a depth map agrees with the depth maps of its source views."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.dense.patchmatch.jit import kernel
from core.dense.patchmatch.kernels import Sources, forward_backward

f32 = np.float32
F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]


@kernel
def count_consistent(planes: F32, sources: Sources, cosines: F32, max_error: np.float32, out: U8) -> None:
    """Count, for every pixel with a plane, the sources that see the same place.

    A source agrees when its own depth leads back to within `max_error` px of the pixel and the two rays meet under
    an angle whose cosine is at most `cosines`[0].

    Args:
        planes: (h, w, 4); pixels with w <= 0 get 0.
        sources: `kernels.Sources` with depth maps.
        cosines: (1 + 3 S + 3,) float32: the largest cosine, then f, cx, cy, then the centres of the sources in the
            reference's camera frame.
        out: (h, w) uint8 counts.
    """
    H, W = planes.shape[:2]
    A, b = sources.A, sources.b
    S = A.shape[0]
    f, cx, cy = cosines[1], cosines[2], cosines[3]
    for v in range(H):
        for u in range(W):
            w = planes[v, u, 0]
            n = 0
            if w > f32(0):
                rx, ry = (f32(u) - cx) / f, (f32(v) - cy) / f
                px, py, pz = rx / w, ry / w, f32(1) / w
                for s in range(S):
                    Z = A[s, 2, 0] * f32(u) + A[s, 2, 1] * f32(v) + A[s, 2, 2] + b[s, 2] * w
                    if f32(1e-3) >= Z:
                        continue
                    x = (A[s, 0, 0] * f32(u) + A[s, 0, 1] * f32(v) + A[s, 0, 2] + b[s, 0] * w) / Z
                    y = (A[s, 1, 0] * f32(u) + A[s, 1, 1] * f32(v) + A[s, 1, 2] + b[s, 1] * w) / Z
                    if x < f32(0) or y < f32(0) or x > f32(W - 1) or y > f32(H - 1):
                        continue
                    if forward_backward(s, x, y, f32(u), f32(v), sources) > max_error:
                        continue
                    ox, oy, oz = px - cosines[4 + 3 * s], py - cosines[5 + 3 * s], pz - cosines[6 + 3 * s]
                    dot = px * ox + py * oy + pz * oz
                    length = np.sqrt((px * px + py * py + pz * pz) * (ox * ox + oy * oy + oz * oz))
                    if dot <= cosines[0] * length:
                        n += 1
            out[v, u] = n
