"""Meshes and clouds as binary PLY, with any further vertex properties and comments."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from plyfile import PlyData, PlyElement, PlyListProperty, PlyParseError

from core.errors import StageFailed

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]
Values = NDArray[Any]
"""Numbers of any type: a vertex property keeps that of its file."""

_KNOWN = ("x", "y", "z", "nx", "ny", "nz", "red", "green", "blue")


@dataclass(frozen=True)
class Mesh:
    """A triangle mesh, or a cloud when it has no faces."""

    vertices: F64
    """(n, 3) positions in scene units."""
    faces: I32 = field(default_factory=lambda: np.zeros((0, 3), np.int32))
    """(m, 3) vertex indices, counter-clockwise seen from outside."""
    colors: U8 | None = None
    """(n, 3) RGB."""
    normals: F64 | None = None
    """(n, 3) unit normals."""
    extra: Mapping[str, Values] = field(default_factory=dict)
    """Further (n,) vertex properties by name, e.g. ``support``, ``defect_id``."""
    comments: tuple[str, ...] = ()

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal (d_mesh of the thesis), scene units; 0 for no vertices."""
        if not len(self.vertices):
            return 0.0
        return float(np.linalg.norm(self.vertices.max(axis=0) - self.vertices.min(axis=0)))


def read_mesh(path: Path) -> Mesh:
    """Read a PLY file of triangles or points.

    Raises:
        StageFailed: the file is not a PLY with x, y, z, or has a face that is not a triangle.
    """
    try:
        data = _read(path)
    except (PlyParseError, OSError, ValueError) as error:
        raise StageFailed(f"{path.name} is not a readable PLY file: {error}", where=path.name) from None
    names = {element.name for element in data.elements}
    if "vertex" not in names or not {"x", "y", "z"} <= set(data["vertex"].data.dtype.names):
        raise StageFailed(f"{path.name} has no vertex positions", where=path.name)
    vertex = data["vertex"].data
    have = vertex.dtype.names
    return Mesh(
        vertices=_columns(vertex, ("x", "y", "z"), np.float64),
        faces=_faces(data["face"], path) if "face" in names else np.zeros((0, 3), np.int32),
        colors=_columns(vertex, ("red", "green", "blue"), np.uint8) if "red" in have else None,
        normals=_columns(vertex, ("nx", "ny", "nz"), np.float64) if "nx" in have else None,
        extra={name: np.ascontiguousarray(vertex[name]) for name in have if name not in _KNOWN},
        comments=tuple(data.comments),
    )


def write_mesh(path: Path, mesh: Mesh, comments: Sequence[str] | None = None) -> None:
    """Write a mesh as binary little-endian PLY: float positions, the mesh's comments unless others are given."""
    vertices = _vertex_table(mesh)
    described = np.empty(len(mesh.faces), dtype=[("vertex_indices", "<i4", (3,))])
    elements = [
        PlyElement.describe(vertices, "vertex"),
        PlyElement.describe(described, "face", len_types={"vertex_indices": "u1"}),
    ]
    # plyfile writes lists one by one, which takes seconds for millions of faces: it gives only the header here.
    header = PlyData(elements, text=False, byte_order="<", comments=list(_comments(mesh, comments))).header
    packed = np.empty(len(mesh.faces), dtype=[("count", "u1"), ("vertex_indices", "<i4", (3,))])
    packed["count"], packed["vertex_indices"] = 3, mesh.faces
    with path.open("wb") as stream:
        stream.write(header.encode("ascii") + b"\n")
        stream.write(vertices.tobytes())
        stream.write(packed.tobytes())


def write_cloud(path: Path, cloud: Mesh, comments: Sequence[str] | None = None) -> None:
    """Write the vertices alone, as binary little-endian PLY."""
    element = PlyElement.describe(_vertex_table(cloud), "vertex")
    with path.open("wb") as stream:
        PlyData([element], text=False, byte_order="<", comments=list(_comments(cloud, comments))).write(stream)


def _comments(mesh: Mesh, comments: Sequence[str] | None) -> Sequence[str]:
    return mesh.comments if comments is None else comments


def _read(path: Path) -> PlyData:
    """Triangles are read at once when every face is one, else face by face (thirty times slower)."""
    for name in ("vertex_indices", "vertex_index"):
        try:
            return PlyData.read(str(path), mmap="c", known_list_len={"face": {name: 3}})
        except PlyParseError:
            continue
    return PlyData.read(str(path), mmap=False)


def _columns(table: Values, names: tuple[str, ...], dtype: type[np.generic]) -> Values:
    return np.stack([np.asarray(table[name], dtype=dtype) for name in names], axis=1)


def _faces(element: PlyElement, path: Path) -> I32:
    names = [prop.name for prop in element.properties if isinstance(prop, PlyListProperty)]
    if not names or not len(element.data):
        return np.zeros((0, 3), np.int32)
    lists = element.data[names[0]]
    if lists.dtype == object and any(len(row) != 3 for row in lists):
        raise StageFailed(f"{path.name} has a face that is not a triangle", where=path.name)
    return np.asarray(np.stack(lists) if lists.dtype == object else lists, dtype=np.int32).reshape(-1, 3)


def _vertex_table(mesh: Mesh) -> Values:
    columns: list[tuple[str, str, Values]] = [
        (name, "<f4", mesh.vertices[:, i]) for i, name in enumerate(("x", "y", "z"))
    ]
    if mesh.normals is not None:
        columns += [(name, "<f4", mesh.normals[:, i]) for i, name in enumerate(("nx", "ny", "nz"))]
    if mesh.colors is not None:
        columns += [(name, "u1", mesh.colors[:, i]) for i, name in enumerate(("red", "green", "blue"))]
    for name, values in mesh.extra.items():
        columns.append((name, "<f4" if values.dtype.kind == "f" else "<i4", values))
    table = np.empty(len(mesh.vertices), dtype=[(name, kind) for name, kind, _ in columns])
    for name, _, values in columns:
        table[name] = values
    return table
