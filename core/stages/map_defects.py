"""Stage `map_defects`: every detection placed on the surface by the thesis's rules, one row each."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.mapping.coloring import coloring_radius, vertex_weights
from core.mapping.rows import Detection, outcome_counts
from core.mapping.support import SparseModel, read_sparse_model
from core.mapping.thesis import FrameTimes, Placement, place_detections
from core.report.tables import read_json, write_json
from core.roi import Crop
from core.stage import Facts, StageResult, StageTask
from core.surface.ply import Mesh, read_mesh, write_cloud

WORLD_COMMENTS = ("world frame of sparse model 0 (COLMAP)", "unit: model")


def run(task: StageTask) -> StageResult:
    """Place all detections and find each vertex's strongest influence (equations 3.1 and 3.2).

    Writes the files that docs/stage-results.md names. Facts: counts by outcome and reason, support counts.
    """
    frames_dir, model_dir = task.input("frames"), task.input("extend") / "model"
    detections = [Detection.from_json(row) for row in read_json(task.input("annotations") / "detections.json")]
    frames = FrameTimes.from_rows(
        read_json(frames_dir / "frames.json"),
        read_json(task.input("extend") / "registered.json"),
        task.settings.mapping.time_rule,
        str(read_json(task.input("probe") / "video.json")["average_rate"]),
    )
    crop = Crop(**read_json(frames_dir / "crop.json"))
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
    red = np.tile(np.array([[255, 0, 0]], np.uint8), (len(first), 1))
    cloud = Mesh(positions[first], colors=red, extra={"detection": owner[first]})
    write_cloud(task.out / "defect_points.ply", cloud, WORLD_COMMENTS)
    return len(first)


def _concatenate(parts: Sequence[NDArray[np.int64]] | Sequence[NDArray[np.int32]], dtype: type) -> NDArray[np.int64]:
    joined: NDArray[np.int64] = np.concatenate(parts) if parts else np.zeros(0, dtype)
    return joined


def _facts(placements: Sequence[Placement], unique: int) -> Facts:
    counts = [len(placement.point_ids) for placement in placements if placement.row.outcome == "mapped"]
    return {
        "n_detections": len(placements),
        **outcome_counts([placement.row for placement in placements]),
        "support_min": min(counts, default=None),
        "support_mean": round(sum(counts) / len(counts), 4) if counts else None,
        "support_max": max(counts, default=None),
        "unique_support_points": unique,
    }
