"""Planes as inverse depth that is linear over the image, and random numbers by counter.

A scene plane seen by a pinhole has inverse depth that is an affine function of the pixel:
``1/z = w + gu * (u - u0) + gv * (v - v0)``. A hypothesis of a pixel is its (w, gu, gv): moving it to another pixel is
two multiplications, and the warp into a source image is linear in it (see `kernels`). ``w > 0`` alone
makes the plane face the camera.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.dense.patchmatch.jit import inlined

F32 = NDArray[np.float32]


@inlined
def uniform(key: np.uint64, counter: np.uint64) -> np.float32:
    """Random float32 in [0, 1): splitmix64 of (key, counter); no state, so no order of evaluation."""
    z = np.uint64(key) + np.uint64(counter) * np.uint64(0x9E3779B97F4A7C15)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    z = z ^ (z >> np.uint64(31))
    return np.float32(np.uint32(z >> np.uint64(40))) * np.float32(1.0 / 16777216.0)


@inlined
def slant_ok(
    w: np.float32, gu: np.float32, gv: np.float32, u: np.float32, v: np.float32, K: F32, min_cosine: np.float32
) -> bool:
    """Whether the plane is seen steeply enough: cosine of viewing ray and normal at least `min_cosine`.

    K holds f, cx, cy with whole-number pixel centres.
    """
    f, x, y = K[0], (u - K[1]) / K[0], (v - K[2]) / K[0]
    a, b = gu * f, gv * f
    c = w - a * x - b * y
    ok: bool = w * w >= min_cosine * min_cosine * (a * a + b * b + c * c) * (x * x + y * y + np.float32(1.0))
    return ok


def to_normals(planes: F32, K: NDArray[np.float64]) -> F32:
    """(h, w, 3) unit normals in the camera frame, facing the camera, of (h, w, 4) planes (zero where w is zero).

    K is (3, 3) with whole-number pixel centres.
    """
    h, w = planes.shape[:2]
    v, u = np.mgrid[0:h, 0:w].astype(np.float32)
    f, cx, cy = np.float32(K[0, 0]), np.float32(K[0, 2]), np.float32(K[1, 2])
    a, b = planes[..., 1] * f, planes[..., 2] * f
    c = planes[..., 0] - a * ((u - cx) / f) - b * ((v - cy) / f)
    normals = -np.stack([a, b, c], axis=-1)
    length = np.linalg.norm(normals, axis=-1, keepdims=True)
    return np.asarray(np.where(planes[..., :1] > 0, normals / np.maximum(length, 1e-20), 0), dtype=np.float32)


def from_normals(depth: F32, normals: F32, K: NDArray[np.float64]) -> F32:
    """(h, w, 4) planes (last channel zero) of depth (0 = none) and camera-frame normals: inverse of `to_normals`."""
    h, w = depth.shape
    v, u = np.mgrid[0:h, 0:w].astype(np.float32)
    f, cx, cy = np.float32(K[0, 0]), np.float32(K[0, 2]), np.float32(K[1, 2])
    planes = np.zeros((h, w, 4), np.float32)
    valid = depth > 0
    n = normals.astype(np.float32)
    along = n[..., 0] * ((u - cx) / f) + n[..., 1] * ((v - cy) / f) + n[..., 2]
    valid &= along < -1e-4
    inverse = np.where(valid, 1.0 / np.where(depth > 0, depth, 1.0), 0.0)
    scale = inverse / (np.where(valid, along, 1.0) * f)
    planes[..., 0], planes[..., 1], planes[..., 2] = inverse, n[..., 0] * scale, n[..., 1] * scale
    return planes


def upsample(planes: F32, width: int, height: int) -> F32:
    """Carry planes to the image of twice the size: each fine pixel takes its coarse pixel's plane.

    Coarse pixel i covers fine pixels 2i and 2i + 1, its centre lies at fine 2i + 0.5.
    """
    v = np.minimum(np.arange(height) // 2, planes.shape[0] - 1)
    u = np.minimum(np.arange(width) // 2, planes.shape[1] - 1)
    fine = np.ascontiguousarray(planes[v][:, u])
    fine[..., 1:3] *= 0.5
    du = (np.arange(width) - (2 * u + 0.5)).astype(np.float32)
    dv = (np.arange(height) - (2 * v + 0.5)).astype(np.float32)
    fine[..., 0] += fine[..., 1] * du[None, :] + fine[..., 2] * dv[:, None]
    return fine
