"""A row of turbine blades as a mesh, with its defects: nicks and dents are shape, the others are colour."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bench.scenes.spec import Scene

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

HUB_MM = 150.0
HEIGHT_MM = 48.0
SPAN_CELLS, LOOP_CELLS = 72, 112
KINDS = ("coating_loss", "burn", "crack", "dent", "nick")
DENT_DEPTH = 0.35
"""Depth of a dent at its deepest, in radii."""
RING_MM = 0.2
"""By which a ring lies inside of the ends of the blades."""
SPARE_BLADES = 3
"""Blades on each side of those that come into view."""


@dataclass(frozen=True)
class Defect:
    """A defect on one blade."""

    number: int
    blade: int
    kind: str
    span: float
    chord: float
    """0 = leading edge, 1 = trailing edge."""
    side: int
    radius_mm: float
    center: F64 = field(default_factory=lambda: np.zeros(3))
    """(3,) nominal place in the rotor's frame, mm."""


@dataclass(frozen=True)
class Row:
    """The blades of a scene in the rotor's frame (engine axis = z), mm."""

    vertices: F64
    faces: I32
    normals: F64
    """(n, 3) unit, outwards."""
    defects: tuple[Defect, ...]


def pitch_rad(scene: Scene) -> float:
    """Angle from blade to blade."""
    return 2.0 * np.pi / scene.blades_in_row


def _section(u: F64, side: F64, chord: F64) -> tuple[F64, F64]:
    """Along and across the chord of an aerofoil at u in [0, 1] (0 = leading edge) on its upper (+1) or lower side."""
    thickness = 0.16 * chord * (1.5 * np.sqrt(np.maximum(u, 0.0)) - 0.9 * u - 0.6 * u**2) + 0.012 * chord
    camber = 0.20 * chord * 4.0 * u * (1.0 - u)
    return (u - 0.5) * chord, camber + side * thickness / 2


def _place(scene: Scene, angle: F64, span: F64, along: F64, across: F64) -> F64:
    """Points of a blade in the rotor's frame from its section coordinates."""
    at_root, at_tip = np.radians(scene.stagger_deg)
    stagger = at_root + (at_tip - at_root) * span
    tangential = along * np.sin(stagger) + across * np.cos(stagger)
    axial = along * np.cos(stagger) - across * np.sin(stagger)
    radius = HUB_MM + span * HEIGHT_MM
    turn = angle + tangential / radius
    return np.stack([radius * np.cos(turn), radius * np.sin(turn), axial], axis=-1)


def _chord(scene: Scene, span: F64) -> F64:
    root, tip = scene.chord_mm
    return root + (tip - root) * span


def surface_point(scene: Scene, blade: int, span: float, chord: float, side: int) -> F64:
    """(3,) a place on the undamaged surface of a blade."""
    s = np.array(span)
    along, across = _section(np.array(chord), np.array(float(side)), _chord(scene, s))
    return _place(scene, np.array(blade * pitch_rad(scene)), s, along, across)


def _loop() -> tuple[F64, F64]:
    """u and side around a section, denser at the edges: lower side from the trailing edge, then the upper back."""
    half = (1.0 - np.cos(np.linspace(0.0, np.pi, LOOP_CELLS // 2 + 1))) / 2
    u = np.concatenate([half[::-1], half[1:-1]])
    side = np.concatenate([-np.ones(len(half)), np.ones(len(half) - 2)])
    return u, side


def build_row(scene: Scene) -> Row:
    """Blades in view over the clip, with the scene's defects put on those that face the probe."""
    rng = np.random.default_rng(scene.seed)
    in_view = int(np.ceil(np.radians(abs(scene.turn_deg) + abs(scene.jump_deg)) / pitch_rad(scene))) + 1
    defects = _choose_defects(scene, in_view, rng)
    vertices, faces = [], []
    offset = 0
    for blade in _present(scene, in_view):
        points, triangles = _blade(scene, blade, [defect for defect in defects if defect.blade == blade])
        vertices.append(points)
        faces.append(triangles + offset)
        offset += len(points)
    for radius in (HUB_MM + RING_MM, *((HUB_MM + HEIGHT_MM - RING_MM,) if scene.shroud else ())):
        points, triangles = _ring(scene, in_view, radius)
        vertices.append(points)
        faces.append(triangles + offset)
        offset += len(points)
    all_vertices, all_faces = np.concatenate(vertices), np.concatenate(faces).astype(np.int32)
    return Row(all_vertices, all_faces, vertex_normals(all_vertices, all_faces), tuple(defects))


def _present(scene: Scene, in_view: int) -> range:
    if scene.blades_present is not None:
        return range(scene.blades_present)
    return range(-SPARE_BLADES, in_view + SPARE_BLADES + 1)


def _choose_defects(scene: Scene, in_view: int, rng: np.random.Generator) -> list[Defect]:
    """Spread over the blades, kinds in turn, on the convex side or at the leading edge, which the probe sees."""
    if scene.blades_present == 0:
        return []
    last = in_view if scene.blades_present is None else scene.blades_present - 1
    blades = np.linspace(0, last, scene.n_defects + 2)[1:-1].round().astype(int)
    found = []
    for number, blade in enumerate(blades.tolist()):
        kind = KINDS[(number + scene.seed) % len(KINDS)]
        span = float(rng.uniform(0.2, 0.85))
        chord = 0.0 if kind == "nick" else float(rng.uniform(0.08, 0.42))
        radius = float(rng.uniform(1.2, 1.7) if kind in ("nick", "dent") else rng.uniform(1.6, 3.0))
        center = surface_point(scene, blade, span, chord, 1)
        found.append(Defect(number, blade, kind, span, chord, 1, radius, center))
    return found


def _blade(scene: Scene, blade: int, defects: list[Defect]) -> tuple[F64, I32]:
    u, side = _loop()
    span = np.linspace(0.0, 1.0, SPAN_CELLS + 1)
    s, u2 = np.meshgrid(span, u, indexing="ij")
    side2 = np.broadcast_to(side, s.shape)
    angle = np.array(blade * pitch_rad(scene))
    for defect in defects:
        if defect.kind == "nick":
            u2 = _nicked(scene, s, u2, defect)
    along, across = _section(u2, side2, _chord(scene, s))
    points = _place(scene, angle, s, along, across)
    for defect in defects:
        if defect.kind == "dent":
            points = _dented(scene, points, defect)
    columns = len(u)
    index = np.arange((SPAN_CELLS + 1) * columns).reshape(SPAN_CELLS + 1, columns)
    right = np.roll(index, -1, axis=1)
    a, b, c, d = index[:-1], right[:-1], right[1:], index[1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    tip = index[-1]
    middle = len(points.reshape(-1, 3))
    cap = np.stack([tip, np.roll(tip, -1), np.full(columns, middle)], axis=1)
    vertices = np.concatenate([points.reshape(-1, 3), points[-1].mean(axis=0, keepdims=True)])
    return vertices, np.concatenate([faces, cap]).astype(np.int32)


def _nicked(scene: Scene, s: F64, u: F64, defect: Defect) -> F64:
    """The section shortened from the leading edge where metal is missing."""
    across_mm = (s - defect.span) * HEIGHT_MM
    depth = defect.radius_mm / _chord(scene, s) * np.sqrt(np.maximum(0.0, 1.0 - (across_mm / defect.radius_mm) ** 2))
    shortened: F64 = depth + u * (1.0 - depth)
    return shortened


def _dented(scene: Scene, points: F64, defect: Defect) -> F64:
    """A dish pushed in from the defect's side of the blade."""
    inward = surface_point(scene, defect.blade, defect.span, defect.chord, -defect.side) - defect.center
    inward = inward / np.linalg.norm(inward)
    distance = np.linalg.norm(points - defect.center, axis=-1)
    depth = DENT_DEPTH * defect.radius_mm * np.maximum(0.0, 1.0 - (distance / defect.radius_mm) ** 2) ** 2
    moved: F64 = points + depth[..., None] * inward
    return moved


def _ring(scene: Scene, in_view: int, radius: float) -> tuple[F64, I32]:
    """The platform between the blades, or the shroud about their tips."""
    first, last = (k * pitch_rad(scene) for k in (-SPARE_BLADES, in_view + SPARE_BLADES))
    angle, axial = np.meshgrid(np.linspace(first, last, 160), np.linspace(-22.0, 22.0, 24), indexing="ij")
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), axial], axis=-1)
    index = np.arange(angle.size).reshape(angle.shape)
    a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return points.reshape(-1, 3), faces.astype(np.int32)


def vertex_normals(vertices: F64, faces: I32) -> F64:
    """(n, 3) unit normals, the mean of the faces around by their area."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    total = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(total, faces[:, k], normal)
    normals: F64 = total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-12)
    return normals
