"""Stage `timeline`: placed detections grouped into events and defects, drawn on the surface."""

from __future__ import annotations

from dataclasses import replace

from core.flags import Severity
from core.io.annotations import read_detections, write_rows
from core.io.sparse import read_model, write_cameras
from core.io.surface import defect_glb, defect_mesh, supported_mesh
from core.io.timeline import write_timeline
from core.json_files import JsonObject, write_json
from core.mapping.coloring import blend
from core.mapping.facing import oriented
from core.measure.scale import find_scale
from core.outputs import ROW, ROW_MAP
from core.products.search import ExtendProduct
from core.products.surface import TimelineProduct
from core.row.files import read_blades, read_on_first
from core.row.map import row_map
from core.row.model import BladeRow, NoRow, UnknownRow
from core.row.places import blades_of_vertices
from core.row.tables import RowOfModel, events_on_row, row_document, scale_of_row
from core.scene.methods import Grouped, Grouping
from core.scene.views import Views, views_of
from core.stage import StageTask
from core.stages.map_defects import open_scene_of, world_comments
from core.surface.colored_glb import write_glb
from core.surface.ply import Mesh, read_mesh, write_mesh
from core.task_key import key_of
from core.thesis.grouping import ThesisGrouping
from core.timeline.grouping import Start, SurfaceGrouping


def run(task: StageTask) -> TimelineProduct:
    """Tell defects apart by the rules that `mapping.method` names; write tables and coloured surfaces.

    Writes the files that docs/stage-results.md names.
    """
    mesh = read_mesh(supported_mesh(task.input("mesh")))
    views = views_of(read_model(task.input("extend")))
    row, on_first = _row(task)
    grouping = _grouping(task, mesh, views, row)
    found = grouping.group()
    extra = {**mesh.extra, "defect_id": found.vertex_defect}
    findings: list[JsonObject] = []
    if isinstance(row, BladeRow):
        task.report(3, 4, "finding the blades of the defects")
        # The rules of the thesis open no scene, in which the surface has been turned towards the cameras before.
        facing = grouping.scene.mesh if isinstance(grouping, SurfaceGrouping) else oriented(mesh, views)
        found, findings = _on_row(found, RowOfModel(row, facing, views, task.submodel, found.scale, on_first))
        extra["blade"] = blades_of_vertices(row, mesh)
    document = row_document(row, findings, found.scale, on_first)
    write_json(task.out / ROW, document)
    (task.out / ROW_MAP).write_text(row_map(document), encoding="utf-8")
    write_timeline(task.out, found.events, found.defects, found.confidences)
    write_rows(task.out, found.rows)
    task.report(3, 4, "writing the coloured surface")
    colored = replace(mesh, colors=blend(mesh.colors, found.weight), extra=extra)
    write_mesh(defect_mesh(task.out), colored, world_comments(task))
    write_glb(defect_glb(task.out), colored, found.scale)
    write_cameras(task.out, views)
    task.report(4, 4, "timeline written")
    return found.product


def _row(task: StageTask) -> tuple[BladeRow | NoRow, JsonObject | None]:
    """The row of the model, and how that of a further one lies on the first's."""
    if not task.has("blades"):
        return NoRow(UnknownRow.NOT_COMPUTED), None
    return read_blades(task.input("blades")), read_on_first(task.input("blades"))


def _on_row(found: Grouped[TimelineProduct], where: RowOfModel) -> tuple[Grouped[TimelineProduct], list[JsonObject]]:
    """What was found with the columns of the row, and the findings of ``row.json``."""
    sigmas = {int(one["id"]): one["position_sigma"] for one in found.confidences}
    records, findings = where.records(found.defects)
    rows, events = where.detections(found.rows, sigmas), events_on_row(found.events, records)
    return replace(found, rows=tuple(rows), events=tuple(events), defects=tuple(records)), findings


def _grouping(task: StageTask, mesh: Mesh, views: Views, row: BladeRow | NoRow) -> Grouping[TimelineProduct]:
    placed = task.input("map_defects")
    if task.settings.mapping.method == "thesis":
        return ThesisGrouping(placed, mesh, views, task.settings.timeline, task.report)
    scene, frames = open_scene_of(task)
    start = Start.after(task.products, task.submodel)
    detections = {one.id: one for one in read_detections(task.input("annotations"))}
    of_row = scale_of_row(row, task.settings.row)
    scale = find_scale(task.settings.scale, scene, frames, [] if of_row is None else [of_row])
    n_warnings, settings = _warnings(task), task.settings.mapping
    return SurfaceGrouping(
        placed, detections, scale, scene, frames, mesh, n_warnings, start, settings, task.threads, task.report
    )


def _warnings(task: StageTask) -> int:
    """Warnings of the checks about the model that the places lie on."""
    checks = task.products.of(ExtendProduct, key_of("extend", task.submodel)).checks
    return len({check.code for check in checks if check.severity != Severity.INFO})
