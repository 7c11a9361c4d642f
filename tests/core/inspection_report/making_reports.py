"""Reports of the committed results, whole or with something in their files changed."""

from __future__ import annotations

import io
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

from pypdf import PdfReader

from core.inspection_report.document import report_document
from core.inspection_report.forms import Form, written
from core.inspection_report.source import ReportSource, files_below, read_source
from core.json_files import JsonObject
from core.review.published import reviewed_result
from tests.core.making_results import RESULTS

DAY = "2026-05-04"


def source_of(folder: Path) -> ReportSource:
    return read_source(files_below(folder))


def document_of(folder: Path, **told: Any) -> JsonObject:
    return report_document(source_of(folder), reviewed_result(folder).reviewed, **told)


def form_of(folder: Path, form: Form, style: Path | None = None, **told: Any) -> bytes:
    return written(form, document_of(folder, **told), source_of(folder), style)


def text_of(pdf: bytes) -> str:
    """Text of all pages, with single spaces."""
    return " ".join(" ".join(page.extract_text() for page in PdfReader(io.BytesIO(pdf)).pages).split())


def changed(folder: Path, name: str = "two_models", **files: Callable[[Any], object]) -> Path:
    """A copy of a committed result in which functions by file name without its ending changed the JSON."""
    shutil.copytree(RESULTS / name, folder)
    for path in folder.rglob("*.json"):
        if path.stem in files:
            value = json.loads(path.read_text(encoding="utf-8"))
            files[path.stem](value)
            path.write_text(json.dumps(value), encoding="utf-8")
    return folder


ROW: JsonObject = {
    "status": "estimated",
    "count": [59, 65],
    "coverage": [
        {"blade": 1, "share": 1.0, "views_2": 0.75, "views_3": 0.5},
        {"blade": 2, "share": 0.8, "views_2": 0.4, "views_3": 0.1},
    ],
    "findings": [
        {
            "defect": 0,
            "blade": 2,
            "side": "tip",
            "span": 0.91,
            "span_sigma": 0.02,
            "root_distance": 7.5,
            "root_distance_sigma": 0.25,
        }
    ],
}
"""A row.json in which one finding lies on blade 2."""
