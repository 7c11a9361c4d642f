"""Stage `timeline`: placed detections grouped into events and defects, drawn on the surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from core.flags import Severity
from core.json_files import read_json, write_json
from core.mapping.coloring import blend
from core.mapping.rows import DetectionRow
from core.mapping.support import open_model
from core.stage import StageResult, StageTask
from core.stages.map_defects import open_scene_of, world_comments
from core.surface.glb import vertex_normals, write_glb
from core.surface.ply import Mesh, read_mesh, write_mesh
from core.task_key import key_of
from core.timeline.clusters import Cluster, cluster_detections, cluster_radius
from core.timeline.events import defect_of_detection, defect_records, event_rows, with_defect_ids
from core.timeline.numbering import Start
from core.timeline.surface import F64, I32, defect_of_vertices, faces_of_defects, mean_normal, sample_points
from core.timeline.visibility import Occlusion, Sighting, View, sightings, views_of_model


def run(task: StageTask) -> StageResult:
    """Tell defects apart by the rules that `mapping.method` names; write tables and coloured surfaces.

    Writes the files that docs/stage-results.md names. Facts: n_events, n_defects, and what the rules count.
    """
    by_surface = task.settings.mapping.method == "surface"
    mesh = read_mesh(task.input("mesh") / "mesh_poisson.ply")
    colored, facts = _by_surface(task, mesh) if by_surface else _by_clusters(task, mesh)
    task.report(3, 4, "writing the coloured surface")
    write_mesh(task.out / "mesh_defects.ply", colored, world_comments(task))
    write_glb(task.out / "mesh_defects.glb", colored)
    _write_cameras(task, views_of_model(open_model(task.input("extend") / "model")))
    task.report(4, 4, "timeline written")
    return StageResult(facts)


def _by_surface(task: StageTask, mesh: Mesh) -> tuple[Mesh, dict[str, Any]]:
    """Instances, visits and confidences."""
    # Loaded here: the thesis's rules need no ray caster beyond the one for sight lines.
    from core.mapping.store import parts_rows, read_observations
    from core.timeline import defects
    from core.timeline.paint import paint_defects

    observations = read_observations(task.input("map_defects"))
    scene, times = open_scene_of(task)
    task.report(1, 4, "telling defects apart")
    found = defects.find_defects(observations, scene, times.time_of_index, _doubts(task))
    events = defects.event_rows(found, times.time_of_index)
    task.report(2, 4, "colouring the surface")
    weight, vertex_defect = paint_defects(mesh, found, task.settings.mapping, task.threads)
    faces = [own.tolist() for own in faces_of_defects(mesh.faces, vertex_defect, len(found.defects))]
    start = Start.after(task.facts, task.piece)
    records = defects.defect_records(found, events, faces, scene.model)
    write_json(task.out / "timeline.json", [event.to_dict() for event in start.events(events)])
    write_json(task.out / "detections.json", [row.to_dict() for row in start.rows(defects.final_rows(found))])
    write_json(task.out / "defects.json", start.records(records))
    write_json(task.out / "confidence.json", parts_rows(found.observations))
    colored = replace(
        mesh, colors=blend(mesh.colors, weight), extra={**mesh.extra, "defect_id": start.vertices(vertex_defect)}
    )
    return colored, {
        "n_events": len(events),
        "n_defects": len(found.defects),
        "n_unconfirmed": found.unconfirmed,
    }


def _doubts(task: StageTask) -> int:
    """Warnings of the checks about the model that the places lie on."""
    checks = task.facts.get(key_of("extend", task.piece), {}).get("checks", ())
    return len({check["code"] for check in checks if check["severity"] != Severity.INFO})


def _by_clusters(task: StageTask, mesh: Mesh) -> tuple[Mesh, dict[str, Any]]:
    """Equation 3.3: one cluster is one event and one defect."""
    mapping = task.input("map_defects")
    rows = [DetectionRow(**row) for row in read_json(mapping / "detections.json")]
    task.report(1, 4, "grouping detections")
    radius = cluster_radius(mesh.diagonal, task.settings.timeline.radius_fraction)
    clusters = cluster_detections(rows, radius)
    with np.load(mapping / "coloring.npz") as coloring:
        weight, detection = coloring["weight"], coloring["detection"]
    vertex_defect = defect_of_vertices(detection, defect_of_detection(clusters))
    events = event_rows(clusters)
    write_json(task.out / "timeline.json", [event.to_dict() for event in events])
    write_json(task.out / "detections.json", [row.to_dict() for row in with_defect_ids(rows, clusters)])
    write_json(task.out / "confidence.json", [])
    task.report(2, 4, "finding the views of every defect")
    _write_defects(task, clusters, mesh, vertex_defect, weight)
    colored = replace(mesh, colors=blend(mesh.colors, weight), extra={**mesh.extra, "defect_id": vertex_defect})
    return colored, {"n_events": len(events), "n_defects": len(clusters), "cluster_radius_su": radius}


def _write_defects(
    task: StageTask, clusters: Sequence[Cluster], mesh: Mesh, vertex_defect: I32, weight: np.ndarray
) -> None:
    with np.load(task.input("map_defects") / "support.npz") as support:
        owner, position = support["detection"], support["position"]
    supports: dict[int, F64] = {int(i): position[owner == i] for i in np.unique(owner)}
    views = views_of_model(open_model(task.input("extend") / "model"))
    normals = vertex_normals(mesh)
    occlusion = Occlusion(mesh.vertices, mesh.faces)
    tolerance = task.settings.timeline.occlusion_fraction * mesh.diagonal
    seen: list[list[Sighting]] = []
    for number, cluster in enumerate(clusters):
        points = sample_points(np.concatenate([supports[row.id] for row in cluster.rows]))
        normal = mean_normal(normals, vertex_defect, weight, number)
        seen.append(sightings(points, normal, views, occlusion, tolerance))
        task.report(2 + (number + 1) / len(clusters), 4, "finding the views of every defect")
    faces = [own.tolist() for own in faces_of_defects(mesh.faces, vertex_defect, len(clusters))]
    write_json(task.out / "defects.json", defect_records(clusters, supports, seen, faces))


def _write_cameras(task: StageTask, views: Sequence[View]) -> None:
    """Poses of the registered images, for choosing where to look at the surface from."""
    poses = np.array([view.cam_from_world for view in views]).reshape(-1, 3, 4)
    np.savez(task.out / "cameras.npz", frame_index=[view.frame_index for view in views], cam_from_world=poses)
