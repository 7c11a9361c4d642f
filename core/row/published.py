"""The row of a published result, computed from its files alone and written back into them.

Results of earlier releases have no row; surface, model and tables are all that it needs.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from core.errors import BadInput
from core.io.sparse import open_model
from core.json_files import JsonObject, write_json
from core.mapping.scene import oriented
from core.outputs import DEFECTS, DETECTIONS, ROW, SPARSE, SUMMARY, SURFACE, model_folder, model_numbers
from core.report.tables import write_csv
from core.row.estimate import estimate_row
from core.row.model import BladeRow, NoRow, UnknownRow
from core.row.places import on_row
from core.scene.views import views_of
from core.surface.ply import read_mesh

SEED = 0

Rows = list[JsonObject]
"""Objects of a published JSON table; older releases have fewer members, and those that are not known stay."""


def write_row(folder: Path, count: int | None = None) -> BladeRow | NoRow:
    """Find the row of every model of a result, and write ``row.json`` and the column `blade`.

    Every file is replaced at once, ``row.json`` last. Nothing else of the tables changes, and no defect's id.

    Args:
        folder: of a published result.
        count: blades in the whole row, when the user tells it.

    Returns:
        The row of the first model.

    Raises:
        BadInput: the folder is no result.
    """
    if not (folder / SUMMARY).is_file():
        raise BadInput(f"{folder.name} is no result: it has no {SUMMARY}", where=str(folder))
    found = {number: row_of(model_folder(folder, number), count) for number in model_numbers(folder)}
    detections = _read(folder / DETECTIONS)
    for one in detections:
        one["blade"] = _blade(found, one.get("model"), (one["x"], one["y"], one["z"]))
    records = _read(folder / DEFECTS)
    findings: dict[int, Rows] = {number: [] for number in found}
    for record in records:
        model = int(record.get("model") or 0)
        record["blade"] = None
        row = found.get(model)
        if isinstance(row, BladeRow):
            place = on_row(row, record["centroid"], record.get("normal"), record.get("centroid_sigma"))
            record["blade"] = blade_name(place.blade, model)
            findings[model].append({"defect": record["id"], **place.to_dict()})
    if detections:
        _replace(folder / DETECTIONS, lambda path: write_json(path, detections))
        _replace(
            (folder / DETECTIONS).with_suffix(".csv"), lambda path: write_csv(path, list(detections[0]), detections)
        )
    if records:
        _replace(folder / DEFECTS, lambda path: write_json(path, records))
    for number in sorted(found, reverse=True):
        document = {**found[number].to_dict(), "findings": findings[number]}
        _replace(model_folder(folder, number) / ROW, lambda path, value=document: write_json(path, value))  # type: ignore[misc]
    return found[0]


def row_of(folder: Path, count: int | None = None) -> BladeRow | NoRow:
    """The row of one model of a result, by the files below its folder."""
    if not (folder / SURFACE).is_file() or not (folder / SPARSE).is_dir():
        return NoRow(UnknownRow.NO_SURFACE)
    views = views_of(open_model(folder / SPARSE))
    return estimate_row(oriented(read_mesh(folder / SURFACE), views), views, SEED, count)


def blade_name(number: int | None, model: int) -> str | None:
    """A blade as the column names it: of further models, whose offset is not known, with the model's number."""
    if number is None:
        return None
    return f"{model}-B{number}" if model else str(number)


def _blade(found: Mapping[int, BladeRow | NoRow], model: int | None, place: Sequence[float | None]) -> str | None:
    known = [float(value) for value in place if value is not None]
    row = found.get(int(model or 0))
    if len(known) < 3 or not isinstance(row, BladeRow):
        return None
    return blade_name(on_row(row, known, None, None).blade, int(model or 0))


def _read(path: Path) -> Rows:
    try:
        rows: Rows = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return []
    return rows


def _replace(path: Path, write: Callable[[Path], None]) -> None:
    """Write beside the file and put it in its place at once."""
    beside = path.with_name(f".{path.name}.new")
    write(beside)
    os.replace(beside, path)
