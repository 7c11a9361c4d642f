"""Whether two jobs with the same parameters came to the same result, by what their clients downloaded."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from plyfile import PlyData
from scipy.spatial import cKDTree

_TIMING = ("seconds", "peak_rss_bytes")
_PLACE = ("x", "y", "z", "centroid", "extent", "radius", "confidence", "persistence", "mesh_faces", "support_points")
"""Fields that follow the mesh, which is equal only within the tolerance."""
_TOLERANCE = 1e-4
"""Share of the mesh's diagonal."""
_TABLES = ("mapping/detections.json", "mapping/timeline.json", "mapping/defects.json")
_MESHES = ("dense/mesh_poisson.ply", "mapping/mesh_defects.ply")


def differences(expected: Path, found: Path) -> list[str]:
    """What is not as in the undisturbed run; empty when all is well."""
    return [*_missing(expected, found), *_sparse(expected, found), *_tables(expected, found), *_meshes(expected, found)]


def _missing(expected: Path, found: Path) -> Iterator[str]:
    names = [
        {path.relative_to(root).as_posix() for path in root.rglob("*") if path.is_file()} for root in (expected, found)
    ]
    for name in sorted(names[0] ^ names[1]):
        yield f"{name} is {'missing' if name in names[0] else 'new'}"


def _sparse(expected: Path, found: Path) -> Iterator[str]:
    """Sparse models byte for byte; cases but for their times."""
    for path in sorted((expected / "sparse").glob("*")):
        other = found / "sparse" / path.name
        if other.is_file() and path.read_bytes() != other.read_bytes():
            yield f"sparse/{path.name} differs"
    if _rows(expected / "cases.json", _TIMING) != _rows(found / "cases.json", _TIMING):
        yield "cases.json differs"


def _tables(expected: Path, found: Path) -> Iterator[str]:
    tolerance = _TOLERANCE * _diagonal(expected)
    for name in _TABLES:
        if _rows(expected / name, _PLACE) != _rows(found / name, _PLACE):
            yield f"{name} differs"
            continue
        distance = _apart(_places(expected / name), _places(found / name))
        if distance > tolerance:
            yield f"{name}: places are {distance:.3g} apart, {tolerance:.3g} allowed"


def _meshes(expected: Path, found: Path) -> Iterator[str]:
    for name in _MESHES:
        paths = (expected / name, found / name)
        if not all(path.is_file() for path in paths):
            continue
        one, other = (_vertices(path) for path in paths)
        worst = max(float(np.max(cKDTree(a).query(b)[0])) for a, b in ((one, other), (other, one)))
        tolerance = _TOLERANCE * _diagonal(expected)
        if worst > tolerance:
            yield f"{name}: surfaces are {worst:.3g} apart, {tolerance:.3g} allowed"


def _rows(path: Path, without: Sequence[str]) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else []
    return [{key: value for key, value in row.items() if key not in without} for row in rows]


def _places(path: Path) -> list[Sequence[float | None]]:
    rows: list[Mapping[str, Any]] = json.loads(path.read_text(encoding="utf-8"))
    return [row.get("centroid") or (row.get("x"), row.get("y"), row.get("z")) for row in rows]


def _apart(one: Sequence[Sequence[float | None]], other: Sequence[Sequence[float | None]]) -> float:
    """Largest distance of two lists of places; infinite where only one of them is known."""
    worst = 0.0
    for a, b in zip(one, other, strict=True):
        known = [np.array(place, dtype=float) for place in (a, b) if None not in place]
        if len(known) == 1:
            return math.inf
        if known:
            worst = max(worst, float(np.linalg.norm(known[0] - known[1])))
    return worst


def _vertices(path: Path) -> np.ndarray:
    vertex = PlyData.read(path)["vertex"]
    return np.stack([vertex["x"], vertex["y"], vertex["z"]], axis=1).astype(float)


def _diagonal(root: Path) -> float:
    """Of the box around the mesh; 0 when there is none, and then places must be equal."""
    path = root / _MESHES[0]
    vertices = _vertices(path) if path.is_file() else np.zeros((1, 3))
    return float(np.linalg.norm(vertices.max(axis=0) - vertices.min(axis=0)))
