"""The forms of the report: PDF, a page, a table and the object itself."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable, Mapping
from enum import StrEnum
from importlib import resources
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from core.inspection_report.pictures import files_of
from core.inspection_report.source import ReportSource
from core.inspection_report.typeset import typeset
from core.json_files import JsonObject
from core.report.csv_form import csv_line
from core.scene.on_row import ROW_COLUMNS

STYLE_SHEET = "report.css"
POLICY = "default-src 'none'; img-src data:; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
"""Content security policy of the page: it asks nobody and runs nothing."""
COLUMNS = (
    "finding",
    "model",
    "label",
    "blade",
    "blade_is_relative",
    "side",
    "span",
    "span_sigma",
    "chord",
    "chord_sigma",
    "root_distance",
    "root_distance_sigma",
    "edge_distance",
    "edge_distance_sigma",
    "size",
    "size_sigma",
    "size_unit",
    "size_kind",
    "width",
    "width_sigma",
    "depth",
    "depth_sigma",
    "confidence",
    "frames_with_it",
    "frames_that_could_show_it",
    "first_s",
    "last_s",
    "limits",
    "limits_reason",
    "review",
    "human_label",
    "human_blade",
    "human_length",
    "reason",
    "disposition",
    "notes",
    "reviewed_by",
    "reviewed_at",
)
"""Of report.csv, in order."""
_PAGES = Environment(
    loader=PackageLoader(__package__), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
)


class Form(StrEnum):
    """The forms, by the ending of their file."""

    PDF = "pdf"
    HTML = "html"
    CSV = "csv"
    JSON = "json"


MEDIA_TYPES: Mapping[Form, str] = {
    Form.PDF: "application/pdf",
    Form.HTML: "text/html; charset=utf-8",
    Form.CSV: "text/csv; charset=utf-8",
    Form.JSON: "application/json",
}


def written(form: Form, document: JsonObject, source: ReportSource, style: Path | None = None) -> bytes:
    """One form of the report; the same document has the same bytes.

    Args:
        form: which.
        document: the object of report.json.
        source: where its pictures are read.
        style: folder of the house style.

    Raises:
        BadInput: the house style cannot be used.
        StageFailed: the report cannot be set.
    """
    return _WRITERS[form](document, source, style)


def _as_json(document: JsonObject, _source: ReportSource, _style: Path | None) -> bytes:
    return (json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode()


def _as_csv(document: JsonObject, _source: ReportSource, _style: Path | None) -> bytes:
    """One row per finding, the machine's first; those that a person made have the person's cells alone."""
    rows = [*map(_cells, document["findings"]), *map(_added_cells, document["added"])]
    return "".join([csv_line(COLUMNS), *(csv_line([row.get(name) for name in COLUMNS]) for row in rows)]).encode()


def _added_cells(one: JsonObject) -> JsonObject:
    return {"finding": one["name"], "label": one["label"], **_human_cells(one["human"])}


def _human_cells(human: JsonObject) -> JsonObject:
    return {
        "review": human["state"],
        "human_label": human["label"],
        "human_blade": human["blade"],
        "human_length": human["length"],
        "reason": human["reason"],
        "disposition": human["disposition"],
        "notes": "; ".join(human["notes"]) or None,
        "reviewed_by": human["by"],
        "reviewed_at": human["time"],
    }


def _cells(one: JsonObject) -> JsonObject:
    place = one["place"]
    return {
        "finding": one["name"],
        "model": one["model"],
        "label": one["label"],
        "blade": place["blade"],
        "blade_is_relative": place["relative"],
        **{name: place[name] for name in ROW_COLUMNS},
        "size": one["size"]["value"],
        "size_sigma": one["size"]["sigma"],
        "size_unit": one["size"]["unit"],
        "size_kind": one["size"]["kind"],
        "width": one["width"]["value"],
        "width_sigma": one["width"]["sigma"],
        "depth": one["depth"]["value"],
        "depth_sigma": one["depth"]["sigma"],
        "confidence": one["confidence"],
        "frames_with_it": one["seen"]["frames"],
        "frames_that_could_show_it": one["seen"]["could_show"],
        "first_s": one["times"]["first_s"],
        "last_s": one["times"]["last_s"],
        "limits": None if one["limits"] is None else one["limits"]["verdict"],
        "limits_reason": None if one["limits"] is None else one["limits"]["reason"],
        **_human_cells(one["human"]),
    }


def _as_html(document: JsonObject, source: ReportSource, style: Path | None) -> bytes:
    """One file without anything beside it; every picture is in it once."""
    pictures = {}
    for number, path in enumerate(files_of(document["findings"])):
        data = source.picture(path)
        if data is not None:
            pictures[path] = (f"p{number}", f"data:image/jpeg;base64,{base64.b64encode(data).decode('ascii')}")
    own = (resources.files(__package__) / "templates" / STYLE_SHEET).read_text(encoding="utf-8")
    house = "" if style is None or not (style / STYLE_SHEET).is_file() else (style / STYLE_SHEET).read_text("utf-8")
    page = _PAGES.get_template("report.html").render(d=document, pictures=pictures, css=own, house=house, policy=POLICY)
    return page.encode()


_WRITERS: Mapping[Form, Callable[[JsonObject, ReportSource, Path | None], bytes]] = {
    Form.PDF: typeset,
    Form.HTML: _as_html,
    Form.CSV: _as_csv,
    Form.JSON: _as_json,
}
