"""Points that stand for a surface: uniform over its area, thinned to a number, with normals, and free of roughness."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import open3d as o3d
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.surface.glb import unit_rows
from core.surface.ply import Mesh

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MIN_SUPPORT = 0.7
"""Of a face's corners: below it the surface is a guess between the points of the cloud."""
DRAWN = 60_000
FIT_POINTS = 10_000
"""That a row is fitted to: what is smaller than their spacing says nothing about it."""
AVERAGED = 3.0 / 7.0
"""Variance along the surface that averaging a vertex with itself and six neighbours adds, in squared edges."""
MOST_AVERAGED = 200
NEIGHBOUR = 4
"""The spacing is the median distance to this neighbour."""
THINNING_STEPS = 24
"""Bisections of the size of a cell."""


@dataclass(frozen=True)
class SurfaceSample:
    """Points of a surface."""

    points: F64
    """(n, 3) scene units."""
    normals: F64
    """(n, 3) unit, towards the cameras."""

    @cached_property
    def tree(self) -> cKDTree:
        """For the nearest of the points."""
        return cKDTree(self.points)

    @cached_property
    def spacing(self) -> float:
        """Median distance of a point to its fourth neighbour, scene units; 0 for five points or fewer."""
        if len(self.points) <= NEIGHBOUR + 1:
            return 0.0
        away = np.asarray(self.tree.query(self.points, k=NEIGHBOUR + 1)[0])
        return float(np.median(away[:, NEIGHBOUR]))

    def __len__(self) -> int:
        return len(self.points)

    def of(self, chosen: NDArray[np.bool_] | I64) -> SurfaceSample:
        """Those of the points that a mask or rows name."""
        return SurfaceSample(self.points[chosen], self.normals[chosen])


def sample_surface(mesh: Mesh, seed: int, drawn: int = DRAWN, normals_of: Mesh | None = None) -> SurfaceSample:
    """Points drawn uniformly over the area of the supported faces of a mesh; none where it has none.

    Args:
        mesh: faces counter-clockwise seen from the cameras; without a property `support` all of it counts.
        seed: of the draw.
        drawn: number of points.
        normals_of: the same mesh smoothed, from whose faces the normals are; None = from its own.
    """
    faces = supported_faces(mesh)
    corners = mesh.vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    doubled = np.linalg.norm(cross, axis=1)
    if not len(faces) or doubled.sum() <= 0.0:
        return SurfaceSample(np.zeros((0, 3)), np.zeros((0, 3)))
    rng = np.random.default_rng(seed)
    chosen = rng.choice(len(faces), size=drawn, p=doubled / doubled.sum())
    u, v = rng.random((2, drawn, 1))
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    a, b, c = (corners[chosen, k] for k in range(3))
    points = a + u * (b - a) + v * (c - a)
    if normals_of is None:
        return SurfaceSample(points, cross[chosen] / doubled[chosen, None])
    a, b, c = (normals_of.vertices[faces[chosen, k]] for k in range(3))
    return SurfaceSample(points, unit_rows(np.cross(b - a, c - a)))


def steadied(mesh: Mesh, seed: int) -> Mesh:
    """The mesh smoothed by the spacing of `FIT_POINTS` points of it.

    The faces of a rough reconstruction look anywhere: on a scene of 352x352, whose blades stand right, 22 of 100
    places that a turn by the pitch laid beside each other faced alike.
    """
    drawn = sample_surface(mesh, seed)
    return smoothed(mesh, thinned(drawn, FIT_POINTS).spacing) if len(drawn) else mesh


def smoothed(mesh: Mesh, length: float) -> Mesh:
    """The mesh without what is shorter than a length: every vertex averaged with its neighbours, again and again.

    Borders and sharp edges are drawn in by up to that length.

    Args:
        mesh: to smooth; what it carries beside its vertices stays.
        length: standard deviation of the averaging along the surface, scene units.
    """
    if not len(mesh.faces):
        return mesh
    edges = np.linalg.norm(mesh.vertices[mesh.faces[:, 0]] - mesh.vertices[mesh.faces[:, 1]], axis=1)
    edge = float(np.median(edges))
    times = round(min(float(MOST_AVERAGED), (length / max(edge, 1e-300)) ** 2 / AVERAGED))
    if not times:
        return mesh
    shape = o3d.geometry.TriangleMesh(o3d.utility.Vector3dVector(mesh.vertices), o3d.utility.Vector3iVector(mesh.faces))
    return replace(mesh, vertices=np.array(shape.filter_smooth_simple(times).vertices))


def supported_faces(mesh: Mesh) -> NDArray[np.int32]:
    """(m, 3) faces whose three corners all have enough support."""
    support = mesh.extra.get("support")
    if support is None:
        return mesh.faces
    kept: NDArray[np.int32] = mesh.faces[(support[mesh.faces] >= MIN_SUPPORT).all(axis=1)]
    return kept


def thinned(sample: SurfaceSample, target: int) -> SurfaceSample:
    """About `target` of the points, evenly spread: one per cell of a grid and octant of the normal.

    The octant keeps the two sides of a thin blade, which share cells, apart.
    """
    if len(sample) <= target:
        return sample
    origin = sample.points.min(axis=0)
    octant = (sample.normals > 0) @ np.array((1, 2, 4))
    extent = sample.points.max(axis=0) - origin
    low, high = 0.0, float(extent.max())
    rows = np.arange(len(sample))
    for _ in range(THINNING_STEPS):
        size = (low + high) / 2
        cells = np.floor((sample.points - origin) / size).astype(np.int64)
        _, across, up = (np.floor(extent / size) + 1).astype(np.int64)
        # One number for each cell and octant: at the sizes tried here it fits into 63 bits.
        _, rows = np.unique(((cells[:, 0] * across + cells[:, 1]) * up + cells[:, 2]) * 8 + octant, return_index=True)
        if len(rows) > target:
            low = size
        else:
            high = size
        if abs(len(rows) - target) <= 0.02 * target:
            break
    return sample.of(np.sort(rows))
