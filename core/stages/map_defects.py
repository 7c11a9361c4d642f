"""Stage `map_defects`: every detection placed on the surface, one row each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.io.annotations import read_detections, read_looked_at
from core.io.frames import read_crop, read_frames, read_registered
from core.io.sparse import model_folder
from core.io.surface import fused_cloud, support_cloud, supported_mesh
from core.mapping.depth_consistency import no_depth_maps
from core.mapping.load import matches_of_graph, open_depth_maps, open_mapping_scene
from core.mapping.scene import Scene
from core.mapping.support import SparseModel, boxes_by_frame, read_sparse_model
from core.mapping.surface_rules import SurfacePlacing
from core.products.surface import PlacesProduct
from core.scene.case import GRAPHS
from core.scene.detection import DetectionRow, Outcome, outcome_counts
from core.scene.frame import RunFrames
from core.scene.methods import Placing, Support
from core.stage import StageTask
from core.surface.ply import Mesh, read_mesh, write_cloud
from core.thesis.placing import ThesisPlacing
from core.video.table import read_infos


def world_comments(task: StageTask) -> tuple[str, ...]:
    """What the coordinates of a written surface are."""
    return (f"world frame of sparse model {task.submodel} (COLMAP)", "unit: model")


def run(task: StageTask) -> PlacesProduct:
    """Place all detections by the rules that `mapping.method` names.

    Writes the files that docs/stage-results.md names.
    """
    detections = read_detections(task.input("annotations"))
    placed = _placing(task).place(detections, task.out)
    unique = _write_support_points(task, placed.support)
    task.report(4, 4, "detections placed")
    return _product(placed.rows, unique)


def _placing(task: StageTask) -> Placing:
    if task.settings.mapping.method == "thesis":
        return _by_support(task)
    task.report(0, 4, "opening the surface")
    scene, frames = open_scene_of(task)
    matches = matches_of_graph(task.input(*GRAPHS), scene.views)
    return SurfacePlacing(scene, frames, matches, task.settings.mapping.time_tolerance_s, task.report)


def open_scene_of(task: StageTask) -> tuple[Scene, RunFrames]:
    """Model, surface and frames of a run, from the results that this stage and `timeline` depend on."""
    frames, crop = read_frames(task.input("frames")), read_crop(task.input("frames"))
    detections = read_detections(task.input("annotations"))
    looked = read_looked_at(task.input("annotations"))
    depth = no_depth_maps()
    if task.has("undistort"):
        depth = open_depth_maps(task.input("undistort"), [folder for _, folder in task.fan_in("geometric")])
    scene = open_mapping_scene(
        model_folder(task.input("extend")),
        supported_mesh(task.input("mesh")),
        fused_cloud(task.input("fuse")),
        crop,
        boxes_by_frame(detections, looked, frames.index_of_source, crop),
        depth,
        task.threads,
        task.submodel,
    )
    return scene, frames


def _by_support(task: StageTask) -> ThesisPlacing:
    settings, model_dir = task.settings.mapping, model_folder(task.input("extend"))
    frames = read_frames(task.input("frames"))
    if settings.time_rule == "average_rate":
        frames = frames.timed_by_rate([info.average_rate for info in read_infos(task.input("probe"))])

    def read_model(indices: Sequence[int]) -> SparseModel:
        return read_sparse_model(model_dir, indices)

    def read_surface() -> Mesh:
        return read_mesh(supported_mesh(task.input("mesh")))

    return ThesisPlacing(
        frames,
        read_registered(task.input("extend")),
        read_crop(task.input("frames")),
        settings,
        read_model,
        read_surface,
        task.threads,
        task.report,
    )


def _write_support_points(task: StageTask, support: Support) -> int:
    """Write the cloud of distinct support points, each with the first detection that has it; gives their number."""
    first = support.first
    red = np.tile(np.array([[255, 0, 0]], np.uint8), (len(first), 1))
    cloud = Mesh(support.position[first], colors=red, extra={"detection": support.detection[first]})
    write_cloud(support_cloud(task.out), cloud, world_comments(task))
    return len(first)


def _product(rows: Sequence[DetectionRow], unique: int) -> PlacesProduct:
    rows_by, counts = outcome_counts(rows), [row.support_points for row in rows if row.outcome == Outcome.MAPPED]
    return PlacesProduct(
        n_detections=len(rows),
        outcomes=rows_by["outcomes"],
        reasons=rows_by["reasons"],
        support_min=min(counts, default=None),
        support_mean=round(sum(counts) / len(counts), 4) if counts else None,
        support_max=max(counts, default=None),
        unique_support_points=unique,
    )
