"""The closing report of a run."""

from __future__ import annotations

import json
from pathlib import Path

from cli import report
from core.states import RunState
from worker.events import Outcome


def test_report_says_what_was_made(tmp_path: Path) -> None:
    (tmp_path / "mapping").mkdir()
    (tmp_path / "mapping" / "detections.csv").write_text("id\n")
    headline = {"frames": 96, "points3D": 12345, "mean_reprojection_error_px": 0.81234, "fused_points": None}
    (tmp_path / "summary.json").write_text(json.dumps({"schema_version": 1, "headline": headline}))
    flag = {"code": "few_points", "severity": "warning", "value": 12.0, "threshold": 50.0, "where": "", "meaning": "m"}
    bare = {"code": "bent_model", "severity": "error", "value": None, "threshold": None, "where": "model 0"}
    quality = {
        "verdict": "suspect",
        "flags": [flag, {**bare, "meaning": "n"}],
        "funnel": {"detections": 90, "frame_found": 88, "surface_hit": None, "mapped": 70, "approximate": 5},
    }
    (tmp_path / "quality.json").write_text(json.dumps(quality))
    text = "\n".join(report.lines(Outcome(RunState.SUCCEEDED, tmp_path, 75.0, 12, 3)))
    assert "succeeded in 1 min 15 s (12 tasks computed, 3 already there)" in text
    assert "mean reprojection error px  0.8123" in text
    assert "12,345" in text
    assert "fused points" not in text
    assert "detections 90 -> frame found 88 -> mapped 70 (and 5 approximate)" in text
    assert "verdict: suspect" in text
    for least, says in ((7, "-> defects 7 to 9"), (9, "-> defects 9")):
        quality["funnel"] = {"mapped": 70, "defects": 9, "defects_at_least": least}
        (tmp_path / "quality.json").write_text(json.dumps(quality))
        lines = report.lines(Outcome(RunState.SUCCEEDED, tmp_path, 75.0, 12, 3))
        assert any(line.endswith(says) for line in lines)
    assert "warning few_points: 12, threshold 50: m" in text
    assert "error bent_model (model 0): n" in text
    assert str(tmp_path / "mapping" / "detections.csv") in text
    assert "mesh_defects.glb" not in text, "only files that exist are named"


def test_report_of_a_run_that_made_nothing(tmp_path: Path) -> None:
    assert report.lines(Outcome(RunState.FAILED, tmp_path, 1.0, 1, 0))[1].startswith("failed in 1.0 s")


def test_a_run_ends_by_naming_the_page_to_open(tmp_path: Path) -> None:
    (tmp_path / "viewer").mkdir()
    without = report.lines(Outcome(RunState.SUCCEEDED, tmp_path, 1.0, 1, 0))
    (tmp_path / "viewer" / "index.html").write_text("page")
    last = report.lines(Outcome(RunState.SUCCEEDED, tmp_path, 1.0, 1, 0))[-1]
    assert str(tmp_path / "viewer" / "index.html") in last
    assert f"bladeatlas view {tmp_path}" in last
    assert not any("bladeatlas view" in line for line in without)
