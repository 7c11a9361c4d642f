"""What people say of a finding as columns beside the machine's: one declaration for every table that shows both."""

from __future__ import annotations

from core.json_files import JsonObject
from core.review.state import ReviewedFinding
from core.review.words import TargetKind

REVIEW_COLUMNS: tuple[str, ...] = (
    "finding",
    "review_state",
    "review_reason",
    "human_label",
    "human_blade",
    "severity",
    "human_x",
    "human_y",
    "human_z",
    "human_length",
    "human_length_sigma",
    "human_length_unit",
    "merged_into",
    "notes",
    "reviewed_by",
    "reviewed_at",
)
"""Columns that a table has beside the machine's when it is asked for with the review."""


def review_cells(one: ReviewedFinding) -> JsonObject:
    """The cells of a finding by `REVIEW_COLUMNS`; None where nobody said anything. Notes: one a line."""
    review = one.review
    x, y, z = human_place(one) or (None, None, None)
    measure = review.measures[-1] if review.measures else {}
    return {
        "finding": one.name,
        "review_state": review.state,
        "review_reason": review.reason or None,
        "human_label": review.label if review.label is not None else _made_label(one),
        "human_blade": review.blade,
        "severity": review.severity,
        "human_x": x,
        "human_y": y,
        "human_z": z,
        "human_length": measure.get("length"),
        "human_length_sigma": measure.get("sigma"),
        "human_length_unit": measure.get("unit"),
        "merged_into": review.merged_into,
        "notes": "\n".join(note.text for note in review.notes) or None,
        "reviewed_by": review.by or None,
        "reviewed_at": review.time or None,
    }


def human_place(one: ReviewedFinding) -> tuple[float, float, float] | None:
    """Where people say that a finding lies, in the world frame of its model; None where only the method says it."""
    if one.review.point is not None:
        return one.review.point
    return one.target.centroid if one.target.kind == TargetKind.ADDED else None


def nobody_said() -> JsonObject:
    """The cells of a row that belongs to no finding."""
    return dict.fromkeys(REVIEW_COLUMNS)


def _made_label(one: ReviewedFinding) -> str | None:
    return one.target.label if one.target.kind == TargetKind.ADDED else None
