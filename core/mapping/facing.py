"""Surfaces whose faces are turned towards the cameras: counter-clockwise for who looks from there."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from core.io.sparse import open_model
from core.mapping.surface import Surface
from core.scene.views import Views, views_of
from core.surface.ply import Mesh, read_mesh


def read_surface(model_dir: Path, mesh_path: Path) -> tuple[Mesh, Views]:
    """A surface, turned towards the cameras (`oriented`), and the views.

    Args:
        model_dir: COLMAP model, image id = frame index + 1.
        mesh_path: surface in its world frame.

    Raises:
        StageFailed: one of the two cannot be read.
    """
    views = views_of(open_model(model_dir))
    return oriented(read_mesh(mesh_path), views), views


def oriented(mesh: Mesh, views: Views) -> Mesh:
    """The mesh with its faces turned towards the cameras, should most of them show their back.

    A ray through the middle of every view is asked; with no hit at all the mesh stays as it is.
    """
    middle = np.array([[views.camera.width / 2, views.camera.height / 2]])
    rays = np.concatenate([views.rays(middle, R) for R in views.R]) if len(views.R) else np.zeros((0, 3))
    hits = Surface(mesh.vertices, mesh.faces).cast(views.centers, rays)
    if not hits.hit.any() or (hits.cosine[hits.hit] > 0).mean() >= 0.5:
        return mesh
    return Mesh(
        mesh.vertices,
        np.ascontiguousarray(mesh.faces[:, ::-1]),
        mesh.colors,
        None if mesh.normals is None else -mesh.normals,
        mesh.extra,
        mesh.comments,
    )
