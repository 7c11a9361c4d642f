"""The row of a published result, computed from its files alone and written back into them.

Results of earlier releases have no row; surface, model and tables are all that it needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from core.errors import BadInput
from core.flags import Flag, Verdict, in_order, verdict_by
from core.io.sparse import open_model
from core.json_files import JsonObject, read_json, replace_file, write_json
from core.mapping.scene import oriented
from core.outputs import (
    CONFIDENCE,
    DEFECT_SURFACE,
    DEFECTS,
    DETECTIONS,
    QUALITY,
    ROW,
    ROW_MAP,
    SPARSE,
    SUMMARY,
    SURFACE,
    TIMELINE,
    model_folder,
    model_numbers,
)
from core.report.tables import write_csv
from core.row.estimate import UNTOLD, estimate_row
from core.row.map import row_map
from core.row.model import BladeRow, NoRow, UnknownRow
from core.row.places import blades_of_vertices
from core.row.tables import RowOfModel, events_on_row
from core.scene.defect import DefectRecord, EventRow
from core.scene.detection import DetectionRow
from core.scene.on_row import NOT_ON_A_ROW, ROW_COLUMNS
from core.scene.size import Scale
from core.scene.views import views_of
from core.settings.row import RowSettings
from core.surface.ply import read_mesh, write_mesh

SEED = 0
_WRITTEN = ("blade", *ROW_COLUMNS)

Rows = list[JsonObject]
"""Objects of a published JSON table; older releases have fewer members, and those that are not known stay."""


def write_row(folder: Path, told: RowSettings = UNTOLD) -> BladeRow | NoRow:
    """Find the row of every model of a result, and write ``row.json`` and the columns of the row.

    Every file is replaced at once, ``row.json`` last. Nothing else of the tables changes, and no defect's id. The
    coloured surface gets the vertex property `blade`.

    Args:
        folder: of a published result.
        told: what the user knows of the row.

    Returns:
        The row of the first model.

    Raises:
        BadInput: the folder is no result.
    """
    if not (folder / SUMMARY).is_file():
        raise BadInput(f"{folder.name} is no result: it has no {SUMMARY}", where=str(folder))
    if told.radius_mm is not None:
        detail = "a radius changes every size: run the inspection again with it, which computes what depends on it"
        raise BadInput(detail, where="row.radius_mm")
    scale = Scale.from_dict(read_json(folder / SUMMARY).get("scale") or {})
    rows, records, events = _read(folder / DETECTIONS), _read(folder / DEFECTS), _read(folder / TIMELINE)
    detections = [DetectionRow.from_dict(row) for row in rows]
    defects = [DefectRecord.from_dict(record) for record in records]
    documents: dict[int, JsonObject] = {}
    found: dict[int, BladeRow | NoRow] = {}
    for number in model_numbers(folder):
        where = _row_of(model_folder(folder, number), number, scale, told)
        own = [one for one in defects if one.model == number]
        findings: Rows = []
        if isinstance(where, RowOfModel):
            detections = where.detections(detections, _sigmas(model_folder(folder, number) / CONFIDENCE))
            own, findings = where.records(own)
        else:
            detections = [_without(row) if row.model == number else row for row in detections]
            own = [replace(record, blade=None, on_row=NOT_ON_A_ROW) for record in own]
        defects = [next((new for new in own if new.id == old.id), old) for old in defects]
        found[number] = where.row if isinstance(where, RowOfModel) else where
        documents[number] = {**found[number].to_dict(), "findings": findings}
    _write(folder / DETECTIONS, _changed(rows, detections))
    visits = [EventRow.from_dict(event) for event in events]
    _write(folder / TIMELINE, _changed(events, events_on_row(visits, defects), ("blade",)))
    if records:
        changed = _changed(records, defects)
        replace_file(folder / DEFECTS, lambda path: write_json(path, changed))
    _flag(folder, {number: row.flags for number, row in found.items() if isinstance(row, NoRow)})
    for number in sorted(found, reverse=True):
        _write_row(model_folder(folder, number), documents[number])
    return found[0]


def _flag(folder: Path, flags: Mapping[int, Sequence[Flag]]) -> None:
    """Put the flags of the row in place of those that quality.json has of it, and the verdict where it changes."""
    if not (folder / QUALITY).is_file():
        return
    quality: JsonObject = read_json(folder / QUALITY)
    kept = [flag for flag in quality["flags"] if flag["code"] != "row_irregular"]
    new = [flag.of_model(number) for number in sorted(flags) for flag in flags[number]]
    if not new and kept == quality["flags"]:
        return
    flags_now = in_order([*(Flag.from_dict(flag) for flag in kept), *new])
    shown = [{**flag.to_dict(), "meaning": flag.meaning} for flag in flags_now]
    verdict = Verdict(quality["verdict"])
    if verdict != Verdict.REFUSED:
        verdict = verdict_by(flags_now)
    replace_file(folder / QUALITY, lambda path: write_json(path, {**quality, "verdict": verdict, "flags": shown}))
    summary = read_json(folder / SUMMARY)
    replace_file(folder / SUMMARY, lambda path: write_json(path, {**summary, "verdict": verdict}))


def _write_row(folder: Path, document: JsonObject) -> None:
    replace_file(folder / ROW_MAP, lambda path: path.write_text(row_map(document), encoding="utf-8"))
    replace_file(folder / ROW, lambda path: write_json(path, document))


def _row_of(folder: Path, model: int, scale: Scale | None, told: RowSettings) -> RowOfModel | NoRow:
    """The row of one model of a result, by the files below its folder; writes the blades of its coloured surface."""
    if not (folder / SURFACE).is_file() or not (folder / SPARSE).is_dir():
        return NoRow(UnknownRow.NO_SURFACE)
    views = views_of(open_model(folder / SPARSE))
    mesh = oriented(read_mesh(folder / SURFACE), views)
    row = estimate_row(mesh, views, SEED, told)
    if isinstance(row, NoRow):
        return row
    if (folder / DEFECT_SURFACE).is_file():
        colored = read_mesh(folder / DEFECT_SURFACE)
        extra = {**colored.extra, "blade": blades_of_vertices(row, colored)}
        replace_file(
            folder / DEFECT_SURFACE, lambda path: write_mesh(path, replace(colored, extra=extra), colored.comments)
        )
    return RowOfModel(row, mesh, views, model, scale)


def _without(row: DetectionRow) -> DetectionRow:
    return replace(row, blade=None, on_row=NOT_ON_A_ROW)


def _sigmas(path: Path) -> dict[int, float | None]:
    """Standard deviation of the place of every placed detection, model units."""
    return {row["id"]: row["position_sigma"] for row in read_json(path)} if path.is_file() else {}


def _changed(
    rows: Rows, typed: Iterable[DetectionRow | DefectRecord | EventRow], names: tuple[str, ...] = _WRITTEN
) -> Rows:
    """The objects with the columns of the row, and the unit of these where they have none."""
    changed = []
    for row, new in zip(rows, typed, strict=True):
        values: Mapping[str, object] = new.to_dict()
        unit = {"length_unit": values["length_unit"]} if values.get("root_distance") is not None else {}
        changed.append({**row, **{name: values[name] for name in names}, **unit})
    return changed


def _write(path: Path, rows: Rows) -> None:
    """A table in both its forms; one without rows stays."""
    if rows:
        replace_file(path, lambda beside: write_json(beside, rows))
        replace_file(path.with_suffix(".csv"), lambda beside: write_csv(beside, list(rows[0]), rows))


def _read(path: Path) -> Rows:
    try:
        rows: Rows = read_json(path)
    except FileNotFoundError:
        return []
    return rows
