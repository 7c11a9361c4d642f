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
    return cells_of(one.name, review_values(one))


def review_values(one: ReviewedFinding) -> JsonObject:
    """The same nested, for JSON: of a finding that people made, label and place are theirs too."""
    place, label = human_place(one), one.review.label
    made = one.target.label if one.target.kind == TargetKind.ADDED else None
    values = {"label": made if label is None else label, "point": None if place is None else list(place)}
    return {**one.review.to_dict(), **values}


def cells_of(name: str | None, values: JsonObject | None) -> JsonObject:
    """The cells of what `review_values` gave; all empty for a row that belongs to no finding."""
    if values is None:
        return dict.fromkeys(REVIEW_COLUMNS)
    x, y, z = values["point"] or (None, None, None)
    measure = values["measures"][-1] if values["measures"] else {}
    return {
        "finding": name,
        "review_state": values["state"],
        "review_reason": values["reason"],
        "human_label": values["label"],
        "human_blade": values["blade"],
        "severity": values["severity"],
        "human_x": x,
        "human_y": y,
        "human_z": z,
        "human_length": measure.get("length"),
        "human_length_sigma": measure.get("sigma"),
        "human_length_unit": measure.get("unit"),
        "merged_into": values["merged_into"],
        "notes": "\n".join(note["text"] for note in values["notes"]) or None,
        "reviewed_by": values["by"],
        "reviewed_at": values["time"],
    }


def human_place(one: ReviewedFinding) -> tuple[float, float, float] | None:
    """Where people say that a finding lies, in the world frame of its model; None where only the method says it."""
    if one.review.point is not None:
        return one.review.point
    return one.target.centroid if one.target.kind == TargetKind.ADDED else None
