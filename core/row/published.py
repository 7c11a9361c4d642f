"""The row of a published result, computed from its files alone and written back into them.

Results of earlier releases have no row; surface, model and tables are all that it needs.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from core.errors import BadInput
from core.flags import Flag, Verdict, frames_between, in_order, verdict_by
from core.json_files import JsonObject, read_json, replace_file, write_json
from core.mapping.facing import read_surface
from core.outputs import (
    CONFIDENCE,
    DEFECT_GLB,
    DEFECT_SURFACE,
    DEFECTS,
    DETECTIONS,
    FRAMES,
    LIMITS,
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
from core.report.csv_form import read_csv
from core.report.limits import limits_document, limits_of
from core.report.tables import write_csv
from core.row.estimate import UNTOLD, estimate_row, without_leap
from core.row.map import row_map
from core.row.model import BladeRow, NoRow, UnknownRow
from core.row.on_first import ModelOfRow, NotOnFirst, OnFirst, of_further, put_on_first
from core.row.places import blades_of_vertices
from core.row.rescaled import MEASURED, ChangeOfScale, changed_scale, scale_of_model
from core.row.tables import RowOfModel, events_on_row, row_document, scale_of_row
from core.scene.defect import DefectRecord, EventRow
from core.scene.detection import DetectionRow
from core.scene.on_row import NOT_ON_A_ROW, ROW_COLUMNS
from core.scene.size import Scale
from core.settings.limits import Limit
from core.settings.row import RowSettings
from core.surface.colored_glb import write_glb
from core.surface.ply import read_mesh, write_mesh
from core.videos import moment

SEED = 0
_WRITTEN = ("blade", *ROW_COLUMNS)

Rows = list[JsonObject]
"""Objects of a published JSON table; older releases have fewer members, and those that are not known stay."""


def write_row(folder: Path, told: RowSettings = UNTOLD, limits: Sequence[Limit] | None = None) -> BladeRow | NoRow:
    """Find the row of every model of a result, and write ``row.json`` and the columns of the row.

    Rows of further models are put onto that of the first.

    Every file is replaced at once, ``row.json`` last. Nothing else of the tables changes, and no defect's id. The
    coloured surface gets the vertex property `blade`. A radius that is told gives a scale: then lengths and areas of
    the tables are in mm, and the GLB is in metres. Without one, the scale that the result has stays.

    Args:
        folder: of a published result.
        told: what the user knows of the row.
        limits: of the shop; None = those that the result was compared with, if any.

    Returns:
        The row of the first model.

    Raises:
        BadInput: the folder is no result, or its scale cannot be told from a radius that is in it already.
    """
    if not (folder / SUMMARY).is_file():
        raise BadInput(f"{folder.name} is no result: it has no {SUMMARY}", where=str(folder))
    rows, records, events = _read(folder / DETECTIONS), _read(folder / DEFECTS), _read(folder / TIMELINE)
    detections = [DetectionRow.from_dict(row) for row in rows]
    defects = [DefectRecord.from_dict(record) for record in records]
    documents: dict[int, JsonObject] = {}
    found: dict[int, BladeRow | NoRow] = {}
    flags: dict[int, Sequence[Flag]] = {}
    first: ModelOfRow | None = None
    moments_s, jumps = _moments(folder / FRAMES), _jumps(folder / QUALITY)
    for number in model_numbers(folder):
        below = model_folder(folder, number)
        one = _row_of(below, number, told, scale_of_model(folder, number), first, moments_s, jumps)
        if number == 0:
            first = one.shown
        where, change = one.where, one.change
        own = [change.record(record) for record in defects if record.model == number]
        detections = [change.detection(row) if row.model == number else row for row in detections]
        findings: Rows = []
        if isinstance(where, RowOfModel):
            detections = where.detections(detections, _sigmas(below / CONFIDENCE))
            own, findings = where.records(own)
        else:
            detections = [_without(row) if row.model == number else row for row in detections]
            own = [replace(record, blade=None, on_row=NOT_ON_A_ROW) for record in own]
        defects = [next((new for new in own if new.id == old.id), old) for old in defects]
        found[number] = where.row if isinstance(where, RowOfModel) else where
        flags[number] = [*change.flags, *(where.flags if isinstance(where, NoRow) else ())]
        documents[number] = row_document(found[number], findings, change.new, one.on_first)
    names = (*_WRITTEN, *MEASURED)
    _write(folder / DETECTIONS, _changed(rows, detections, names))
    visits = [EventRow.from_dict(event) for event in events]
    _write(folder / TIMELINE, _changed(events, events_on_row(visits, defects), ("blade",)))
    if records:
        changed = _changed(records, defects, (*names, "size_sigma"))
        replace_file(folder / DEFECTS, lambda path: write_json(path, changed))
    _write_scale(folder, documents[0]["scale"])
    _compare(folder, limits, defects)
    _flag(folder, flags, told.radius_mm is not None)
    for number in sorted(found, reverse=True):
        _write_row(model_folder(folder, number), documents[number])
    return found[0]


def _flag(folder: Path, flags: Mapping[int, Sequence[Flag]], scaled: bool = False) -> None:
    """Put the flags of the row, and of a new scale, in place of the old ones, and the verdict where it changes."""
    if not (folder / QUALITY).is_file():
        return
    quality: JsonObject = read_json(folder / QUALITY)
    replaced = ("row_irregular", "scale_disagrees") if scaled else ("row_irregular",)
    kept = [flag for flag in quality["flags"] if flag["code"] not in replaced]
    new = [flag.of_model(number) for number in sorted(flags) for flag in flags[number]]
    if not new and kept == quality["flags"]:
        return
    flags_now = in_order([*(Flag.from_dict(flag) for flag in kept), *new])
    shown = [flag.explained() for flag in flags_now]
    verdict = Verdict(quality["verdict"])
    if verdict != Verdict.REFUSED:
        verdict = verdict_by(flags_now)
    replace_file(folder / QUALITY, lambda path: write_json(path, {**quality, "verdict": verdict, "flags": shown}))
    summary = read_json(folder / SUMMARY)
    replace_file(folder / SUMMARY, lambda path: write_json(path, {**summary, "verdict": verdict}))


def _write_row(folder: Path, document: JsonObject) -> None:
    replace_file(folder / ROW_MAP, lambda path: path.write_text(row_map(document), encoding="utf-8"))
    replace_file(folder / ROW, lambda path: write_json(path, document))


def _write_scale(folder: Path, scale: JsonObject) -> None:
    """Put the scale of the first model into the summary, where it is another one."""
    summary = read_json(folder / SUMMARY)
    if Scale.from_dict(summary.get("scale") or {}) != Scale.from_dict(scale):
        replace_file(folder / SUMMARY, lambda path: write_json(path, {**summary, "scale": scale}))


def _compare(folder: Path, limits: Sequence[Limit] | None, defects: Sequence[DefectRecord]) -> None:
    """Write the comparison with the limits of the shop, those told or else those that the result has."""
    path = folder / LIMITS
    if limits is None and path.is_file():
        limits = limits_of(read_json(path))
    if limits is not None:
        compared = limits_document(limits, defects)
        replace_file(path, lambda beside: write_json(beside, compared))


@dataclass(frozen=True)
class _Found:
    """What was found of one model."""

    where: RowOfModel | NoRow
    change: ChangeOfScale
    shown: ModelOfRow | None = None
    """None without a surface."""
    on_first: JsonObject | None = None
    """Of a further model."""


def _row_of(
    folder: Path,
    model: int,
    told: RowSettings,
    old: Scale | None,
    first: ModelOfRow | None,
    moments_s: Mapping[int, float],
    jumps: Sequence[tuple[int, int]],
) -> _Found:
    """The row of one model of a result, by the files below its folder, and its scale before and now.

    Writes the blades of its coloured surface, and the GLB of that.
    """
    same = ChangeOfScale(old, old)
    on_first = OnFirst({}, NotOnFirst.NO_ROW)
    if not (folder / SURFACE).is_file() or not (folder / SPARSE).is_dir():
        return _Found(NoRow(UnknownRow.NO_SURFACE), same, on_first=on_first.to_dict() if model else None)
    mesh, views = read_surface(folder / SPARSE, folder / SURFACE)
    row = estimate_row(mesh, views, SEED, of_further(told) if model else told)
    if isinstance(row, BladeRow):
        row = without_leap(row, views, moments_s, jumps)
    shown = ModelOfRow(row, mesh, views, SEED)
    if first is not None:
        row, on_first = put_on_first(first, shown, model, moments_s, told, jumps)
    laid = on_first.to_dict() if model else None
    if isinstance(row, NoRow):
        return _Found(row, same, shown, laid)
    change = changed_scale(old, scale_of_row(row, told))
    if (folder / DEFECT_SURFACE).is_file():
        colored = read_mesh(folder / DEFECT_SURFACE)
        on_row = replace(colored, extra={**colored.extra, "blade": blades_of_vertices(row, colored)})
        replace_file(folder / DEFECT_SURFACE, lambda path: write_mesh(path, on_row, colored.comments))
        replace_file(folder / DEFECT_GLB, lambda path: write_glb(path, on_row, change.new))
    return _Found(RowOfModel(row, mesh, views, model, change.new, laid), change, shown, laid)


def _moments(path: Path) -> dict[int, float]:
    """Moment of each frame on the one axis of all videos, s; none where the result has no table of frames."""
    if not path.is_file():
        return {}
    rows = read_csv(path)
    return {int(row["index"]): moment(int(row.get("video") or 0), float(row["time_s"])) for row in rows}


def _jumps(path: Path) -> list[tuple[int, int]]:
    """Neighbouring frames between which the pictures jump, as the flags of the result name them."""
    flags = read_json(path)["flags"] if path.is_file() else []
    named = [frames_between(flag.get("where") or "") for flag in flags if flag["code"] == "picture_jumps"]
    return [frames for frames in named if frames is not None]


def _without(row: DetectionRow) -> DetectionRow:
    return replace(row, blade=None, on_row=NOT_ON_A_ROW)


def _sigmas(path: Path) -> dict[int, float | None]:
    """Standard deviation of the place of every placed detection, model units."""
    return {row["id"]: row["position_sigma"] for row in read_json(path)} if path.is_file() else {}


def _changed(
    rows: Rows, typed: Iterable[DetectionRow | DefectRecord | EventRow], names: tuple[str, ...] = _WRITTEN
) -> Rows:
    """The objects with the columns of the row and those others of `names` that they have, and the unit of lengths."""
    changed = []
    for row, new in zip(rows, typed, strict=True):
        values: Mapping[str, object] = new.to_dict()
        unit = {"length_unit": values["length_unit"]} if values.get("root_distance") is not None else {}
        kept = {name: values[name] for name in names if name in values and (name in row or name in _WRITTEN)}
        changed.append({**row, **kept, **unit})
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
