"""What of a Poisson surface the cloud supports."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from core.surface.ply import Mesh

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

_SPACING_SAMPLE = 20_000


def point_spacing(points: F64) -> float:
    """Median distance of a point to its nearest neighbour; 0 for fewer than two points."""
    if len(points) < 2:
        return 0.0
    distance: F64 = np.asarray(cKDTree(points).query(points, k=2)[0])
    return float(np.median(distance[:, 1]))


def vertex_spacing(mesh: Mesh) -> float:
    """Typical distance of a vertex to the next, told by some of them.

    The vertices of a Poisson mesh lie about as far apart as the points that support it.
    """
    step = max(1, len(mesh.vertices) // _SPACING_SAMPLE)
    return float(point_spacing(mesh.vertices[::step]) / np.sqrt(step))


def cloud_distance(vertices: F64, points: F64) -> F64:
    """(n,) distance of each vertex to the nearest point."""
    distance, _ = cKDTree(points).query(vertices)
    return np.asarray(distance, dtype=np.float64)


def support(distance: F64, spacing: float, limit_spacings: float) -> NDArray[np.float32]:
    """(n,) support in [0, 1] by distance to the cloud.

    1 within one median point spacing, 0.5 at `limit_spacings` (where the surface is cut), 0 from twice that on,
    linear in between. So "supported" is ``support >= 0.5`` whatever the spacing of the cloud.
    """
    if spacing <= 0:
        return np.zeros(len(distance), np.float32)
    at = [min(1.0, 0.5 * limit_spacings), limit_spacings, 2.0 * limit_spacings]
    return np.interp(distance / spacing, at, [1.0, 0.5, 0.0]).astype(np.float32)


def keep_vertices(mesh: Mesh, keep: Flags) -> Mesh:
    """The mesh of the faces whose three vertices are kept, without the vertices that no face uses."""
    faces = mesh.faces[keep[mesh.faces].all(axis=1)] if len(mesh.faces) else mesh.faces
    used = np.zeros(len(mesh.vertices), dtype=bool)
    used[faces.ravel()] = True
    number = np.cumsum(used) - 1
    return replace(
        mesh,
        vertices=mesh.vertices[used],
        faces=number[faces].astype(np.int32),
        colors=None if mesh.colors is None else mesh.colors[used],
        normals=None if mesh.normals is None else mesh.normals[used],
        extra={name: values[used] for name, values in mesh.extra.items()},
    )


def largest_component(mesh: Mesh) -> Flags:
    """(n,) vertices of the connected part with the most faces (the first of equals)."""
    n = len(mesh.vertices)
    if not len(mesh.faces):
        return np.zeros(n, dtype=bool)
    rows = mesh.faces[:, [0, 1]].ravel()
    columns = mesh.faces[:, [1, 2]].ravel()
    graph = coo_matrix((np.ones(len(rows), np.int8), (rows, columns)), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    count = np.bincount(label[mesh.faces[:, 0]])
    return np.asarray(label == int(np.argmax(count)))
