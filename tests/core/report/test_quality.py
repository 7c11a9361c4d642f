"""quality.json: the funnel, and the thesis's tables recomputed from its own numbers."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from core.report.build import build_report
from tests.core.making_record import failed_record, full_record, with_check

QUALITY = build_report(full_record()).quality


def table(number: str, key: str, value: str) -> dict[str, Any]:
    return {row[key]: row[value] for row in QUALITY["tables"][number]}


def test_funnel() -> None:
    assert QUALITY["funnel"] == {
        "detections": 6,
        "frame_found": 5,
        "registered": 4,
        "surface_hit": 3,
        "verified": 3,
        "mapped": 3,
        "approximate": 0,
        "unconfirmed": 0,
        "defects": 2,
        "defects_at_least": 2,
    }
    by_support = build_report(full_record("thesis")).quality["funnel"]
    assert by_support["surface_hit"] is by_support["verified"] is None
    assert [(row["reason"], row["detections"]) for row in QUALITY["lost"]] == [
        ("no_frame", 1),
        ("no_registered_view", 1),
        ("no_support", 1),
    ]
    assert QUALITY["lost"][0]["share"] == pytest.approx(1 / 6, abs=1e-4)


def test_support_counts() -> None:
    support = QUALITY["support"]
    assert (support["min"], support["mean"], support["max"], support["unique"]) == (12, 12.0, 12, 2457)
    assert support["detections_with_20_or_fewer"] == 3


def test_table_3_2() -> None:
    found = table("3.2", "quantity", "value")
    assert found["selected_case"] == "refine_005_0090_0310"
    assert (found["mean_reprojection_error_px"], found["median_reprojection_error_px"]) == (1.1958, 1.1281)
    assert (found["fused_points"], found["mesh_vertices"], found["mesh_faces"]) == (870_096, 1_375_199, 2_711_283)


def test_table_3_3_has_the_thesis_rows() -> None:
    rows = [(row["case"], row["registered_images"], row["points3D"]) for row in QUALITY["tables"]["3.3"]]
    assert rows == [
        ("seg_006_0120_0300", 180, 54_478),
        ("refine_005_0090_0310", 220, 65_087),
        ("seg_021_0420_0450", 30, 9_655),
        ("seg_014_0280_0450", 41, 14_593),
        ("refine_010_0140_0360", 0, 0),
    ]


def test_table_3_4() -> None:
    found = table("3.4", "stage", "count")
    assert found["timestamp_entries"] == 3745
    assert found["input_detections"] == 6
    assert found["time_matched_detections"] + found["rejected_by_temporal_mismatch"] == 6
    assert (found["detections_with_3d_support"], found["detections_without_3d_support"]) == (3, 1)
    assert found["timeline_clusters"] == 2


def test_refinement_gain_is_the_thesis_percentages() -> None:
    gain = QUALITY["search"]["gain"]
    assert (gain["registered_images"], gain["registered_images_percent"]) == (40, 22.2)
    assert (gain["points3D"], gain["points3D_percent"]) == (10_609, 19.5)
    choices = table("3.5", "choice", "evidence")
    assert choices["refinement_around_best_segment"] == gain
    assert choices["segmented_reconstruction"]["registered_images_min"] == 30
    assert choices["segmented_reconstruction"]["points3D_max"] == 54_478


def test_weak_and_losing_cases() -> None:
    weak = QUALITY["search"]["weak"]
    assert (weak["fewer_than_80_images"], weak["fewer_than_25000_points"], weak["of"]) == (3, 3, 5)
    assert [row["name"] for row in weak["cases"]] == ["seg_014_0280_0450", "seg_021_0420_0450", "refine_010_0140_0360"]
    assert [row["name"] for row in QUALITY["search"]["losers"]][:2] == ["seg_006_0120_0300", "seg_014_0280_0450"]


def test_a_case_that_verified_less_is_told_so() -> None:
    record = full_record()
    counts = {"refine_005_0090_0310": 6, "seg_006_0120_0300": 4, "seg_014_0280_0450": 6}
    ranking = [
        {"name": name, "verified_detections": count, "registered_images": 0, "points3D": 0}
        for name, count in counts.items()
    ]
    tasks = [
        replace(task, facts={**task.facts, "ranking": ranking}) if task.key == "reduce_refine" else task
        for task in record.tasks
    ]
    losers = build_report(replace(record, tasks=tasks)).quality["search"]["losers"]
    assert [(row["name"], row["verified_detections"], row["why"]) for row in losers][:3] == [
        ("seg_014_0280_0450", 6, "score"),
        ("seg_006_0120_0300", 4, "verified detections: 4 against 6"),
        ("seg_021_0420_0450", None, "score"),
    ]


def test_registered_shares() -> None:
    shares = QUALITY["registration"]
    assert (shares["share_of_frames"], shares["share_of_video"]) == (0.8, pytest.approx(4 / 360, abs=1e-4))
    assert (shares["annotated_frames"], shares["annotated_registered"]) == (4, 3)


def test_the_thesis_preset_names_its_two_mistakes() -> None:
    thesis = build_report(full_record("thesis")).quality
    assert {"boxes_in_crop_frame", "principal_point_at_crop_centre"} <= {flag["code"] for flag in thesis["flags"]}
    assert any("cropped image" in note for note in thesis["notes"])
    assert any("principal point" in note for note in thesis["notes"])
    assert (QUALITY["flags"], QUALITY["notes"]) == ([], [])


def test_overrides_are_named() -> None:
    notes = build_report(full_record("thesis", **{"dense.sources": 4})).quality["notes"]
    assert "Preset thesis with overrides: dense.sources." in notes


def test_flags_keep_value_threshold_and_place() -> None:
    flag = build_report(with_check(full_record(), "bent_model", "warning")).quality["flags"][0]
    assert {name: flag[name] for name in ("code", "severity", "value", "threshold", "where")} == {
        "code": "bent_model",
        "severity": "warning",
        "value": 3.0,
        "threshold": 1.0,
        "where": "model",
    }


def test_cases_without_parallax_flag_the_clip() -> None:
    record = failed_record()
    still = [
        replace(task, facts={**task.facts, "flags": [], "status": "no_model", "reason": "no_parallax"})
        for task in record.tasks
        if task.facts
    ]
    flags = build_report(replace(record, tasks=still)).quality["flags"]
    assert [(flag["code"], flag["severity"], flag["where"]) for flag in flags] == [
        ("no_parallax", "error", "1 of 1 cases")
    ]


def test_a_failed_run_has_all_tables_without_inventing_numbers() -> None:
    quality = build_report(failed_record()).quality
    values = {row["quantity"]: row["value"] for row in quality["tables"]["3.2"]}
    assert set(values.values()) == {None}
    assert quality["search"]["gain"] is None
    assert quality["funnel"]["registered"] == 0
    assert quality["support"]["mean"] is None
