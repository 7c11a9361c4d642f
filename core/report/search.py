"""The window search in numbers: strongest and weakest cases, and what refinement gained."""

from __future__ import annotations

from collections.abc import Sequence

from core.report.record import Cell, Row

WEAK_IMAGES = 80
WEAK_POINTS = 25_000
WEAK_SHARE = 0.5
"""A case is weak below these registered images or points (thesis 3.4.5), or this share of its frames."""


def score(row: Row) -> tuple[int, int]:
    """S(M) = (registered images, 3D points), compared in this order (thesis 3.3.3)."""
    return int(row["registered_images"] or 0), int(row["points3D"] or 0)


def best_case(cases: Sequence[Row], kind: str) -> Row | None:
    """The case of a kind with the highest score, the first by name among equals; None when none has a model."""
    candidates = [row for row in cases if row["kind"] == kind and row["status"] == "succeeded"]
    return max(candidates, key=score, default=None)


def spread(cases: Sequence[Row], kind: str) -> dict[str, int | None]:
    """Number of cases of a kind and the range of their models' sizes; null where no case has a model."""
    found = [row for row in cases if row["kind"] == kind and row["status"] == "succeeded"]
    images, points = [score(row)[0] for row in found], [score(row)[1] for row in found]
    return {
        "cases": sum(row["kind"] == kind for row in cases),
        "without_model": sum(row["kind"] == kind and row["status"] != "succeeded" for row in cases),
        "registered_images_min": min(images, default=None),
        "registered_images_max": max(images, default=None),
        "points3D_min": min(points, default=None),
        "points3D_max": max(points, default=None),
    }


def refinement_gain(cases: Sequence[Row]) -> dict[str, Cell] | None:
    """Best refined against best coarse case, absolute and in percent; None unless both exist."""
    coarse, refined = best_case(cases, "coarse"), best_case(cases, "refine")
    if coarse is None or refined is None:
        return None
    (images, points), (more_images, more_points) = score(coarse), score(refined)
    return {
        "coarse": coarse["name"],
        "refined": refined["name"],
        "registered_images": more_images - images,
        "registered_images_percent": _percent(more_images - images, images),
        "points3D": more_points - points,
        "points3D_percent": _percent(more_points - points, points),
    }


def _percent(gain: int, base: int) -> float | None:
    return round(100.0 * gain / base, 1) if base else None


def weak_cases(cases: Sequence[Row]) -> dict[str, object]:
    """Cases that would not carry an inspection, each with why; and the thesis's two counts."""
    weak = [{"name": row["name"], "why": why, **_size(row)} for row in cases if (why := _weakness(row))]
    images = sum(score(row)[0] < WEAK_IMAGES for row in cases)
    points = sum(score(row)[1] < WEAK_POINTS for row in cases)
    return {"cases": weak, "fewer_than_80_images": images, "fewer_than_25000_points": points, "of": len(cases)}


def _size(row: Row) -> dict[str, Cell]:
    return {name: row[name] for name in ("status", "registered_images", "frames", "points3D")}


def _weakness(row: Row) -> str:
    images, points = score(row)
    if row["status"] != "succeeded":
        return str(row["reason"] or row["status"])
    if images < WEAK_SHARE * int(row["frames"] or 0):
        return "fewer than half of its frames registered"
    if images < WEAK_IMAGES and points < WEAK_POINTS:
        return "few images and few points"
    return ""
