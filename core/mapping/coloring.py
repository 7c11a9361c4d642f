"""From sparse support points to colours of the surface: equations 3.1 and 3.2 of the thesis."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.boxes import in_box

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]
U8 = NDArray[np.uint8]

DEFECT_RGB = (255, 0, 0)
BASE_RGB = (180, 180, 180)
"""Base colour of a mesh that has none."""
_FEW_POINTS = 16


@dataclass(frozen=True)
class Coloring:
    """Strongest influence of a support point on every vertex."""

    weight: F32
    """(n,) in [0, 1]; 0 = no support point near."""
    point: I32
    """(n,) row of the support point with that influence; -1 = none."""


def coloring_radius(diagonal: float, fraction: float) -> float:
    """Equation 3.1: r_c = fraction * d_mesh, scene units (thesis: 0.01)."""
    return fraction * diagonal


def vertex_weights(vertices: F64, points: F64, radius: float, sigma: float, threads: int = 1) -> Coloring:
    """Equation 3.2 for all vertices: the maximum over the support points of exp(-0.5 (|v - p| / sigma)^2).

    A point acts on the vertices of its ball of `radius`; on the nearest single vertex if the ball is empty.
    The weight falls with distance, so the maximum over points is the weight of the nearest point: one
    query of a tree over the points per vertex replaces the union of all balls and gives the same numbers.

    Args:
        vertices: (n, 3) of the mesh.
        points: (m, 3) support points, world coordinates.
        radius: r_c, scene units.
        sigma: of the decay, scene units.
        threads: of the tree queries.
    """
    weight = np.zeros(len(vertices), np.float32)
    point = np.full(len(vertices), -1, np.int32)
    if not len(points) or not len(vertices):
        return Coloring(weight, point)
    low, high = points.min(axis=0) - radius, points.max(axis=0) + radius
    near = np.flatnonzero(in_box(vertices, (*low, *high)))
    if len(near):
        # The tree's bound is exclusive, the ball is closed.
        bound = np.nextafter(radius, np.inf)
        over_points: Any = cKDTree(points)
        distance, row = over_points.query(vertices[near], distance_upper_bound=bound, workers=threads)
        hit = np.isfinite(distance)
        weight[near[hit]] = _decay(distance[hit], sigma)
        point[near[hit]] = row[hit]
    # A point that is the nearest of some vertex has that vertex in its ball; the others may be alone.
    others = np.setdiff1d(np.arange(len(points)), point)
    vertex, distance = _nearest_vertices(vertices, points[others], threads)
    for k in np.flatnonzero(distance > radius):
        value = _decay(distance[k : k + 1], sigma)[0]
        if value > weight[vertex[k]] or point[vertex[k]] < 0:
            weight[vertex[k]], point[vertex[k]] = value, others[k]
    return Coloring(weight, point)


def _nearest_vertices(vertices: F64, points: F64, threads: int) -> tuple[I64, F64]:
    """Nearest vertex of each point and its distance; a tree over the vertices pays off for more than a few points."""
    if len(points) > _FEW_POINTS:
        tree: Any = cKDTree(vertices, balanced_tree=False, compact_nodes=False)
        distance, vertex = tree.query(points, workers=threads)
        return vertex, distance
    squared = [((vertices - point) ** 2).sum(axis=1) for point in points]
    nearest = np.array([each.argmin() for each in squared], dtype=np.int64)
    return nearest, np.linalg.norm(vertices[nearest] - points, axis=1)


def _decay(distance: F64, sigma: float) -> F32:
    weights: F32 = np.exp(-0.5 * (distance / sigma) ** 2).astype(np.float32)
    return weights


def blend(base: U8 | None, weight: F32) -> U8:
    """Vertex colours: the base (grey where the mesh has none) blended linearly towards red by the weight."""
    start = np.broadcast_to(np.array(BASE_RGB, np.float64), (len(weight), 3)) if base is None else base.astype(float)
    share = weight.astype(np.float64)[:, None]
    mixed = start + share * (np.array(DEFECT_RGB, np.float64) - start)
    colors: U8 = np.rint(mixed).astype(np.uint8)
    return colors
