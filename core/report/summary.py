"""summary.json: what ran, with what, and the headline numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from core.fingerprint import digest_of
from core.flags import Verdict
from core.products.front import FramesProduct, ProbeProduct
from core.products.search import ExtendProduct
from core.products.surface import FuseProduct, MeshProduct, TimelineProduct
from core.report.record import RunRecord, TaskRecord
from core.report.rows import selected_case
from core.report.tables import SCHEMA_VERSION
from core.scene.defect import DefectRecord, EventRow, least_defects
from core.scene.detection import DetectionRow, Outcome
from core.scene.size import scale_fields
from core.stage_specs import STAGES
from core.states import StageState, TaskState


def build_summary(
    record: RunRecord,
    verdict: Verdict,
    detections: Sequence[DetectionRow],
    timeline: Sequence[EventRow],
    defects: Sequence[DefectRecord],
) -> dict[str, Any]:
    """The object of summary.json."""
    parameters = record.settings.model_dump(mode="json")
    grouped = record.products.find(TimelineProduct, "timeline")
    return {
        "schema_version": SCHEMA_VERSION,
        "state": record.state,
        "failed_stage": record.failed_stage or None,
        "reason": record.reason or None,
        "message": record.message or None,
        "verdict": verdict,
        "label": record.label or None,
        "external_id": record.external_id or None,
        "metadata": dict(record.metadata),
        "preset": record.settings.preset,
        "parameters": parameters,
        "inputs": dict(record.inputs),
        "fingerprint": run_fingerprint(record),
        "versions": dict(record.versions),
        "frame": _frame(record),
        "scale": scale_fields(None) if grouped is None or grouped.scale is None else grouped.scale,
        "stages": _stages(record.tasks),
        "headline": _headline(record, detections, timeline, defects),
    }


def _frame(record: RunRecord) -> dict[str, object]:
    """The videos: size of the frames, the part of them that was used, px: x0, y0, x1, y1 (half open), and length."""
    frames, probed = record.products.find(FramesProduct, "frames"), record.products.find(ProbeProduct, "probe")
    several = probed.videos if probed else None
    return {
        "width": frames.source_width if frames else None,
        "height": frames.source_height if frames else None,
        "crop": list(frames.crop) if frames else None,
        "n_frames": probed.n_frames if probed else None,
        "duration_s": probed.duration_s if probed else None,
        **({} if several is None else {"videos": [asdict(one) for one in several]}),
    }


def run_fingerprint(record: RunRecord) -> str:
    """Names the result: inputs, settings without the pure work options, and the version of every stage."""
    return digest_of(
        {
            "inputs": dict(record.inputs),
            "settings": record.settings.model_dump(mode="json", exclude={"compute", "overrides"}),
            "stages": {name: spec.version for name, spec in STAGES.items()},
        }
    )


def _stages(tasks: Sequence[TaskRecord]) -> list[dict[str, object]]:
    """One entry per stage of the graph: tasks, summed seconds, largest memory of one task."""
    rows = []
    for name in STAGES:
        own = [task for task in tasks if task.stage == name]
        rows.append(
            {
                "name": name,
                "state": stage_state([task.state for task in own]),
                "tasks": len(own),
                "seconds": round(sum(task.seconds for task in own), 3),
                "peak_rss_bytes": max((task.peak_rss_bytes for task in own), default=0),
                "reasons": sorted({task.reason for task in own if task.reason}),
            }
        )
    return rows


def stage_state(states: Sequence[TaskState]) -> StageState:
    """State of a stage from those of its tasks.

    A stage that fans out succeeds with any succeeded task once all have ended; without tasks it is waiting.
    """
    if not states or TaskState.WAITING in states:
        return StageState.WAITING
    if TaskState.CANCELLED in states:
        return StageState.CANCELLED
    if TaskState.SUCCEEDED in states:
        return StageState.SUCCEEDED
    return StageState.FAILED if TaskState.FAILED in states else StageState.SKIPPED


def _headline(
    record: RunRecord,
    detections: Sequence[DetectionRow],
    timeline: Sequence[EventRow],
    defects: Sequence[DefectRecord],
) -> dict[str, Any]:
    done = record.products
    sparse, fused = done.find(ExtendProduct, "extend"), done.find(FuseProduct, "fuse")
    mesh = done.find(MeshProduct, "mesh")
    return {
        "frames": len(record.tables.frames),
        "selected_case": selected_case(record) or None,
        "registered_images": len(record.tables.registered),
        "points3D": sparse.points3D if sparse else None,
        "mean_reprojection_error_px": sparse.mean_reprojection_error_px if sparse else None,
        "median_reprojection_error_px": sparse.median_reprojection_error_px if sparse else None,
        "fused_points": fused.n_points if fused else None,
        "mesh_vertices": mesh.n_vertices if mesh else None,
        "mesh_faces": mesh.n_faces if mesh else None,
        "detections": len(detections),
        "mapped": sum(row.outcome == Outcome.MAPPED for row in detections),
        "events": len(timeline),
        "defects": len(defects),
        "defects_at_least": least_defects(record.model for record in defects),
    }
