"""The window search in numbers: strongest and weakest cases, and what refinement gained."""

from __future__ import annotations

from collections.abc import Sequence

from core.json_files import JsonObject
from core.scene.case import CaseKind, CaseRow

WEAK_IMAGES = 80
WEAK_POINTS = 25_000
WEAK_SHARE = 0.5
"""A case is weak below these registered images or points (thesis 3.4.5), or this share of its frames."""


def best_case(cases: Sequence[CaseRow], kind: CaseKind) -> CaseRow | None:
    """The case of a kind with the highest score, the first by name among equals; None when none has a model."""
    candidates = [row for row in cases if row.kind == kind and row.succeeded]
    return max(candidates, key=lambda row: row.score, default=None)


def spread(cases: Sequence[CaseRow], kind: CaseKind) -> JsonObject:
    """Number of cases of a kind and the range of their models' sizes; null where no case has a model."""
    found = [row for row in cases if row.kind == kind and row.succeeded]
    images, points = [row.registered_images for row in found], [row.points3D for row in found]
    return {
        "cases": sum(row.kind == kind for row in cases),
        "without_model": sum(row.kind == kind and not row.succeeded for row in cases),
        "registered_images_min": min(images, default=None),
        "registered_images_max": max(images, default=None),
        "points3D_min": min(points, default=None),
        "points3D_max": max(points, default=None),
    }


def refinement_gain(cases: Sequence[CaseRow]) -> JsonObject | None:
    """Best refined against best coarse case, absolute and in percent; None unless both exist."""
    coarse, refined = best_case(cases, CaseKind.COARSE), best_case(cases, CaseKind.REFINE)
    if coarse is None or refined is None:
        return None
    (images, points), (more_images, more_points) = coarse.score, refined.score
    return {
        "coarse": coarse.name,
        "refined": refined.name,
        "registered_images": more_images - images,
        "registered_images_percent": _percent(more_images - images, images),
        "points3D": more_points - points,
        "points3D_percent": _percent(more_points - points, points),
    }


def _percent(gain: int, base: int) -> float | None:
    return round(100.0 * gain / base, 1) if base else None


def weak_cases(cases: Sequence[CaseRow]) -> JsonObject:
    """Cases that would not carry an inspection, each with why; and the thesis's two counts."""
    weak = [{"name": row.name, "why": why, **_size(row)} for row in cases if (why := _weakness(row))]
    images = sum(row.registered_images < WEAK_IMAGES for row in cases)
    points = sum(row.points3D < WEAK_POINTS for row in cases)
    return {"cases": weak, "fewer_than_80_images": images, "fewer_than_25000_points": points, "of": len(cases)}


def _size(row: CaseRow) -> JsonObject:
    return {
        "status": row.status,
        "registered_images": row.registered_images,
        "frames": row.frames,
        "points3D": row.points3D,
    }


def _weakness(row: CaseRow) -> str:
    images, points = row.score
    if not row.succeeded:
        return str(row.reason or row.status)
    if images < WEAK_SHARE * row.frames:
        return "fewer than half of its frames registered"
    if images < WEAK_IMAGES and points < WEAK_POINTS:
        return "few images and few points"
    return ""
