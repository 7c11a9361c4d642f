"""What a run lost: parts of its result, and detections on their way to defects (thesis tables 3.4, section 3.4.5)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from core.flags import Flag, Severity
from core.json_files import JsonObject
from core.products.surface import MeshProduct
from core.report.record import RunRecord, TaskRecord
from core.scene.defect import DefectRecord, least_defects
from core.scene.detection import REASONS, DetectionRow, Outcome, Reason
from core.stage_specs import STAGES
from core.states import RunState, TaskState
from core.task_key import key_of, submodel_of

_NAMES = tuple(STAGES)
AFTER_MODEL = frozenset(_NAMES[_NAMES.index("extend") + 1 :])
"""Stages that work on the final model."""


def missing_parts(record: RunRecord) -> list[Flag]:
    """Flags for stages that failed after the model, for a run without a surface, and for one that placed nothing.

    None without a model to trust: such a run is refused, and other flags say why.
    """
    if record.reason == "no_reconstruction" or "extend" not in record.products:
        return []
    flags = [_failed(task) for task in record.tasks if _failed_after_model(record, task)]
    if record.state != RunState.SUCCEEDED and not flags:
        where = ": ".join(filter(None, (record.failed_stage, record.reason or record.state)))
        flags.append(Flag("incomplete", Severity.WARNING, where=where))
    mesh = record.products.find(MeshProduct, "mesh")
    if mesh is None or not mesh.n_faces:
        flags.append(Flag("no_surface", Severity.ERROR, where="mesh"))
    return [*flags, *_nothing_placed(record)]


def _failed_after_model(record: RunRecord, task: TaskRecord) -> bool:
    """A further model that never came to be is no loss; one that lost its surface is."""
    after = task.state == TaskState.FAILED and task.stage in AFTER_MODEL
    return after and key_of("extend", submodel_of(task.key)) in record.products


def _failed(task: TaskRecord) -> Flag:
    submodel = submodel_of(task.key)
    where = f"{task.stage}: {task.reason or 'failed'}"
    return Flag("incomplete", Severity.WARNING, where=f"model {submodel}, {where}" if submodel else where)


def _nothing_placed(record: RunRecord) -> list[Flag]:
    in_video = sum(row.source_index is not None for row in record.tables.detections)
    placed = sum(row.outcome == Outcome.MAPPED for row in record.tables.mapped_rows or ())
    return (
        [Flag("nothing_mapped", Severity.ERROR, 0.0, 1.0, f"{in_video} detections")] if in_video and not placed else []
    )


WITHOUT_VIEW = (Reason.NO_REGISTERED_VIEW, Reason.FRAME_NOT_REGISTERED)
_BEFORE_SURFACE = (Reason.NO_FRAME, *WITHOUT_VIEW, Reason.OUTSIDE_ROI, Reason.NO_SUPPORT, Reason.OFF_SURFACE)
FEW_SUPPORT_POINTS = 20
"""Support of this many points or fewer is called weak (thesis 3.4.5)."""


def funnel(rows: Sequence[DetectionRow], defects: Sequence[DefectRecord], method: str) -> JsonObject:
    """Detections left after each step, and defects found, as a range where several models hold some.

    `surface_hit` and `verified` are null where the rules have no such step.
    """
    reasons = Counter(row.reason for row in rows)
    frame_found = len(rows) - reasons[Reason.NO_FRAME]
    registered = frame_found - sum(reasons[reason] for reason in WITHOUT_VIEW)
    casts_rays = method != "thesis"
    hit = sum(row.reason not in _BEFORE_SURFACE for row in rows)
    verified = sum(row.reason not in (*_BEFORE_SURFACE, Reason.OCCLUDED, Reason.CONTRADICTED) for row in rows)
    return {
        "detections": len(rows),
        "frame_found": frame_found,
        "registered": registered,
        "surface_hit": hit if casts_rays else None,
        "verified": verified if casts_rays else None,
        "mapped": sum(row.outcome == Outcome.MAPPED for row in rows),
        "approximate": sum(row.outcome == Outcome.APPROXIMATE for row in rows),
        "unconfirmed": sum(row.outcome == Outcome.MAPPED and row.defect_id is None for row in rows),
        "defects": len(defects),
        "defects_at_least": least_defects(record.model for record in defects),
    }


def losses(rows: Sequence[DetectionRow]) -> list[JsonObject]:
    """Detections without a mapped place by reason, most frequent first, with the share of all detections."""
    counts = Counter(row.reason for row in rows if row.reason)
    return [
        {"reason": reason, "meaning": REASONS[reason], "detections": count, "share": round(count / len(rows), 4)}
        for reason, count in sorted(counts.items(), key=lambda item: (-item[1], item[0]))
    ]


def support_counts(rows: Sequence[DetectionRow], unique_points: int | None) -> JsonObject:
    """Sparse support points per mapped detection: minimum, mean, maximum; null without a mapped detection."""
    counts = [row.support_points for row in rows if row.outcome == Outcome.MAPPED]
    return {
        "min": min(counts, default=None),
        "mean": round(sum(counts) / len(counts), 2) if counts else None,
        "max": max(counts, default=None),
        "unique": unique_points,
        "detections_with_20_or_fewer": sum(count <= FEW_SUPPORT_POINTS for count in counts),
    }
