"""The report as other software reads it: files, columns, and what a failed run still says."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import pytest

from core.report.build import build_report, write_tables
from core.report.csv_form import read_csv
from core.report.record import RunRecord
from core.states import RunState, TaskState
from tests.core.making_record import failed_record, full_record, with_check

COLUMNS = {
    "frames.csv": "index source_index pts time_s sha256 role registered model video",
    "cases.csv": "name kind start end status reason frames models registered_images points3D "
    "mean_reprojection_error_px median_reprojection_error_px seconds start_mode selected vetoed",
    "mapping/detections.csv": "id key time_s label score box_x1 box_y1 box_x2 box_y2 frame_index outcome reason rung "
    "support_points x y z confidence blade defect_id model video "
    "length length_sigma width width_sigma area area_sigma length_unit size_from "
    "side span span_sigma chord chord_sigma edge_distance edge_distance_sigma root_distance root_distance_sigma",
    "mapping/timeline.csv": "event_id defect_id label start_s end_s n_detections n_frames x y z radius confidence "
    "video blade",
}
RECORDS = {"full": full_record(), "failed": failed_record(), "thesis": full_record("thesis")}


def refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is not JSON")


@pytest.mark.parametrize("name", RECORDS)
def test_all_files_with_the_columns_of_the_contract(name: str, tmp_path: Path) -> None:
    written = write_tables(build_report(RECORDS[name]), tmp_path)
    found = sorted(path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file())
    assert sorted(written) == found
    for file, columns in COLUMNS.items():
        with (tmp_path / file).open(encoding="utf-8", newline="") as stream:
            assert next(csv.reader(stream)) == columns.split()
        rows = tmp_path / file.replace(".csv", ".json")
        for row in json.loads(rows.read_text(encoding="utf-8")) if rows.exists() else []:
            assert list(row) == columns.split()


@pytest.mark.parametrize("name", RECORDS)
def test_json_is_finite_and_objects_carry_their_version(name: str, tmp_path: Path) -> None:
    write_tables(build_report(RECORDS[name]), tmp_path)
    kinds = {}
    for path in tmp_path.rglob("*.json"):
        value = json.loads(path.read_text(encoding="utf-8"), parse_constant=refuse)
        kinds[path.name] = type(value).__name__
        if isinstance(value, dict):
            assert value["schema_version"] == 1
    assert kinds == {
        "summary.json": "dict",
        "quality.json": "dict",
        "cases.json": "list",
        "detections.json": "list",
        "timeline.json": "list",
        "defects.json": "list",
    }


def test_csv_and_json_say_the_same(tmp_path: Path) -> None:
    write_tables(build_report(RECORDS["full"]), tmp_path)
    rows = json.loads((tmp_path / "mapping/detections.json").read_text(encoding="utf-8"))
    for text, row in zip(read_csv(tmp_path / "mapping/detections.csv"), rows, strict=True):
        assert text == {name: "" if value is None else str(value) for name, value in row.items()}


def test_frames_say_which_are_registered() -> None:
    frames = build_report(RECORDS["full"]).frames
    assert [(row["registered"], row["model"]) for row in frames] == [(1, 0)] * 4 + [(0, None)]


def test_cases_have_seconds_and_the_selected_one() -> None:
    cases = build_report(RECORDS["full"]).cases
    assert [row["name"] for row in cases if row["selected"]] == ["refine_005_0090_0310"]
    assert cases[0]["seconds"] == 2.0
    assert [(row["status"], row["reason"]) for row in cases if row["status"] != "succeeded"] == [
        ("no_model", "no_initial_pair")
    ]


def test_a_run_without_a_model_keeps_every_detection_and_says_why() -> None:
    report = build_report(RECORDS["failed"])
    assert report.verdict == "refused"
    assert [row["id"] for row in report.detections] == [0, 1, 2, 3, 4, 5]
    assert {row["outcome"] for row in report.detections} == {"unplaced"}
    assert report.detections[3]["reason"] == "no_registered_view"
    assert report.detections[5]["reason"] == "no_frame"
    assert report.detections[0]["reason"] == "frame_not_registered"
    assert (report.timeline, report.defects) == ([], [])
    assert [row["status"] for row in report.cases] == ["no_model", "failed"]
    assert report.cases[1]["reason"] == "stage_failed"
    assert report.quality["flags"][0]["code"] == "no_parallax"
    assert (report.summary["failed_stage"], report.summary["reason"]) == ("reduce_coarse", "no_reconstruction")


def test_a_refused_model_leaves_no_mapped_row() -> None:
    refused = replace(full_record(), state=RunState.FAILED, reason="no_reconstruction")
    report = build_report(refused)
    assert report.verdict == "refused"
    assert not [row for row in report.detections if row["outcome"] == "mapped"]
    assert len(report.detections) == 6
    assert (report.timeline, report.defects) == ([], [])
    assert report.summary["headline"]["mapped"] == 0


@pytest.mark.parametrize(
    ("record", "verdict"),
    [
        (full_record(), "ok"),
        (with_check(full_record(), "bent_model", "warning"), "suspect"),
        (with_check(full_record(), "few_points", "info"), "ok"),
        (full_record("thesis"), "suspect"),
        (failed_record(), "refused"),
    ],
    ids=["clean", "warning", "info", "thesis", "no model"],
)
def test_verdict(record: RunRecord, verdict: str) -> None:
    assert build_report(record).quality["verdict"] == verdict


def test_a_partial_run_keeps_what_was_mapped_before() -> None:
    full = full_record()
    tasks = [
        replace(task, state=TaskState.FAILED, reason="disk_full") if task.key == "gallery" else task
        for task in full.tasks
    ]
    report = build_report(
        replace(full, state=RunState.PARTIAL, tasks=tasks, failed_stage="gallery", reason="disk_full")
    )
    assert sum(row["outcome"] == "mapped" for row in report.detections) == 3
    assert report.summary["state"] == "partial"


def test_a_cancelled_run_before_any_result() -> None:
    full = full_record()
    report = build_report(
        replace(full, state=RunState.CANCELLED, tasks=[], tables=type(full.tables)(), reason="cancelled")
    )
    assert report.verdict == "refused"
    assert (report.frames, report.cases, report.detections) == ([], [], [])


def test_building_is_pure() -> None:
    assert build_report(full_record()) == build_report(full_record())
