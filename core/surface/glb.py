"""What every binary glTF 2.0 that is written here shares: its buffer, container, colours and normals."""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.surface.ply import Mesh, Values

BYTE, UBYTE, USHORT, UINT, FLOAT = 5120, 5121, 5123, 5125, 5126
"""Types of components of an accessor (glTF 2.0, 3.6.2.2)."""
ARRAY_BUFFER, INDEX_BUFFER = 34962, 34963
"""Targets of a view of the buffer."""
_JSON_CHUNK, _BINARY_CHUNK = 0x4E4F534A, 0x004E4942


def vertex_normals(mesh: Mesh) -> NDArray[np.float64]:
    """(n, 3) area-weighted unit normals of the vertices; (0, 0, 1) where no face gives one."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    face = np.cross(b - a, c - a)
    total = np.zeros_like(mesh.vertices, dtype=np.float64)
    for axis in range(3):
        for corner in range(3):
            total[:, axis] += np.bincount(mesh.faces[:, corner], face[:, axis], minlength=len(total))
    return unit_rows(total)


def unit_rows(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """(n, 3) the vectors at unit length; (0, 0, 1) for those without one."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > 0, vectors / np.where(length > 0, length, 1.0), (0.0, 0.0, 1.0))


def linear_rgba(colors: NDArray[np.uint8]) -> NDArray[np.uint16]:
    """(n, 4) linear colours in 16 bits from sRGB bytes (IEC 61966-2-1), opaque."""
    level = np.arange(256) / 255.0
    linear = np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)
    table = np.rint(linear * 65535).astype("<u2")
    rgba = np.full((len(colors), 4), 65535, dtype="<u2")
    rgba[:, :3] = table[colors]
    return rgba


class GlbBuffer:
    """The binary chunk of a GLB and the accessors into it."""

    def __init__(self) -> None:
        self.data = bytearray()
        self.views: list[dict[str, object]] = []
        self.accessors: list[dict[str, object]] = []

    def add(
        self,
        values: Values,
        component: int,
        kind: str,
        target: int,
        *,
        normalized: bool = False,
        bounds: bool = False,
    ) -> int:
        """Append an array and give the index of its accessor."""
        rows = np.ascontiguousarray(values)
        view: dict[str, object] = {"buffer": 0, "byteOffset": len(self.data)}
        size = rows.nbytes // len(rows) if len(rows) else 0
        if target == ARRAY_BUFFER and size % 4:  # the elements of an attribute begin at multiples of four bytes
            size_before, size = size, size + -size % 4
            padded = np.zeros((len(rows), size), np.uint8)
            padded[:, :size_before] = rows.view(np.uint8).reshape(len(rows), size_before)
            rows, view["byteStride"] = padded, size
        raw = rows.tobytes()
        self.views.append({**view, "byteLength": len(raw), "target": target})
        self.data += raw + b"\0" * (-len(raw) % 4)
        accessor: dict[str, object] = {
            "bufferView": len(self.views) - 1,
            "componentType": component,
            "count": len(values),
            "type": kind,
        }
        if normalized:
            accessor["normalized"] = True
        if bounds and len(values):
            accessor["min"] = [float(value) for value in values.min(axis=0)]
            accessor["max"] = [float(value) for value in values.max(axis=0)]
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def add_zeros(self, count: int, component: int, kind: str) -> int:
        """An accessor of so many zeros, which take no byte, and its index."""
        self.accessors.append({"componentType": component, "count": count, "type": kind})
        return len(self.accessors) - 1


def write_document(path: Path, document: dict[str, object], binary: bytes) -> None:
    """Write the container of a glTF document and its one buffer."""
    text = json.dumps(document, separators=(",", ":"), allow_nan=False).encode()
    text += b" " * (-len(text) % 4)
    total = 12 + 8 + len(text) + 8 + len(binary)
    with path.open("wb") as stream:
        stream.write(struct.pack("<4sII", b"glTF", 2, total))
        stream.write(struct.pack("<II", len(text), _JSON_CHUNK) + text)
        stream.write(struct.pack("<II", len(binary), _BINARY_CHUNK) + binary)
