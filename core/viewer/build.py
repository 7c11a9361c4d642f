"""The surface and the scene of one model, written from its meshes, views and defects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.json_files import JsonObject
from core.outputs import SURFACE_GLB
from core.scene.defect import DefectRecord
from core.scene.frame import Crop
from core.scene.views import Views
from core.surface.ply import Mesh
from core.surface.support import vertex_spacing
from core.viewer.parts import viewer_parts
from core.viewer.portraits import write_portraits
from core.viewer.quantized import write_quantized_glb
from core.viewer.scene import SurfaceFacts, ViewerScene

F64 = NDArray[np.float64]
_ROTATION_DECIMALS, _TRANSLATION_DIGITS = 7, 7
"""Of the poses: a point of the surface moves by less than a thousandth of a pixel."""


def write_scene(
    folder: Path,
    mesh: Mesh,
    views: Views,
    crop: Crop,
    records: Sequence[DefectRecord],
    full: Sequence[int] = (),
    threads: int = 1,
) -> ViewerScene:
    """Write `surface.glb`, a picture of the surface at each defect, and `scene.json`.

    Args:
        folder: existing.
        mesh: supported surface in the pictures' colours, its faces counter-clockwise seen from the cameras
            (`core.mapping.facing.read_surface`), with `support` and, where blades are known, `blade`.
        views: registered views of the model.
        crop: part of the source frames that was used.
        records: defects of the model; their faces are of `mesh`.
        full: frames whose pictures lie beside the surface, at the source's size.
        threads: side by side.
    """
    parts = viewer_parts(mesh, {record.id: record.faces for record in records})
    write_quantized_glb(folder / SURFACE_GLB, parts)
    portraits = write_portraits(folder, mesh, views, records, threads)
    nodes = tuple(record.id for record in records if len(record.faces))
    faces = sum(len(part.faces) for part in parts.values())
    surface = SurfaceFacts(faces, len(mesh.faces), vertex_spacing(mesh))
    camera, poses, up = camera_of(views, crop), poses_of(views), up_of(views)
    scene = ViewerScene(camera, poses, up, surface, nodes, tuple(portraits), tuple(full))
    scene.write(folder)
    return scene


def with_blades(mesh: Mesh, colored: Mesh) -> Mesh:
    """The mesh with the blades of `colored`, which has the same vertices, where these are known."""
    blade = colored.extra.get("blade")
    return mesh if blade is None else replace(mesh, extra={**mesh.extra, "blade": blade})


def camera_of(views: Views, crop: Crop) -> JsonObject:
    """The lens for pixels of the whole source frame: that of the exported part, with its principal point moved."""
    params = [float(value) for value in views.camera.params]
    for at, shift in zip(views.camera.principal_point_idxs(), (crop.x0, crop.y0), strict=True):
        params[at] += shift
    return {
        "model": views.camera.model.name,
        "width": crop.source_width,
        "height": crop.source_height,
        "params": params,
        "crop": [crop.x0, crop.y0, crop.x1, crop.y1],
    }


def poses_of(views: Views) -> dict[int, list[float]]:
    """cam_from_world of every registered frame by its index, row by row.

    Rotations have seven decimals and translations seven digits, as many as the page's single precision holds.
    """
    rotations = views.R.round(_ROTATION_DECIMALS) + 0.0  # -0.0 becomes 0.0, which is shorter
    translations = np.array([float(f"{value:.{_TRANSLATION_DIGITS}g}") for value in views.t.ravel()]).reshape(-1, 3, 1)
    matrices = np.concatenate([rotations, translations + 0.0], axis=2).reshape(-1, 12)
    return {int(index): matrix.tolist() for index, matrix in zip(views.frame_index, matrices, strict=True)}


def up_of(views: Views) -> list[float] | None:
    """Unit direction in the world that is up in the pictures, on average; None when that is none."""
    if not len(views):
        return None
    mean: F64 = -views.R[:, 1, :].mean(axis=0)
    length = float(np.linalg.norm(mean))
    return (mean / length).tolist() if length > 1e-6 else None
