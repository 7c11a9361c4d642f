"""The part of a surface around a place: cut out, divided finely enough to be measured on, and walked on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from core.surface.glb import vertex_normals
from core.surface.ply import Mesh

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Flags = NDArray[np.bool_]

CELLS = 24
"""Edges of the divided surface over the reach of a patch, at least."""
MAX_FACES = 60_000
"""A patch is not divided further beyond this."""
RINGS = 3
"""Vertices up to so many edges apart are joined by a straight step: steps along edges alone are up to 15 % too long
(the metric of a lattice), over three rings the surplus of a plane is 1 %."""


@dataclass(frozen=True)
class SurfacePatch:
    """A connected piece of a triangle mesh, divided to edges of about equal length."""

    vertices: F64
    """(n, 3)"""
    faces: I64
    """(m, 3) rows of `vertices`."""
    place: F64
    """(3,) that it was cut around."""
    reach: float
    """Its vertices lie within this distance of the place, scene units."""

    @cached_property
    def normals(self) -> F64:
        """(n, 3) unit normals by the area of the faces around."""
        return vertex_normals(Mesh(self.vertices, self.faces.astype(np.int32)))

    @cached_property
    def areas(self) -> F64:
        """(m,) of the faces."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        area: F64 = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        return area

    @cached_property
    def edges(self) -> I64:
        """(e, 2) pairs of vertices, the lower first, each once."""
        return _edges(self.faces)

    @cached_property
    def steps(self) -> csr_matrix:
        """(n, n) lengths of the steps between vertices at most `RINGS` edges apart."""
        n = len(self.vertices)
        a, b = self.edges.T
        near = csr_matrix((np.ones(len(a), np.int32), (a, b)), shape=(n, n))
        near = near + near.T
        reached = near
        for _ in range(RINGS - 1):
            reached = reached + reached @ near
        first, second = reached.nonzero()
        apart = first != second
        first, second = first[apart], second[apart]
        length = np.linalg.norm(self.vertices[first] - self.vertices[second], axis=1)
        return csr_matrix((np.maximum(length, 1e-300), (first, second)), shape=(n, n))

    def distances(self, sources: I64) -> F64:
        """(k, n) lengths of the shortest ways along the surface from k vertices; infinite where none leads."""
        found: F64 = np.atleast_2d(dijkstra(self.steps, directed=False, indices=sources))
        return found


def cut_patch(mesh: Mesh, place: F64, reach: float) -> SurfacePatch | None:
    """The piece of a mesh that hangs together around a place.

    Args:
        mesh: the surface.
        place: (3,) on or near it.
        reach: farthest distance from the place, scene units.

    Returns:
        None where no face lies within reach.
    """
    near = np.linalg.norm(mesh.vertices - place, axis=1) <= reach
    rows = np.flatnonzero(near[mesh.faces].all(axis=1))
    if not len(rows):  # faces may be larger than the piece
        middle = mesh.vertices[mesh.faces].mean(axis=1)
        rows = np.flatnonzero(np.linalg.norm(middle - place, axis=1) <= reach)
    if not len(rows):
        return None
    faces = mesh.faces[rows].astype(np.int64)
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = mesh.vertices[used].astype(np.float64), faces.reshape(-1, 3)
    faces = _around(vertices, faces, place)
    used, faces = np.unique(faces, return_inverse=True)
    vertices, faces = _divided(vertices[used], faces.reshape(-1, 3), reach / CELLS)
    return SurfacePatch(vertices, faces, place, reach)


def _around(vertices: F64, faces: I64, place: F64) -> I64:
    """The faces that hang together with the vertex nearest to the place."""
    n = len(vertices)
    a, b = _edges(faces).T
    _, label = connected_components(coo_matrix((np.ones(len(a)), (a, b)), shape=(n, n)), directed=False)
    own = label[int(np.linalg.norm(vertices - place, axis=1).argmin())]
    return np.asarray(faces[label[faces[:, 0]] == own])


def _divided(vertices: F64, faces: I64, edge: float) -> tuple[F64, I64]:
    """Every face in four, until the median edge is short enough."""
    while 4 * len(faces) <= MAX_FACES:
        pairs = _edges(faces)
        length = np.linalg.norm(vertices[pairs[:, 0]] - vertices[pairs[:, 1]], axis=1)
        if float(np.median(length)) <= edge:
            break
        n = len(vertices)
        code = pairs[:, 0] * n + pairs[:, 1]  # sorted, as `_edges` gives them
        a, b, c = faces.T
        ab, bc, ca = (
            n + np.searchsorted(code, np.minimum(p, q) * n + np.maximum(p, q)) for p, q in ((a, b), (b, c), (c, a))
        )
        vertices = np.concatenate([vertices, (vertices[pairs[:, 0]] + vertices[pairs[:, 1]]) / 2])
        quarters = ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))
        faces = np.concatenate([np.stack(corners, axis=1) for corners in quarters])
    return vertices, faces


def _edges(faces: I64) -> I64:
    pairs = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return np.asarray(np.unique(pairs, axis=0), np.int64)
