"""The surface of a fused cloud: COLMAP's Poisson meshing, then support and trimming."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import cv2  # noqa: F401  (before pycolmap: the other order aborts when a PNG is written)
import pycolmap

from core.errors import StageFailed
from core.settings.groups import MeshSettings
from core.surface.ply import Mesh, read_mesh
from core.surface.support import cloud_distance, keep_vertices, largest_component, point_spacing, support

SUPPORTED = 0.5
"""Vertices with at least this support are kept, see `support.support`."""


@dataclass(frozen=True)
class Surface:
    """The whole Poisson surface and what is kept of it; both carry ``support`` per vertex."""

    full: Mesh
    kept: Mesh
    spacing: float
    """Median point spacing of the cloud, scene units."""
    supported_share: float
    """Share of the full surface's vertices that the cloud supports."""


def poisson_mesh(cloud: Path, out: Path, settings: MeshSettings) -> Mesh:
    """Poisson surface of a cloud with normals and colours; `StageFailed` when it comes out empty.

    One thread: with more the vertices differ from run to run.
    """
    options = pycolmap.PoissonMeshingOptions()
    options.depth = settings.poisson_depth
    options.trim = settings.poisson_trim
    options.color = True
    options.num_threads = 1
    pycolmap.poisson_meshing(str(cloud), str(out), options)
    mesh = read_mesh(out) if out.exists() else None
    if mesh is None or not len(mesh.faces):
        raise StageFailed(
            "Poisson meshing left no surface; try a smaller mesh.poisson_trim or mesh.poisson_depth",
            code="empty_mesh",
            where="mesh",
        )
    return mesh


def supported_surface(mesh: Mesh, cloud: Mesh, settings: MeshSettings) -> Surface:
    """Support of every vertex, and the part of the mesh to keep.

    With `keep_unsupported` the kept mesh is the full one; `keep_largest_component` then drops all other parts.

    Raises:
        StageFailed: the cloud supports no face.
    """
    spacing = point_spacing(cloud.vertices)
    distance = cloud_distance(mesh.vertices, cloud.vertices)
    values = support(distance, spacing, settings.support_spacings)
    full = replace(mesh, extra={"support": values})
    supported = values >= SUPPORTED
    kept = full if settings.keep_unsupported else keep_vertices(full, supported)
    if settings.keep_largest_component:
        kept = keep_vertices(kept, largest_component(kept))
    if not len(kept.faces):
        raise StageFailed("the fused cloud supports no part of the surface", code="empty_mesh", where="mesh")
    return Surface(full, kept, spacing, float(supported.mean()))
