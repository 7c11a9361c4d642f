"""Stage `mesh`: Poisson surface, support of every vertex, and the supported surface."""

from __future__ import annotations

import json

from core.io.surface import full_mesh, fused_cloud, supported_mesh
from core.products.surface import MeshProduct
from core.stage import StageTask
from core.surface.ply import read_mesh, write_mesh
from core.surface.poisson import poisson_mesh, supported_surface


def run(task: StageTask) -> MeshProduct:
    """Write ``mesh_poisson.ply``, ``mesh_full.ply`` (both with ``support``) and ``mesh.json``."""
    cloud_path = fused_cloud(task.input("fuse"))
    raw_path = task.out / "raw.ply"
    task.report(0, 3, "Poisson surface")
    mesh = poisson_mesh(cloud_path, raw_path, task.settings.mesh)
    raw_path.unlink()
    task.report(1, 3, "support")
    cloud = read_mesh(cloud_path)
    surface = supported_surface(mesh, cloud, task.settings.mesh)
    task.report(2, 3, "writing")
    write_mesh(full_mesh(task.out), surface.full, cloud.comments)
    write_mesh(supported_mesh(task.out), surface.kept, cloud.comments)
    product = MeshProduct(
        n_vertices=len(surface.kept.vertices),
        n_faces=len(surface.kept.faces),
        n_full_vertices=len(surface.full.vertices),
        n_full_faces=len(surface.full.faces),
        diagonal_su=round(surface.kept.diagonal, 9),
        point_spacing_su=round(surface.spacing, 12),
        supported_share=round(surface.supported_share, 4),
    )
    (task.out / "mesh.json").write_text(json.dumps(product.facts, indent=1))
    return product
