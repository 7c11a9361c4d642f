"""Names of the surface's files in the results of `fuse`, `mesh`, `map_defects` and `timeline`.

Their form is that of `core.surface.ply` and `core.surface.glb`.
"""

from __future__ import annotations

from pathlib import Path


def fused_cloud(folder: Path) -> Path:
    """Points of all depth maps, in the result of `fuse`."""
    return folder / "fused.ply"


def supported_mesh(folder: Path) -> Path:
    """Surface trimmed to what the cloud supports, in the result of `mesh`."""
    return folder / "mesh_poisson.ply"


def full_mesh(folder: Path) -> Path:
    """The whole Poisson surface, in the result of `mesh`."""
    return folder / "mesh_full.ply"


def support_cloud(folder: Path) -> Path:
    """Sparse points that support detections, in the result of `map_defects`."""
    return folder / "defect_points.ply"


def defect_mesh(folder: Path) -> Path:
    """Surface in the colours of its defects, in the result of `timeline` and below ``mapping/`` of a published one."""
    return folder / "mesh_defects.ply"


def defect_glb(folder: Path) -> Path:
    """The same surface as glTF, in the result of `timeline`."""
    return folder / "mesh_defects.glb"
