"""From detections to defects: what was lost where, and why (thesis tables 3.4 and section 3.4.5)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from core.json_files import JsonObject
from core.scene.detection import REASONS, DetectionRow, Outcome, Reason

WITHOUT_VIEW = (Reason.NO_REGISTERED_VIEW, Reason.FRAME_NOT_REGISTERED)
_BEFORE_SURFACE = (Reason.NO_FRAME, *WITHOUT_VIEW, Reason.OUTSIDE_ROI, Reason.NO_SUPPORT, Reason.OFF_SURFACE)
FEW_SUPPORT_POINTS = 20
"""Support of this many points or fewer is called weak (thesis 3.4.5)."""


def funnel(rows: Sequence[DetectionRow], n_defects: int, method: str) -> JsonObject:
    """Detections left after each step. `surface_hit` and `verified` are null where the rules have no such step."""
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
        "defects": n_defects,
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
