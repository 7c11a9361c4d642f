"""First planes of a depth map: from the sparse points, mixed with random ones."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay, QhullError, cKDTree

from core.dense.cameras import Pinhole
from core.geometry.pose import Pose

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]

RANDOM_SHARE = 0.4
"""Share of pixels that start random, so that what the sparse points do not show can be found."""


def initial_planes(
    points: F64, pose: Pose, pinhole: Pinhole, limits: tuple[float, float], rng: np.random.Generator
) -> F32:
    """(h, w, 4) planes (w, gu, gv, 0) over the image of `pinhole`.

    Inside the hull of the projected points the planes are those of their Delaunay triangles, which is exact for inverse
    depth; elsewhere the nearest point's depth, facing the camera. A share of the pixels is random.

    Args:
        points: (n, 3) sparse points that this view observes, world frame.
        limits: smallest and largest inverse depth.
    """
    h, w = pinhole.height, pinhole.width
    planes = np.zeros((h, w, 4), np.float32)
    v, u = np.mgrid[0:h, 0:w].astype(np.float64)
    pixels = np.column_stack([u.ravel(), v.ravel()])
    inverse, gradient = _from_points(points, pose, pinhole, pixels, limits)
    planes[..., 0] = inverse.reshape(h, w)
    planes[..., 1:3] = gradient.reshape(h, w, 2)
    random = rng.random((h, w)) < RANDOM_SHARE
    n = int(random.sum())
    planes[random, 0] = rng.uniform(limits[0], limits[1], n)
    slope = rng.uniform(-1.5, 1.5, (n, 2)) / pinhole.focal_px
    planes[random, 1:3] = slope * planes[random, 0:1]
    return planes


def _from_points(
    points: F64, pose: Pose, pinhole: Pinhole, pixels: F64, limits: tuple[float, float]
) -> tuple[F64, F64]:
    """Inverse depth (n,) and its gradient (n, 2) at (n, 2) pixels."""
    gradient = np.zeros((len(pixels), 2))
    X = pose.in_camera(points)
    X = X[X[:, 2] > 0]
    if not len(X):
        return np.full(len(pixels), sum(limits) / 2), gradient
    K = pinhole.index_matrix()
    at = X[:, :2] / X[:, 2:] * pinhole.focal_px + K[:2, 2]
    value = 1.0 / X[:, 2]
    _, nearest = cKDTree(at).query(pixels)
    inverse = value[nearest]
    try:
        mesh = Delaunay(at)
    except (QhullError, ValueError):
        return np.clip(inverse, *limits), gradient
    simplex = mesh.find_simplex(pixels)
    corners = at[mesh.simplices]
    edges = corners[:, 1:] - corners[:, :1]
    rise = value[mesh.simplices[:, 1:]] - value[mesh.simplices[:, :1]]
    solvable = np.abs(np.linalg.det(edges)) > 1e-6
    slope = np.zeros((len(edges), 2))
    slope[solvable] = np.linalg.solve(edges[solvable], rise[solvable][..., None])[..., 0]
    inside = (simplex >= 0) & solvable[simplex]
    s = simplex[inside]
    found = value[mesh.simplices[s, 0]] + ((pixels[inside] - corners[s, 0]) * slope[s]).sum(axis=1)
    inverse[inside], gradient[inside] = found, slope[s]
    return np.clip(inverse, *limits), gradient
