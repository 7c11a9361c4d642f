"""Without a scale no millimetre stands anywhere: not in CSV, JSON, GLB, maps, the page or the report."""

from __future__ import annotations

import csv
import json
import re
import shutil
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from core.inspection_report.document import Shown
from core.inspection_report.forms import Form
from core.json_files import read_json, write_json
from core.report.limits import limits_document
from core.scene.defect import DefectRecord
from core.scene.size import Measure, Scale, Size, scale_fields
from core.settings.limits import parse_limits
from core.surface.colored_glb import write_glb
from tests.core.inspection_report.making_reports import form_of, text_of
from tests.core.making_results import RESULTS
from tests.core.test_mapping_stages import plane

LENGTH = re.compile(r"\bmm\b|\bmm²|± [\d.e+-]+ in\b")
"""A length that claims a unit."""
LIMITS = "zone,length_mm\nany,1\n"
SCALE = Scale(2.0, 0.1, "points")


def result(folder: Path, scale: Scale | None) -> Path:
    """A committed result whose findings have sizes, compared with limits, in units of the model or in mm."""
    shutil.copytree(RESULTS / "two_models", folder)
    path = folder / "mapping" / "defects.json"
    size = Size(length=Measure(4.0, 0.3, 0.0, 0.0), area=Measure(8.0, 1.0, 0.0, 0.0)).scaled(scale)
    records = [replace(DefectRecord.from_dict(one), size=size) for one in read_json(path)]
    write_json(path, [record.to_dict() for record in records])
    summary = read_json(folder / "summary.json")
    write_json(folder / "summary.json", {**summary, "scale": scale_fields(scale)})
    write_json(folder / "limits.json", {**limits_document(parse_limits(LIMITS), records), "limits": []})
    write_glb(folder / "mapping" / "mesh_defects.glb", plane(3, 3), scale)
    for form in (Form.CSV, Form.JSON, Form.HTML):
        (folder / f"report.{form}").write_bytes(form_of(folder, form, shown=Shown(inches=True)))
    (folder / "report.txt").write_text(text_of(form_of(folder, Form.PDF)))
    return folder


def lengths(path: Path) -> Iterator[str]:
    """Texts of a published file that claim a unit for a length."""
    if path.suffix == ".json":
        yield from _of_json(read_json(path), path.name)
    elif path.suffix == ".csv":
        with path.open(newline="", encoding="utf-8") as stream:
            for row in csv.DictReader(stream):
                yield from (f"{name}: {cell}" for name, cell in row.items() if LENGTH.search(cell))
    elif path.suffix == ".glb":
        data = path.read_bytes()
        document = json.loads(data[20 : 20 + struct.unpack_from("<I", data, 12)[0]])
        if document["asset"]["extras"]["unit"] != "model":
            yield str(document["asset"]["extras"])
    elif path.suffix in (".txt", ".html", ".svg"):
        # Styles are in millimetres of paper.
        text = re.sub(r"<style>.*?</style>", "", path.read_text(encoding="utf-8"), flags=re.DOTALL)
        yield from (found.group() for found in LENGTH.finditer(re.sub(r"\w+\.\w+_mm|length_mm", "", text)))


def _of_json(value: object, where: str) -> Iterator[str]:
    if isinstance(value, dict):
        for name, inner in value.items():
            if name == "parameters":  # what was asked for, and not what was measured
                continue
            if name.endswith("_mm") and inner is not None:
                yield f"{where}.{name}"
            yield from _of_json(inner, f"{where}.{name}")
    elif isinstance(value, list):
        for inner in value:
            yield from _of_json(inner, where)
    elif isinstance(value, str) and LENGTH.search(value):
        yield f"{where}: {value}"


def claims(folder: Path) -> dict[str, list[str]]:
    """By file; the page itself holds code alone, and shows what viewer.json says."""
    files = [
        path for path in sorted(folder.rglob("*")) if path.is_file() and path.name not in ("index.html", "data.js")
    ]
    found = {path.relative_to(folder).as_posix(): list(lengths(path)) for path in files}
    return {name: claimed for name, claimed in found.items() if claimed}


def test_without_a_scale_nothing_claims_a_length(tmp_path: Path) -> None:
    folder = result(tmp_path / "result", None)
    assert claims(folder) == {}
    page = read_json(folder / "viewer" / "viewer.json")
    assert (page["model"]["unit"], page["model"]["scale"]) == ("model", None)
    assert {one["verdict"] for one in read_json(folder / "limits.json")["findings"]} == {"cannot_tell"}


def test_with_one_every_form_does(tmp_path: Path) -> None:
    """The same search finds them where they are: it can fail."""
    found = claims(result(tmp_path / "result", SCALE))
    wanted = {"mapping/defects.json", "summary.json", "limits.json", "mapping/mesh_defects.glb"}
    assert wanted | {f"report.{form}" for form in ("csv", "json", "html", "txt")} <= set(found)
