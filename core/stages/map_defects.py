"""Stage `map_defects`: every detection placed on the surface, one row each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.json_files import read_json, write_json
from core.mapping.coloring import coloring_radius, vertex_weights
from core.mapping.depth_witness import no_depth_maps
from core.mapping.load import matches_of_graph, open_depth_maps, open_mapping_scene
from core.mapping.rows import Detection, Outcome, outcome_counts
from core.mapping.scene import Scene
from core.mapping.store import write_observations
from core.mapping.support import SparseModel, boxes_by_frame, read_sparse_model
from core.mapping.surface_rules import Observation, Times, place_on_surface
from core.mapping.thesis import FrameTimes, Placement, place_detections
from core.roi import Crop
from core.stage import Facts, StageResult, StageTask
from core.surface.ply import Mesh, read_mesh, write_cloud


def world_comments(task: StageTask) -> tuple[str, ...]:
    """What the coordinates of a written surface are."""
    return (f"world frame of sparse model {task.piece} (COLMAP)", "unit: model")


def run(task: StageTask) -> StageResult:
    """Place all detections by the rules that `mapping.method` names.

    Writes the files that docs/stage-results.md names. Facts: counts by outcome and reason, support counts.
    """
    detections = [Detection.from_json(row) for row in read_json(task.input("annotations") / "detections.json")]
    crop = Crop(**read_json(task.input("frames") / "crop.json"))
    if task.settings.mapping.method == "thesis":
        return _by_support(task, detections, crop)
    return _by_surface(task, detections)


def _by_surface(task: StageTask, detections: Sequence[Detection]) -> StageResult:
    """Cast onto the supported surface, checked by other views."""
    task.report(0, 4, "opening the surface")
    scene, times = open_scene_of(task)
    task.report(1, 4, "placing detections")
    matches = matches_of_graph(task.input("graph"), scene.views)
    reach_s = task.settings.mapping.time_tolerance_s
    observations = place_on_surface(detections, scene, times, matches, reach_s)
    task.report(3, 4, "writing")
    write_observations(task.out, observations)
    placed = [one for one in observations if len(one.point_ids)]
    owner = _concatenate([np.full(len(one.point_ids), one.row.id, np.int32) for one in placed], np.int32)
    ids = _concatenate([one.point_ids for one in placed], np.int64)
    positions = np.concatenate([one.sparse for one in placed]) if placed else np.zeros((0, 3))
    unique = _write_support_points(task, owner, ids, positions)
    task.report(4, 4, "detections placed")
    return StageResult(_facts(observations, unique))


def open_scene_of(task: StageTask) -> tuple[Scene, Times]:
    """Model, surface and frames of a run, from the results that this stage and `timeline` depend on."""
    rows = read_json(task.input("frames") / "frames.json")
    times = Times(
        {int(row["source_index"]): int(row["index"]) for row in rows},
        {int(row["index"]): float(row["time_s"]) for row in rows},
    )
    annotations, crop = task.input("annotations"), Crop(**read_json(task.input("frames") / "crop.json"))
    detections = [Detection.from_json(row) for row in read_json(annotations / "detections.json")]
    looked = read_json(annotations / "looked_at.json")
    depth = no_depth_maps()
    if task.has("undistort"):
        depth = open_depth_maps(task.input("undistort"), [folder for _, folder in task.fan_in("geometric")])
    scene = open_mapping_scene(
        task.input("extend") / "model",
        task.input("mesh") / "mesh_poisson.ply",
        task.input("fuse") / "fused.ply",
        crop,
        boxes_by_frame(detections, looked, times.index_of_source, crop),
        depth,
        task.threads,
        task.piece,
    )
    return scene, times


def _by_support(task: StageTask, detections: Sequence[Detection], crop: Crop) -> StageResult:
    """The thesis's rules, and each vertex's strongest influence (equations 3.1 and 3.2)."""
    model_dir = task.input("extend") / "model"
    frames = FrameTimes.from_rows(
        read_json(task.input("frames") / "frames.json"),
        read_json(task.input("extend") / "registered.json"),
        task.settings.mapping.time_rule,
        str(read_json(task.input("probe") / "video.json")["average_rate"]),
    )
    task.report(0, 4, "placing detections")

    def read_model(indices: Sequence[int]) -> SparseModel:
        return read_sparse_model(model_dir, indices)

    placements = place_detections(detections, frames, crop, task.settings.mapping, read_model)
    task.report(1, 4, "reading the surface")
    mesh = read_mesh(task.input("mesh") / "mesh_poisson.ply")
    task.report(2, 4, "colouring the surface")
    unique = _write_coloring(task, mesh, placements)
    write_json(task.out / "detections.json", [placement.row.to_dict() for placement in placements])
    task.report(4, 4, "detections placed")
    return StageResult(_facts(placements, unique))


def _write_coloring(task: StageTask, mesh: Mesh, placements: Sequence[Placement]) -> int:
    """Write support points and vertex weights; gives the number of distinct support points."""
    settings = task.settings.mapping
    ordered = sorted((p for p in placements if len(p.point_ids)), key=lambda p: (p.row.time_s, p.row.id))
    owner = _concatenate([np.full(len(p.point_ids), p.row.id, np.int32) for p in ordered], np.int32)
    point_ids = _concatenate([p.point_ids for p in ordered], np.int64)
    positions = np.concatenate([p.positions for p in ordered]) if ordered else np.zeros((0, 3))
    # A point in several boxes is coloured for the first of them in time.
    _, first = np.unique(point_ids, return_index=True)
    radius = coloring_radius(mesh.diagonal, settings.radius_fraction)
    sigma = settings.sigma_fraction * radius
    coloring = vertex_weights(mesh.vertices, positions[first], radius, sigma, task.threads)
    strongest = np.full(len(mesh.vertices), -1, np.int32)
    near = coloring.point >= 0
    strongest[near] = owner[first][coloring.point[near]]
    np.savez(task.out / "coloring.npz", weight=coloring.weight, detection=strongest)
    np.savez(task.out / "support.npz", detection=owner, point_id=point_ids, position=positions)
    return _write_support_points(task, owner, point_ids, positions)


def _write_support_points(
    task: StageTask, owner: NDArray[np.int64], point_ids: NDArray[np.int64], positions: NDArray[np.float64]
) -> int:
    """Write the cloud of distinct support points, each with the first detection that has it; gives their number."""
    _, first = np.unique(point_ids, return_index=True)
    red = np.tile(np.array([[255, 0, 0]], np.uint8), (len(first), 1))
    cloud = Mesh(positions[first], colors=red, extra={"detection": owner[first].astype(np.int32)})
    write_cloud(task.out / "defect_points.ply", cloud, world_comments(task))
    return len(first)


def _concatenate(parts: Sequence[NDArray[np.int64]] | Sequence[NDArray[np.int32]], dtype: type) -> NDArray[np.int64]:
    joined: NDArray[np.int64] = np.concatenate(parts) if parts else np.zeros(0, dtype)
    return joined


def _facts(placements: Sequence[Placement] | Sequence[Observation], unique: int) -> Facts:
    counts = [placement.row.support_points for placement in placements if placement.row.outcome == Outcome.MAPPED]
    return {
        "n_detections": len(placements),
        **outcome_counts([placement.row for placement in placements]),
        "support_min": min(counts, default=None),
        "support_mean": round(sum(counts) / len(counts), 4) if counts else None,
        "support_max": max(counts, default=None),
        "unique_support_points": unique,
    }
