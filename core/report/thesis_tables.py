"""The thesis's tables 3.2 to 3.5, filled with the numbers of this run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from core.report.record import Row, RunRecord
from core.report.rows import selected_case
from core.report.search import best_case, refinement_gain, score, spread


def table_3_2(record: RunRecord) -> list[dict[str, object]]:
    """Selected reconstruction and dense surface; null = not reached."""
    sparse, fused, mesh = record.facts("extend"), record.facts("fuse"), record.facts("mesh")
    values = (
        ("selected_case", selected_case(record) or None),
        ("registered_images", sparse.get("registered_images")),
        ("points3D", sparse.get("points3D")),
        ("mean_reprojection_error_px", sparse.get("mean_reprojection_error_px")),
        ("median_reprojection_error_px", sparse.get("median_reprojection_error_px")),
        ("fused_points", fused.get("n_points")),
        ("mesh_vertices", mesh.get("n_vertices")),
        ("mesh_faces", mesh.get("n_faces")),
        ("fused_point_cloud", "dense/fused.ply" if fused else None),
        ("mesh", "dense/mesh_poisson.ply" if mesh else None),
    )
    return [{"quantity": name, "value": value} for name, value in values]


def table_3_3(record: RunRecord, cases: Sequence[Row]) -> list[dict[str, object]]:
    """The selected case beside the strongest coarse one, the two weakest and one without a model."""
    chosen = selected_case(record)
    picked: dict[str, str] = {}
    if (coarse := best_case(cases, "coarse")) is not None:
        picked[str(coarse["name"])] = "strongest coarse case"
    if chosen:
        picked[chosen] = "selected" if chosen not in picked else "selected, strongest coarse case"
    with_model = sorted((row for row in cases if row["status"] == "succeeded"), key=score)
    for row in with_model[:2]:
        picked.setdefault(str(row["name"]), "weak alternative")
    for row in [row for row in cases if row["status"] != "succeeded"][:1]:
        picked.setdefault(str(row["name"]), "no model")
    by_name = {str(row["name"]): row for row in cases}
    return [
        {
            "case": name,
            "type": by_name[name]["kind"],
            "registered_images": by_name[name]["registered_images"],
            "points3D": by_name[name]["points3D"],
            "role": role,
        }
        for name, role in picked.items()
        if name in by_name
    ]


def table_3_4(
    record: RunRecord, rows: Sequence[Row], funnel: Mapping[str, int | None], support: Mapping[str, float | None]
) -> list[dict[str, object]]:
    """The transfer from annotations to geometry, step by step."""
    facts = record.facts("annotations")
    matched = int(funnel["registered"] or 0)
    with_support = sum(int(row["support_points"] or 0) > 0 for row in rows)
    values = (
        ("timestamp_entries", facts.get("n_keys")),
        ("timestamps_with_detections", len({row["key"] for row in rows})),
        ("input_detections", len(rows)),
        ("time_matched_detections", matched),
        ("rejected_by_temporal_mismatch", len(rows) - matched),
        ("detections_with_3d_support", with_support),
        ("detections_without_3d_support", matched - with_support),
        ("unique_support_points", support["unique"]),
        ("timeline_clusters", len(record.tables.timeline)),
    )
    return [{"stage": name, "count": value} for name, value in values]


def table_3_5(record: RunRecord, cases: Sequence[Row]) -> list[dict[str, object]]:
    """The design choices and the evidence this run gives for each."""
    settings, facts = record.settings, record.facts("frames")
    coarse, gain = spread(cases, "coarse"), refinement_gain(cases)
    preprocessing = {
        "frames": facts.get("n_search"),
        "clip_start_s": settings.frames.clip_start_s,
        "clip_end_s": settings.frames.clip_end_s,
        "roi": [settings.roi.x0, settings.roi.y0, settings.roi.x1, settings.roi.y1],
        "crop_px": facts.get("crop"),
    }
    consistency = {
        "selected_case": selected_case(record) or None,
        "models": 1 if record.facts("extend") else 0,
        "registered_images_of_case": _images_of(cases, selected_case(record)),
        "registered_images_of_model": record.facts("extend").get("registered_images"),
    }
    return [
        {"choice": "segmented_reconstruction", "evidence": coarse},
        {"choice": "refinement_around_best_segment", "evidence": gain},
        {"choice": "fixed_preprocessing", "evidence": preprocessing},
        {"choice": "selected_case_consistency", "evidence": consistency},
    ]


def _images_of(cases: Sequence[Row], name: str) -> int | None:
    return next((int(row["registered_images"] or 0) for row in cases if row["name"] == name), None)
