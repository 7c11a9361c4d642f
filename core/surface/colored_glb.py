"""Coloured surfaces as binary glTF 2.0, every blade a node, with support and defect numbers as vertex attributes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.scene.size import Scale
from core.surface.cut import by_blade
from core.surface.glb import (
    ARRAY_BUFFER,
    FLOAT,
    INDEX_BUFFER,
    UINT,
    USHORT,
    GlbBuffer,
    linear_rgba,
    unit_rows,
    vertex_normals,
    write_document,
)
from core.surface.ply import Mesh

GLTF_FROM_WORLD = np.diag([1.0, -1.0, -1.0])
"""glTF is y-up and looks along -z; COLMAP's camera frames, and so its worlds, are y-down and look along +z."""
MM_PER_M = 1000.0
_WHOLE = "surface with defects"
"""Name of the node of what lies on no blade, or of all where no blade is known."""


def write_glb(path: Path, mesh: Mesh, scale: Scale | None = None) -> None:
    """Write a mesh as GLB: y-up positions, normals, COLOR_0, `_SUPPORT` and `_DEFECT_ID` where the mesh has them.

    Where blades are known each is a node ``blade_N``. Vertex colours are sRGB in the mesh and linear in glTF; they are
    stored with 16 bits so that dark tones keep their steps. Numbers of defects are floats, because glTF knows no 32-bit
    integer attribute.

    Args:
        path: file to write.
        mesh: in units of the model.
        scale: of the model: with it lengths are metres, as glTF wants them; None leaves them.
    """
    buffer = GlbBuffer()
    factor = 1.0 if scale is None else scale.value / MM_PER_M
    parts = by_blade(mesh, _WHOLE)
    meshes: list[dict[str, object]] = [{"primitives": [_primitive(buffer, part, factor)]} for part in parts.values()]
    if len(parts) > 1:  # some viewers show the names of meshes, not those of nodes
        meshes = [{"name": name, **mesh} for name, mesh in zip(parts, meshes, strict=True)]
    document: dict[str, object] = {
        "asset": {
            "version": "2.0",
            "generator": "BladeAtlas",
            "extras": {"unit": "model" if scale is None else "m", "gltf_from_world": GLTF_FROM_WORLD.tolist()},
        },
        "scene": 0,
        "scenes": [{"nodes": list(range(len(parts)))}],
        "nodes": [{"mesh": number, "name": name} for number, name in enumerate(parts)],
        "meshes": meshes,
        "materials": [
            {"doubleSided": True, "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.85}},
        ],
        "accessors": buffer.accessors,
        "bufferViews": buffer.views,
        "buffers": [{"byteLength": len(buffer.data)}],
    }
    write_document(path, document, bytes(buffer.data))


def _primitive(buffer: GlbBuffer, mesh: Mesh, factor: float) -> dict[str, object]:
    attributes: dict[str, int] = {}
    positions = (factor * mesh.vertices @ GLTF_FROM_WORLD.T).astype("<f4")
    attributes["POSITION"] = buffer.add(positions, FLOAT, "VEC3", ARRAY_BUFFER, bounds=True)
    normals = vertex_normals(mesh) if mesh.normals is None else mesh.normals
    attributes["NORMAL"] = buffer.add(
        (unit_rows(normals) @ GLTF_FROM_WORLD.T).astype("<f4"), FLOAT, "VEC3", ARRAY_BUFFER
    )
    if mesh.colors is not None:
        attributes["COLOR_0"] = buffer.add(linear_rgba(mesh.colors), USHORT, "VEC4", ARRAY_BUFFER, normalized=True)
    for name in ("support", "defect_id"):
        if name in mesh.extra:
            values = mesh.extra[name].astype("<f4")
            attributes[f"_{name.upper()}"] = buffer.add(values, FLOAT, "SCALAR", ARRAY_BUFFER)
    indices = buffer.add(mesh.faces.astype("<u4").ravel(), UINT, "SCALAR", INDEX_BUFFER)
    return {"attributes": attributes, "indices": indices, "material": 0, "mode": 4}
