"""The thesis's tables 3.2 to 3.5, filled with the numbers of this run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from core.outputs import FUSED, SURFACE
from core.products.contract import Products
from core.products.front import AnnotationsProduct, FramesProduct
from core.products.search import ExtendProduct
from core.products.surface import FuseProduct, MeshProduct
from core.scene.case import CaseKind, CaseRow
from core.scene.detection import DetectionRow
from core.settings import Settings
from core.thesis.search import best_case, refinement_gain, spread


def thesis_tables(
    done: Products,
    settings: Settings,
    selected: str,
    cases: Sequence[CaseRow],
    detections: Sequence[DetectionRow],
    funnel: Mapping[str, int | None],
    support: Mapping[str, float | None],
    n_events: int,
) -> dict[str, list[dict[str, object]]]:
    """All tables by their number.

    Args:
        done: products of the run's tasks.
        settings: of the run.
        selected: name of the case whose model went on; empty without one.
        cases: that ended.
        detections: all rows.
        funnel: detections left after each step.
        support: counts of sparse support points.
        n_events: of the timeline.
    """
    return {
        "3.2": table_3_2(done, selected),
        "3.3": table_3_3(selected, cases),
        "3.4": table_3_4(done, detections, funnel, support, n_events),
        "3.5": table_3_5(done, settings, selected, cases),
    }


def table_3_2(done: Products, selected: str) -> list[dict[str, object]]:
    """Selected reconstruction and dense surface; null = not reached."""
    sparse, fused = done.find(ExtendProduct, "extend"), done.find(FuseProduct, "fuse")
    mesh = done.find(MeshProduct, "mesh")
    values = (
        ("selected_case", selected or None),
        ("registered_images", sparse.registered_images if sparse else None),
        ("points3D", sparse.points3D if sparse else None),
        ("mean_reprojection_error_px", sparse.mean_reprojection_error_px if sparse else None),
        ("median_reprojection_error_px", sparse.median_reprojection_error_px if sparse else None),
        ("fused_points", fused.n_points if fused else None),
        ("mesh_vertices", mesh.n_vertices if mesh else None),
        ("mesh_faces", mesh.n_faces if mesh else None),
        ("fused_point_cloud", FUSED if fused else None),
        ("mesh", SURFACE if mesh else None),
    )
    return [{"quantity": name, "value": value} for name, value in values]


def table_3_3(selected: str, cases: Sequence[CaseRow]) -> list[dict[str, object]]:
    """The selected case beside the strongest coarse one, the two weakest and one without a model."""
    picked: dict[str, str] = {}
    if (coarse := best_case(cases, CaseKind.COARSE)) is not None:
        picked[coarse.name] = "strongest coarse case"
    if selected:
        picked[selected] = "selected" if selected not in picked else "selected, strongest coarse case"
    with_model = sorted((row for row in cases if row.succeeded), key=lambda row: row.score)
    for row in with_model[:2]:
        picked.setdefault(row.name, "weak alternative")
    for row in [row for row in cases if not row.succeeded][:1]:
        picked.setdefault(row.name, "no model")
    by_name = {row.name: row for row in cases}
    return [
        {
            "case": name,
            "type": by_name[name].kind,
            "registered_images": by_name[name].registered_images,
            "points3D": by_name[name].points3D,
            "role": role,
        }
        for name, role in picked.items()
        if name in by_name
    ]


def table_3_4(
    done: Products,
    rows: Sequence[DetectionRow],
    funnel: Mapping[str, int | None],
    support: Mapping[str, float | None],
    n_events: int,
) -> list[dict[str, object]]:
    """The transfer from annotations to geometry, step by step."""
    matched = int(funnel["registered"] or 0)
    annotations = done.find(AnnotationsProduct, "annotations")
    with_support = sum(row.support_points > 0 for row in rows)
    values = (
        ("timestamp_entries", annotations.n_keys if annotations else None),
        ("timestamps_with_detections", len({row.key for row in rows})),
        ("input_detections", len(rows)),
        ("time_matched_detections", matched),
        ("rejected_by_temporal_mismatch", len(rows) - matched),
        ("detections_with_3d_support", with_support),
        ("detections_without_3d_support", matched - with_support),
        ("unique_support_points", support["unique"]),
        ("timeline_clusters", n_events),
    )
    return [{"stage": name, "count": value} for name, value in values]


def table_3_5(done: Products, settings: Settings, selected: str, cases: Sequence[CaseRow]) -> list[dict[str, object]]:
    """The design choices and the evidence this run gives for each."""
    frames, sparse = done.find(FramesProduct, "frames"), done.find(ExtendProduct, "extend")
    coarse, gain = spread(cases, CaseKind.COARSE), refinement_gain(cases)
    preprocessing = {
        "frames": frames.n_search if frames else None,
        "clip_start_s": settings.frames.clip_start_s,
        "clip_end_s": settings.frames.clip_end_s,
        "roi": [settings.roi.x0, settings.roi.y0, settings.roi.x1, settings.roi.y1],
        "crop_px": list(frames.crop) if frames else None,
    }
    consistency = {
        "selected_case": selected or None,
        "models": 1 if sparse else 0,
        "registered_images_of_case": _images_of(cases, selected),
        "registered_images_of_model": sparse.registered_images if sparse else None,
    }
    return [
        {"choice": "segmented_reconstruction", "evidence": coarse},
        {"choice": "refinement_around_best_segment", "evidence": gain},
        {"choice": "fixed_preprocessing", "evidence": preprocessing},
        {"choice": "selected_case_consistency", "evidence": consistency},
    ]


def _images_of(cases: Sequence[CaseRow], name: str) -> int | None:
    return next((row.registered_images for row in cases if row.name == name), None)
