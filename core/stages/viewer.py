"""Stage `viewer`: the surface of one model as the page shows it and in pictures, its poses, and its best views."""

from __future__ import annotations

import shutil
from collections.abc import Iterable

from core.io.frames import read_crop
from core.io.sparse import model_folder
from core.io.surface import defect_mesh, supported_mesh
from core.io.timeline import read_defects
from core.mapping.facing import read_surface
from core.outputs import SURFACE_GLB
from core.products.surface import ViewerProduct
from core.scene.defect import DefectRecord
from core.scene.frame import image_name
from core.stage import StageTask
from core.surface.ply import read_mesh
from core.viewer.build import with_blades, write_scene
from core.viewer.scene import FRAMES, FULL, best_frames


def run(task: StageTask) -> ViewerProduct:
    """Write `surface.glb`, `scene.json`, `frames/` and `surface/`."""
    facing, views = read_surface(model_folder(task.input("extend")), supported_mesh(task.input("mesh")))
    mesh = with_blades(facing, read_mesh(defect_mesh(task.input("timeline"))))
    records = read_defects(task.input("timeline"))
    task.report(1, 5, "copying the best views")
    full = _keep_best(task, records)
    task.report(2, 5, "thinning out the surface")
    scene = write_scene(task.out, mesh, views, read_crop(task.input("frames")), records, full, task.threads)
    task.report(5, 5, "surface of the page written")
    return ViewerProduct(n_faces=scene.surface.faces, glb_bytes=(task.out / SURFACE_GLB).stat().st_size)


def _keep_best(task: StageTask, records: Iterable[DefectRecord]) -> list[int]:
    """Copy the pictures of the best views that are published at half size only; gives their frames."""
    if "pictures" not in task.inputs:  # it may fail, and the surface is worth having without
        return []
    source = task.input("pictures") / FULL
    wanted = sorted({index for record in records for index in best_frames(record)})
    kept = [index for index in wanted if (source / image_name(index)).is_file()]
    (task.out / FRAMES).mkdir()
    for index in kept:
        shutil.copyfile(source / image_name(index), task.out / FRAMES / image_name(index))
    return kept
