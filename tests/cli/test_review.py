"""`bladeatlas review`: records come into a folder once, drawn findings get their place, hostile notes run nothing."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cli.main import main
from core.query import Result
from core.review.published import REVIEW
from core.review.target import Target
from tests.core.making_results import opened

HOSTILE = "@SUM(1+1)*cmd|' /C calc'!A0 \x1b[31m<script>"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return opened("two_models", tmp_path / "result")


def saved(path: Path, *rows: dict[str, Any]) -> Path:
    records = [
        {"revision": number, "id": f"r{number}", "value": None, "reason": "", "time": "2026-01-01", "by": "", **row}
        for number, row in enumerate(rows, 1)
    ]
    path.write_text(json.dumps({"schema_version": 2, "records": records}), encoding="utf-8")
    return path


def target(folder: Path, number: int = 0) -> dict[str, Any]:
    records = json.loads((folder / "mapping/defects.json").read_text("utf-8"))
    return Target.of_defect(records[number]).to_dict()


def test_records_are_applied_once(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    own = target(folder)
    note = HOSTILE.replace("\x1b", "")
    file = saved(
        tmp_path / "mine.json",
        {"target": own, "action": "reject", "reason": "duplicate"},
        {"target": own, "action": "note", "value": note},
    )
    assert main(["review", str(folder), "--apply", str(file)]) == 0
    said = capsys.readouterr().out
    assert "mine.json: 2 records added" in said
    assert f"D{own['id']}" in said
    assert "rejected, duplicate" in said
    assert main(["review", str(folder), "--apply", str(file)]) == 0
    assert "0 records added, 2 were there already" in capsys.readouterr().out
    assert main(["review", str(folder), "--csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert rows[0]["notes"] == f"'{note}"
    assert (rows[0]["label"], rows[0]["review_state"]) == (own["label"], "rejected")
    assert main(["review", str(folder), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["findings"][0]["review"]["notes"][0]["text"] == note


def test_a_drawn_box_is_cast_onto_the_surface(folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    centroid = np.array(target(folder)["centroid"])
    result = Result(folder)
    seen = result.visible_frames(centroid)[0]
    width, height = result._crop.source_width, result._crop.source_height
    x, y = seen.x / width, seen.y / height
    box = [x - 0.01, y - 0.01, x + 0.01, y + 0.01]
    drawn = {"kind": "added", "id": "r1", "label": "crack", "model": 0}
    value = {"label": "crack", "frame": seen.frame_index, "box": box}
    file = saved(tmp_path / "mine.json", {"target": drawn, "action": "add", "value": value})
    assert main(["review", str(folder), "--apply", str(file), "--json"]) == 0
    made = json.loads(capsys.readouterr().out)["findings"][-1]
    assert made["name"] == "H1"
    assert np.linalg.norm(np.subtract(made["target"]["centroid"], centroid)) < 0.05 * result.mesh.diagonal
    away = {**value, "box": [0.0, 0.0, 0.001, 0.001]}
    file = saved(tmp_path / "more.json", {"id": "x", "target": {**drawn, "id": "x"}, "action": "add", "value": away})
    assert main(["review", str(folder), "--apply", str(file), "--json"]) == 0
    made = json.loads(capsys.readouterr().out)["findings"][-1]
    assert (made["target"]["centroid"], made["made"]["value"]["unplaced"] in ("outside_roi", "off_surface")) == (
        None,
        True,
    )


def test_a_frame_that_is_not_there_leaves_the_folder_as_it_is(folder: Path, tmp_path: Path) -> None:
    value = {"label": "crack", "frame": 10_000, "box": [0, 0, 1, 1]}
    drawn = {"kind": "added", "id": "r1", "label": "crack", "model": 0}
    file = saved(tmp_path / "mine.json", {"target": drawn, "action": "add", "value": value})
    assert main(["review", str(folder), "--apply", str(file)]) == 2
    assert not (folder / REVIEW).exists()


@pytest.mark.parametrize("text", ["{", "[]", '{"schema_version": 2, "records": [{"id": 1}]}'])
def test_what_is_no_review_is_refused(folder: Path, tmp_path: Path, text: str) -> None:
    file = tmp_path / "mine.json"
    file.write_text(text, encoding="utf-8")
    assert main(["review", str(folder), "--apply", str(file)]) == 2
    assert not (folder / REVIEW).exists()


def test_what_is_no_result_is_refused(tmp_path: Path) -> None:
    assert main(["review", str(tmp_path)]) == 2
