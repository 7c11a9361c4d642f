"""What the other views know: their planes, seen from the reference."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.dense.cameras import Pinhole
from core.dense.patchmatch.jit import kernel
from core.geometry.pose import Pose

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]


@kernel
def transfer(planes: F32, M: F64, m: F64, back: F64, shift: F64, low: float, high: float, out: F32) -> None:
    """Write each plane of a source view into the reference pixel that it falls on; the nearest surface wins.

    Args:
        planes: (h, w, 4) of the source, w <= 0 = none.
        M (3, 3), m (3,): plane (gu, gv, w0) over the reference = M @ p / (1 - m @ p) for a plane p over the source.
        back (3, 3), shift (3,): reference pixel ~ back @ (x, y, 1) + shift * inverse_depth.
        low, high: limits of inverse depth in the reference.
        out: (h, w, 4) zeros; filled with w, gu, gv.
    """
    H, W = planes.shape[:2]
    for y in range(H):
        for x in range(W):
            w, gu, gv = planes[y, x, 0], planes[y, x, 1], planes[y, x, 2]
            if w <= 0.0:
                continue
            X = back[0, 0] * x + back[0, 1] * y + back[0, 2] + shift[0] * w
            Y = back[1, 0] * x + back[1, 1] * y + back[1, 2] + shift[1] * w
            Z = back[2, 0] * x + back[2, 1] * y + back[2, 2] + shift[2] * w
            if Z <= 1e-3:
                continue
            u, v = int(np.floor(X / Z + 0.5)), int(np.floor(Y / Z + 0.5))
            if u < 0 or v < 0 or u >= W or v >= H:
                continue
            at = w - gu * x - gv * y
            scale = 1.0 - (m[0] * gu + m[1] * gv + m[2] * at)
            if abs(scale) < 1e-6:
                continue
            a = (M[0, 0] * gu + M[0, 1] * gv + M[0, 2] * at) / scale
            b = (M[1, 0] * gu + M[1, 1] * gv + M[1, 2] * at) / scale
            c = (M[2, 0] * gu + M[2, 1] * gv + M[2, 2] * at) / scale
            inverse = a * u + b * v + c
            if inverse < low or inverse > high or inverse <= out[v, u, 0]:
                continue
            out[v, u, 0], out[v, u, 1], out[v, u, 2] = inverse, a, b


def planes_from_source(
    planes: F32, pinhole: Pinhole, reference: Pose, source: Pose, limits: tuple[float, float]
) -> F32:
    """(h, w, 4) planes of a source view over the pixels of the reference, zero where it shows nothing.

    A plane is ``pi . X = 1`` in the source's camera frame; with ``X_source = R X + t`` it is
    ``R^T pi / (1 - pi . t)`` in the reference's.
    """
    K = pinhole.index_matrix()
    moved = source.relative_to(reference)
    R, t = moved.R, moved.t
    inverse_K = np.linalg.inv(K)
    out = np.zeros_like(planes)
    M = inverse_K.T @ R.T @ K.T
    transfer(planes, M, K @ t, K @ R.T @ inverse_K, -K @ R.T @ t, limits[0], limits[1], out)
    return out
