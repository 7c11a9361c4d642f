"""Influence of sparse support points on the surface, and its files ``coloring.npz`` and ``support.npz``."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.mapping.coloring import coloring_radius, vertex_weights
from core.scene.methods import Support
from core.settings.groups import MappingSettings
from core.surface.ply import Mesh

_COLORING = "coloring.npz"
_SUPPORT = "support.npz"


@dataclass(frozen=True)
class SupportColoring:
    """What the support points of detections do to the vertices of a mesh."""

    weight: NDArray[np.float32]
    """(n,) strongest influence, in [0, 1]."""
    detection: NDArray[np.int32]
    """(n,) id of the detection with that influence; -1 = none."""


def color_by_support(mesh: Mesh, support: Support, settings: MappingSettings, threads: int) -> SupportColoring:
    """Equations 3.1 and 3.2 for all vertices; a point in several boxes is coloured for the first of them."""
    first = support.first
    radius = coloring_radius(mesh.diagonal, settings.radius_fraction)
    sigma = settings.sigma_fraction * radius
    coloring = vertex_weights(mesh.vertices, support.position[first], radius, sigma, threads)
    strongest = np.full(len(mesh.vertices), -1, np.int32)
    near = coloring.point >= 0
    strongest[near] = support.detection[first][coloring.point[near]]
    return SupportColoring(coloring.weight, strongest)


def write_coloring(folder: Path, coloring: SupportColoring, support: Support) -> None:
    """Write the influence on every vertex and the support points that it comes from."""
    np.savez(folder / _COLORING, weight=coloring.weight, detection=coloring.detection)
    np.savez(folder / _SUPPORT, detection=support.detection, point_id=support.point_id, position=support.position)


def read_coloring(folder: Path) -> tuple[SupportColoring, Support]:
    """Read what `write_coloring` wrote."""
    with np.load(folder / _COLORING) as data:
        coloring = SupportColoring(data["weight"], data["detection"])
    with np.load(folder / _SUPPORT) as data:
        support = Support(data["detection"], data["point_id"], data["position"])
    return coloring, support
