"""The surface of the page: every defect a part of its own at full resolution, the rest with fewer triangles."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import open3d as o3d
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.surface.cut import by_blade, cut, rows_of
from core.surface.glb import vertex_normals
from core.surface.ply import Mesh

MAX_FACES = 300_000
"""Triangles of all parts together, at most. With 6 bytes of indices, and 24 to 28 of attributes for every second
triangle, such a file has 5.4 to 6.0 MB; the page is made for 7 MB."""
PATCH_SHARE = 0.5
"""Share of them that the defects may have together; larger ones lose triangles as well."""
_BOUNDARY = 100.0
"""Weight of the rims in the decimation (Open3D's default is 1): the cut around a defect has to stay where it is."""

Flags = NDArray[np.bool_]


def part_name(defect: int) -> str:
    """Name of the node of a defect."""
    return f"defect_{defect}"


SURFACE = "surface"
"""Name of the node of everything else; what of it lies on blade N is the node ``blade_N``."""


def viewer_parts(mesh: Mesh, defects: Mapping[int, Sequence[int]], max_faces: int = MAX_FACES) -> dict[str, Mesh]:
    """Cut the defects out of a surface and thin out the rest.

    Args:
        mesh: the surface, its faces turned towards the cameras.
        defects: faces of every defect by its number; a face of two belongs to the smaller number.
        max_faces: triangles of all parts together, at most.

    Returns:
        Parts by the names of their nodes, `SURFACE` and the blades first; each has normals, and the colours and
        properties of the mesh. A defect without faces of its own has no part.
    """
    whole = replace(mesh, normals=vertex_normals(mesh))
    owner = np.full(len(mesh.faces), -1, np.int64)
    for number in sorted(defects, reverse=True):
        owner[np.asarray(defects[number], np.int64)] = number
    patches = {number: cut(whole, owner == number) for number in sorted(defects) if (owner == number).any()}
    patches = _within(patches, int(PATCH_SHARE * max_faces))
    left = max_faces - sum(len(patch.faces) for patch in patches.values())
    rest = _decimated(cut(whole, owner < 0), left)
    return {**by_blade(rest, SURFACE), **{part_name(number): patch for number, patch in patches.items()}}


def _within(patches: Mapping[int, Mesh], budget: int) -> dict[int, Mesh]:
    """The defects with at most so many faces together: none loses any while they fit."""
    total = sum(len(patch.faces) for patch in patches.values())
    if total <= budget:
        return dict(patches)
    return {number: _decimated(patch, len(patch.faces) * budget // total) for number, patch in patches.items()}


def _decimated(mesh: Mesh, max_faces: int) -> Mesh:
    """At most so many faces, by collapsing edges in the order of their quadric error (Garland and Heckbert 1997).

    A new vertex has the colour and the properties of the old one that is nearest to it.
    """
    if len(mesh.faces) <= max_faces:
        return mesh
    utility = o3d.utility
    corners, triangles = utility.Vector3dVector(mesh.vertices), utility.Vector3iVector(mesh.faces)
    full = o3d.geometry.TriangleMesh(corners, triangles)
    thin = full.simplify_quadric_decimation(max_faces, boundary_weight=_BOUNDARY)
    vertices, faces = np.asarray(thin.vertices), np.asarray(thin.triangles, np.int32)
    _, nearest = cKDTree(mesh.vertices, balanced_tree=False, compact_nodes=False).query(vertices)
    likened = rows_of(mesh, np.asarray(nearest, np.int64), faces)
    moved = replace(likened, vertices=vertices)
    return replace(moved, normals=vertex_normals(moved))
