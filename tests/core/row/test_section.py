"""An edge of the blades is told from the border of what was seen of them."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.scenes.blades import surface_point
from core.row.blades import Sheet, fit_sheet
from core.row.overlap import Hypothesis
from core.row.sample import SurfaceSample, sample_surface, steadied, thinned
from core.row.section import Edge, _edge, facing, on_sheet, section_of
from core.row.turn import Axis
from core.surface.ply import Mesh
from tests.core.making_blades import PITCH_RAD, SCENE, blade_of, blades

pytestmark = pytest.mark.slow

F64 = NDArray[np.float64]

TRUE = Hypothesis(Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3)), PITCH_RAD)
POINTS = 4000
CUTS = (0.55, 0.65, 0.75)
"""Shares of the chord, from the leading edge, that are seen of torn blades."""
TORN_MM = 5.0
"""Where their surface is torn, from the cut."""
WITHIN_MM = 2.0


def sampled(mesh: Mesh) -> tuple[Sheet, SurfaceSample]:
    sample = thinned(sample_surface(mesh, 0, normals_of=steadied(mesh, 0)), POINTS)
    return fit_sheet(sample, TRUE), sample


def chord_of(sheet: Sheet, share: float) -> float:
    """Coordinate along the chord, mm, of a share of it half way out, on the convex side."""
    chord, _, _ = on_sheet(sheet, surface_point(SCENE, 1, 0.5, share, 1)[None])
    return float(chord[0])


def torn(mesh: Mesh, sheet: Sheet, concave: float = 0.3) -> Mesh:
    """The blades as cameras before their leading edges see them.

    The convex sides as far as `CUTS`, in patches before them, which are rough, and the concave sides as far as a share
    of the chord.
    """
    rng = np.random.default_rng(0)
    corners = mesh.vertices[mesh.faces]
    middle, normals = corners.mean(axis=1), np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    chord, _, _ = on_sheet(sheet, middle)
    way = np.sign(chord_of(sheet, 1.0) - chord_of(sheet, 0.0))
    cuts = np.array([chord_of(sheet, share) for share in CUTS])
    beyond = way * (chord - cuts[blade_of(mesh.faces[:, 0])])
    convex = facing(sheet, middle, normals / np.linalg.norm(normals, axis=1, keepdims=True)) > 0
    patches = np.cos(np.array((2.1, 1.3, 1.9)) * middle + rng.uniform(0.0, 6.0, 3)).prod(axis=1) > 0.1
    kept = (beyond < -TORN_MM) | ((beyond < 0) & patches)
    kept &= convex | (way * (chord - chord_of(sheet, concave)) < 0)
    vertices, near = mesh.vertices.copy(), np.unique(mesh.faces[kept & (beyond > -TORN_MM)])
    vertices[near] += rng.normal(scale=0.4, size=(len(near), 3))
    return Mesh(vertices, mesh.faces[kept])


def place(edge: Edge | None) -> float:
    assert edge is not None
    return float(edge.chord(np.zeros(1))[0])


def test_both_edges_of_whole_blades_are_found() -> None:
    sheet, sample = sampled(blades(3))
    edges = section_of(sheet, sample).edges
    ends = sorted((chord_of(sheet, 0.0), chord_of(sheet, 1.0)))
    assert (place(edges["a"]), place(edges["b"])) == pytest.approx(ends, abs=WITHIN_MM)


@pytest.mark.parametrize("concave", [0.3, 0.0], ids=["seen from both sides", "from one side alone"])
def test_a_torn_border_is_no_edge(concave: float) -> None:
    whole, _ = sampled(blades(3))
    sheet, sample = sampled(torn(blades(3), whole, concave))
    edges = section_of(sheet, sample).edges
    seen, hidden = ("a", "b") if chord_of(whole, 0.0) < chord_of(whole, 1.0) else ("b", "a")
    assert edges[hidden] is None
    assert place(edges[seen]) == pytest.approx(chord_of(sheet, 0.0), abs=WITHIN_MM)


def test_an_edge_seen_from_one_side_alone_ends_sharply() -> None:
    """A side that bends away at its edge shows more points there; where the view ends they get fewer."""
    rng = np.random.default_rng(0)
    chord = np.concatenate(
        [rng.uniform(4.0, 20.0, 4000), rng.uniform(18.0, 20.0, 300), 4.0 - rng.exponential(1.5, 600)]
    )
    rho, looks = rng.uniform(-10.0, 10.0, len(chord)), np.ones(len(chord))
    seen = _edge(chord, rho, looks, 0.5, 1)
    assert place(seen) == pytest.approx(20.0, abs=0.3)
    assert _edge(chord, rho, looks, 0.5, -1) is None
