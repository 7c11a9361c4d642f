"""Defects as colour on the surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mapping.coloring import coloring_radius, vertex_weights
from core.settings.groups import MappingSettings
from core.surface.ply import Mesh
from core.timeline.defects import Found
from core.timeline.surface import defect_of_vertices


def paint_defects(
    mesh: Mesh, found: Found, settings: MappingSettings, threads: int
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """(n,) weight and (n,) defect (-1 none) of every vertex, by the points of the surface that detections showed.

    Equation 3.2 with these points instead of the thesis's sparse support. Places that made no record stay
    uncoloured.
    """
    owners = [(number, k) for number, defect in enumerate(found.defects) for k in defect.members]
    points = [found.observations[k].points for _, k in owners]
    position = np.concatenate([np.zeros((0, 3)), *points])
    defect = np.concatenate(
        [np.zeros(0, np.int32), *(np.full(len(p), n, np.int32) for (n, _), p in zip(owners, points, strict=True))]
    )
    radius = coloring_radius(mesh.diagonal, settings.radius_fraction)
    coloring = vertex_weights(mesh.vertices, position, radius, settings.sigma_fraction * radius, threads)
    strongest = np.full(len(mesh.vertices), -1, np.int32)
    near = coloring.point >= 0
    strongest[near] = defect[coloring.point[near]]
    return coloring.weight, defect_of_vertices(strongest, {n: n for n in range(len(found.defects))})
