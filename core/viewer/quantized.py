"""The parts of the page's surface as GLB of quantised values (glTF 2.0 with `KHR_mesh_quantization`).

Plain numbers of one or two bytes: no decoder is needed, and every viewer that knows the extension reads it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.surface.cut import cut
from core.surface.glb import (
    ARRAY_BUFFER,
    BYTE,
    INDEX_BUFFER,
    UBYTE,
    USHORT,
    GlbBuffer,
    linear_rgba,
    unit_rows,
    vertex_normals,
    write_document,
)
from core.surface.ply import Mesh

_EXTENSION = "KHR_mesh_quantization"
_STEPS = 65535
_MAX_VERTICES = 65535
"""Vertices that two bytes can number: the largest number is kept for restarts (glTF 2.0, 3.7.2.1)."""
_HALF_TURN_ABOUT_X = [1.0, 0.0, 0.0, 0.0]
"""As a quaternion; `core.surface.glb.GLTF_FROM_WORLD` as a rotation."""
_GREY = (180, 180, 180)

F64 = NDArray[np.float64]


def write_quantized_glb(path: Path, parts: Mapping[str, Mesh], unit: str = "model") -> None:
    """Write parts of one surface as nodes with their names.

    Positions are multiples of a 65535th of the longest side of the box around all parts, so that rims that were one
    stay one. The nodes undo that: below their common parent `world` coordinates are those of the model, and the parent
    turns them into glTF's y-up ones. Attributes: POSITION, NORMAL, COLOR_0 (linear), `_SUPPORT` in [0, 1] and `_BLADE`
    (0 = none). A node has several primitives where two bytes could not number its vertices.

    Args:
        path: file to write.
        parts: by name; those without faces are left out.
        unit: of the coordinates.
    """
    filled = {name: mesh for name, mesh in parts.items() if len(mesh.faces)}
    vertices = np.concatenate([mesh.vertices for mesh in filled.values()]) if filled else np.zeros((1, 3))
    low, size = vertices.min(axis=0), float(np.ptp(vertices, axis=0).max()) or 1.0
    buffer = GlbBuffer()
    meshes = [{"name": name, "primitives": _primitives(buffer, mesh, low, size)} for name, mesh in filled.items()]
    undo = {"translation": low.tolist(), "scale": [size, size, size]}
    nodes: list[dict[str, object]] = [{"name": name, "mesh": i, **undo} for i, name in enumerate(filled)]
    world: dict[str, object] = {"name": "world", "rotation": _HALF_TURN_ABOUT_X}
    nodes.append({**world, "children": list(range(len(filled)))} if filled else world)
    document: dict[str, object] = {
        "asset": {"version": "2.0", "generator": "BladeAtlas", "extras": {"unit": unit}},
        "extensionsUsed": [_EXTENSION],
        "extensionsRequired": [_EXTENSION],
        "scene": 0,
        "scenes": [{"nodes": [len(filled)]}],
        "nodes": nodes,
    }
    if filled:
        rough = {"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.85}}
        document |= {"meshes": meshes, "materials": [rough], "accessors": buffer.accessors}
        document |= {"bufferViews": buffer.views, "buffers": [{"byteLength": len(buffer.data)}]}
    write_document(path, document, bytes(buffer.data))


def _primitives(buffer: GlbBuffer, mesh: Mesh, low: F64, size: float) -> list[dict[str, object]]:
    # Of the whole: at a cut both sides have the same normals, and none is seen.
    whole = replace(mesh, normals=vertex_normals(mesh)) if mesh.normals is None else mesh
    return [_primitive(buffer, piece, low, size) for piece in _pieces(whole)]


def _pieces(mesh: Mesh) -> list[Mesh]:
    """Halves of halves across the longest side, until two bytes can number the vertices of each."""
    if len(mesh.vertices) <= _MAX_VERTICES:
        return [mesh]
    axis = int(np.ptp(mesh.vertices, axis=0).argmax())
    order = np.argsort(mesh.vertices[mesh.faces[:, 0], axis], kind="stable")
    # In the order that they had: neighbours in the file are neighbours in space, which compresses better.
    halves = [np.sort(half) for half in np.array_split(order, 2) if len(half)]
    return [piece for half in halves for piece in _pieces(cut(mesh, half))]


def _primitive(buffer: GlbBuffer, mesh: Mesh, low: F64, size: float) -> dict[str, object]:
    steps = np.rint((mesh.vertices - low) / size * _STEPS).astype("<u2")
    normals = unit_rows(vertex_normals(mesh) if mesh.normals is None else mesh.normals)
    n = len(mesh.vertices)
    colors = np.full((n, 3), _GREY, np.uint8) if mesh.colors is None else mesh.colors
    support = np.clip(mesh.extra.get("support", np.ones(n)), 0.0, 1.0)
    blade = np.clip(mesh.extra.get("blade", np.zeros(n)), 0, 255).astype(np.uint8)
    attributes = {
        "POSITION": buffer.add(steps, USHORT, "VEC3", ARRAY_BUFFER, normalized=True, bounds=True),
        "NORMAL": buffer.add(np.rint(normals * 127).astype(np.int8), BYTE, "VEC3", ARRAY_BUFFER, normalized=True),
        "COLOR_0": buffer.add(linear_rgba(colors), USHORT, "VEC4", ARRAY_BUFFER, normalized=True),
        "_SUPPORT": buffer.add(np.rint(support * 255).astype(np.uint8), UBYTE, "SCALAR", ARRAY_BUFFER, normalized=True),
        "_BLADE": buffer.add(blade, UBYTE, "SCALAR", ARRAY_BUFFER)
        if blade.any()
        else buffer.add_zeros(n, UBYTE, "SCALAR"),
    }
    indices = buffer.add(mesh.faces.astype("<u2").ravel(), USHORT, "SCALAR", INDEX_BUFFER)
    return {"attributes": attributes, "indices": indices, "material": 0, "mode": 4}
