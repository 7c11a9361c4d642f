"""Parts of a mesh, cut out along its edges, and its division into blades."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from core.surface.glb import vertex_normals
from core.surface.ply import Mesh

BLADE = "blade"
"""Vertex property: number of the blade that a vertex lies on, 0 = none."""


def cut(mesh: Mesh, faces: NDArray[np.bool_] | NDArray[np.intp]) -> Mesh:
    """Some faces of a mesh, by flags or in the order of their numbers, with the vertices that they use."""
    chosen = mesh.faces[faces]
    used, flat = np.unique(chosen, return_inverse=True)
    return rows_of(mesh, used, flat.reshape(-1, 3).astype(np.int32))


def rows_of(mesh: Mesh, rows: NDArray[np.signedinteger], faces: NDArray[np.int32]) -> Mesh:
    """Some vertices of a mesh with all that is known of them, and other faces over these."""
    return Mesh(
        mesh.vertices[rows],
        faces,
        None if mesh.colors is None else mesh.colors[rows],
        None if mesh.normals is None else mesh.normals[rows],
        {name: values[rows] for name, values in mesh.extra.items()},
    )


def by_blade(mesh: Mesh, other: str) -> Mapping[str, Mesh]:
    """A mesh in parts: `other`, what lies on no blade, then ``blade_N`` by number; whole where no blade is known.

    A face belongs to the blade of most of its corners. Normals are those of the whole, so that no cut is seen; parts
    without faces are left out.
    """
    blade = mesh.extra.get(BLADE)
    if blade is None or not blade.any():
        return {other: mesh}
    whole = mesh if mesh.normals is not None else replace(mesh, normals=vertex_normals(mesh))
    of_face = np.sort(blade[mesh.faces], axis=1)[:, 1]
    numbers = [int(number) for number in np.unique(of_face)]
    return {f"blade_{number}" if number else other: cut(whole, of_face == number) for number in numbers}
