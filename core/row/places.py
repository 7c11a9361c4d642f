"""Where on the row places lie: their blade, its side, and how far from root, tip and edges."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.json_files import JsonObject
from core.mapping.surface import Surface
from core.row.model import BladeRow, EdgeName
from core.row.overlap import radial
from core.row.section import FACING, facing, on_sheet
from core.scene.on_row import RowColumns, Side
from core.scene.size import Scale
from core.surface.glb import unit_rows, vertex_normals
from core.surface.ply import Mesh

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

END_SIGMAS = 3.0
"""A place that faces the axis, or away from it, is of the platform or the tip within so many sigmas of that radius."""
EDGE_SIGMAS, LEAST_EDGE_SIGMAS = 2.0, 1.0
"""A place that looks along the chord lies on an edge within so many sigmas of it, and any other within so many."""
EDGE_COSINE = 2.0 * FACING
"""Cosine between the normal of a place and that of the sheet, below which it looks along the chord."""
ON_SHEET = 0.25
"""Of a pitch: a place nearer to the middle of a blade is the blade's, whichever way its surface looks."""
_DIGITS = 6
_EDGES = {EdgeName.LEADING: Side.LEADING_EDGE, EdgeName.TRAILING: Side.TRAILING_EDGE, EdgeName.UNKNOWN: Side.EDGE}


@dataclass(frozen=True)
class OnRow:
    """Where on a row a place lies, lengths in the unit of the model."""

    blade: int | None
    """Number of the blade; None between the blades, or on one that hardly was seen."""
    columns: RowColumns
    from_edge_a: float | None = None
    """Share of the chord from edge a to edge b, whatever these are; None where one of them was not seen."""

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {"blade": self.blade, **asdict(self.columns), "from_edge_a": self.from_edge_a}

    def scaled(self, scale: Scale | None) -> OnRow:
        """The same with lengths in mm; unchanged without a scale."""
        if scale is None:
            return self
        changed = {}
        for name in ("edge_distance", "root_distance"):
            value, sigma = getattr(self.columns, name), getattr(self.columns, f"{name}_sigma")
            if value is not None:
                changed[name] = round(scale.value * value, _DIGITS)
                changed[f"{name}_sigma"] = round(float(np.hypot(scale.value * sigma, scale.sigma * value)), _DIGITS)
        return replace(self, columns=replace(self.columns, **changed))


def on_row(row: BladeRow, places: F64, normals: F64, sigmas: Sequence[float | None]) -> list[OnRow]:
    """Where on the row of their model places lie.

    Args:
        row: of the model.
        places: (n, 3) in the model's world frame.
        normals: (n, 3) unit, of the surface there, towards the cameras.
        sigmas: n standard deviations of the places, in the unit of the model; None = unknown, and counted as zero.
    """
    if not len(places):
        return []
    _, radius, _ = row.axis.cylinder(places)
    across = radial(row.axis, places, normals)
    index, cosine = row.sheet.blade(places), facing(row.sheet, places, normals)
    chord, _, from_middle = on_sheet(row.sheet, places)
    position = row.sheet.position(places)
    off = position - np.round(position)
    edges = {
        name: (edge.chord(from_middle), edge.sigma) for name, edge in row.section.edges.items() if edge is not None
    }
    found = []
    for k, sigma in enumerate(sigmas):
        own = {name: (float(at[k]), float(np.hypot(spread, sigma or 0.0))) for name, (at, spread) in edges.items()}
        columns = {**_radial_columns(row, float(radius[k]), sigma), **_chord_columns(row, float(chord[k]), own)}
        blade = row.numbers.get(int(index[k]))
        if across[k]:
            side = _end(row, float(radius[k]), sigma)
            if side == Side.OTHER and abs(off[k]) < ON_SHEET:
                side = Side.UNKNOWN  # the wall of a dent, say, in the middle of a blade
            elif side != Side.TIP:
                blade = None
            columns = {name: value for name, value in columns.items() if not name.startswith(("chord", "edge"))}
        else:
            side = _side(row, float(cosine[k]), float(chord[k]), own)
        share = None if across[k] else _share(float(chord[k]), own)
        rounded = {name: round(value, _DIGITS) for name, value in columns.items()}
        found.append(OnRow(blade, RowColumns(side=side, **rounded), None if share is None else round(share, _DIGITS)))
    return found


def _radial_columns(row: BladeRow, radius: float, sigma: float | None) -> dict[str, float]:
    height, distance = row.tip_radius - row.root_radius, radius - row.root_radius
    own = float(np.hypot(row.radius_sigma, sigma or 0.0))
    share = float(np.clip(distance / height, 0.0, 1.0))
    return {
        "span": share,
        "span_sigma": float(np.hypot(own, share * row.radius_sigma)) / height,
        "root_distance": distance,
        "root_distance_sigma": own,
    }


def _chord_columns(row: BladeRow, chord: float, edges: dict[str, tuple[float, float]]) -> dict[str, float]:
    """Distance to the nearer edge that was seen, and the share of the chord where both were and have names."""
    if not edges:
        return {}
    distance, sigma = min((abs(chord - at), spread) for at, spread in edges.values())
    columns = {"edge_distance": distance, "edge_distance_sigma": sigma}
    share = _share(chord, edges)
    if share is not None and row.edge_a != EdgeName.UNKNOWN:
        (a, spread_a), (b, spread_b) = edges["a"], edges["b"]
        spread = float(np.hypot((1.0 - share) * spread_a, share * spread_b)) / abs(b - a)
        columns |= {"chord": share if row.edge_a == EdgeName.LEADING else 1.0 - share, "chord_sigma": spread}
    return columns


def _share(chord: float, edges: dict[str, tuple[float, float]]) -> float | None:
    if len(edges) < 2:
        return None
    (a, _), (b, _) = edges["a"], edges["b"]
    return float(np.clip((chord - a) / (b - a), 0.0, 1.0))


def _end(row: BladeRow, radius: float, sigma: float | None) -> Side:
    """Of a place that faces the axis, or away from it."""
    reach = END_SIGMAS * float(np.hypot(row.radius_sigma, sigma or 0.0))
    if abs(radius - row.root_radius) < reach:
        return Side.PLATFORM
    return Side.TIP if abs(radius - row.tip_radius) < reach else Side.OTHER


def _side(row: BladeRow, cosine: float, chord: float, edges: dict[str, tuple[float, float]]) -> Side:
    reach = EDGE_SIGMAS if abs(cosine) < EDGE_COSINE else LEAST_EDGE_SIGMAS
    for name, (at, sigma) in edges.items():
        if abs(chord - at) < reach * sigma:
            return _EDGES[row.edge_a if name == "a" else row.edge_a.other]
    if abs(cosine) < FACING:
        return Side.UNKNOWN
    return row.section.sides[1 if cosine > 0 else -1]


def normals_at(mesh: Mesh, places: F64) -> F64:
    """(n, 3) unit normals of a mesh at its points nearest to (n, 3) places, the mean over the corners of the face."""
    if not len(places):
        return np.zeros((0, 3))
    _, face = Surface(mesh.vertices, mesh.faces).nearest(places)
    return unit_rows(vertex_normals(mesh)[mesh.faces[face]].sum(axis=1))


def blades_of_vertices(row: BladeRow, mesh: Mesh) -> I32:
    """(n,) number of the blade that every vertex of a mesh lies on; 0 = none."""
    index = row.sheet.blade(mesh.vertices)
    blade = np.zeros(len(index), np.int32)
    for own, number in row.numbers.items():
        blade[index == own] = number
    blade[radial(row.axis, mesh.vertices, vertex_normals(mesh))] = 0
    return blade
