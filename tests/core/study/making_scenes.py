"""Scenes of a study: a committed result whose row is told, so that every question has an answer."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from core.json_files import read_json, write_json
from core.study.build import build_study
from tests.core.inspection_report.making_reports import ROW
from tests.core.making_results import opened

TOLD: tuple[dict[str, Any], ...] = (
    {"blade": "2", "span": 0.25, "span_sigma": 0.02, "chord": None, "side": "convex"},
    {"blade": "2", "span": 0.75, "span_sigma": 0.02, "chord": None, "side": "convex", "length": 2.5},
    {"blade": "1", "span": 0.5, "span_sigma": 0.02, "chord": None, "side": "convex"},
)
"""Of the three findings: on blades 2, 2 and 1, the second the largest."""
OTHERWISE: tuple[dict[str, Any], ...] = (
    {"blade": "1", "span": 0.4, "span_sigma": 0.02, "chord": None, "side": "convex", "length": 3.5},
    {"blade": "3", "span": 0.8, "span_sigma": 0.02, "chord": None, "side": "convex"},
    {"blade": "1", "span": 0.5, "span_sigma": 0.02, "chord": None, "side": "convex"},
)


def result_with_blades(folder: Path, name: str = "one_model", told: Sequence[dict[str, Any]] = TOLD) -> Path:
    """A committed result with a row, and its findings on the blades that are told."""
    opened(name, folder)
    row = {**ROW, "findings": []}
    write_json(folder / "row.json", row)
    for path in (folder / "mapping" / "defects.json", folder / "viewer" / "viewer.json"):
        value = read_json(path)
        records = value["defects"] if isinstance(value, dict) else value
        for one, own in zip(records, told, strict=False):
            one.update(own)
            if "length" in own:
                one.update(length_sigma=0.1, length_unit="model", size=own["length"], width=None, width_sigma=None)
        if isinstance(value, dict):
            value["row"] = row
            write_script(folder / "viewer" / "data.js", value)
        write_json(path, value)
    return folder


def write_script(path: Path, document: dict[str, Any]) -> None:
    """The script of the page with another document and the same surface."""
    surface = path.read_text(encoding="ascii").rsplit(", surface: ", 1)[1]
    path.write_text(f"window.BLADEATLAS = {{viewer: {json.dumps(document)}, surface: {surface}", encoding="ascii")


def write_study(folder: Path, contact: str = "") -> Path:
    """A study of two scenes below a folder; gives its own folder."""
    scenes = (result_with_blades(folder / "first"), result_with_blades(folder / "second", told=OTHERWISE))
    build_study(scenes, folder / "out", contact)
    return folder / "out"
