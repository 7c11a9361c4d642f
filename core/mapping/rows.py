"""One row per detection: the input, its outcome, and the columns of the published table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum
from typing import Any


class Outcome(StrEnum):
    """What became of a detection."""

    MAPPED = "mapped"
    APPROXIMATE = "approximate"
    """Its place is an estimate."""
    UNPLACED = "unplaced"


REASONS: Mapping[str, str] = {
    "no_frame": "the time of the detection lies outside the video",
    "no_registered_view": "no registered image is near enough in time",
    "frame_not_registered": "the frame of the detection was used but could not be registered",
    "outside_roi": "the box lies outside the region of interest",
    "no_support": "no keypoint with a 3D point lies inside the box",
    "off_surface": "the place found is not on the surface",
    "occluded": "another part of the surface hides the place",
    "contradicted": "other views of the place show no such detection",
}
"""Why a detection is not mapped, with its meaning."""


@dataclass(frozen=True)
class Detection:
    """One detection of the annotation file."""

    id: int
    """0-based, in input order."""
    key: str
    """Timestamp string of the input, verbatim."""
    time_s: float
    label: str
    score: float | None
    box: tuple[float, float, float, float]
    """x1, y1, x2, y2, normalised on the source frame."""
    source_index: int | None
    """Decoded frame of the video that shows it; None = the time is outside the video."""
    polygon: tuple[tuple[float, float], ...] | None = None
    """Its mask, corners normalised on the source frame."""
    track_id: str | None = None

    @classmethod
    def from_json(cls, row: Mapping[str, Any]) -> Detection:
        """From one entry of the stage `annotations`' ``detections.json``."""
        x1, y1, x2, y2 = (float(value) for value in row["box"])
        score = row.get("score")
        source_index = row.get("source_index")
        polygon, track = row.get("polygon"), row.get("track_id")
        return cls(
            id=int(row["id"]),
            key=str(row["key"]),
            time_s=float(row["time_s"]),
            label=str(row["label"]),
            score=None if score is None else float(score),
            box=(x1, y1, x2, y2),
            source_index=None if source_index is None else int(source_index),
            polygon=None if polygon is None else tuple((float(x), float(y)) for x, y in polygon),
            track_id=None if track is None else str(track),
        )


@dataclass(frozen=True)
class DetectionRow:
    """One row of ``mapping/detections.csv``; the fields are its columns, in order."""

    id: int
    """Number of the detection, from 0 in input order."""
    key: str
    """Time key of the input, verbatim."""
    time_s: float
    """Seconds from the first frame: the key's where keys are such seconds, else its frame's."""
    label: str
    """Class that the detector gave."""
    score: float | None
    """Score that the detector gave."""
    box_x1: float
    """Left edge of the box, as a share of the source frame's width."""
    box_y1: float
    """Upper edge of the box, as a share of the source frame's height."""
    box_x2: float
    """Right edge of the box, as a share of the source frame's width."""
    box_y2: float
    """Lower edge of the box, as a share of the source frame's height."""
    frame_index: int | None
    """Row of frames.csv that was used, or that shows the detection but is not registered."""
    outcome: Outcome
    """What became of the detection."""
    reason: str | None
    """Why it is not mapped, as a code; empty when it is."""
    rung: str | None
    """How the place was found."""
    support_points: int
    """Sparse points in the box that lie on the surface found; by the thesis's rules all of them."""
    x: float | None
    """First coordinate of the place, in the world frame of `model`."""
    y: float | None
    """Second coordinate of the place."""
    z: float | None
    """Third coordinate of the place."""
    confidence: float | None
    """Probability that the detection is real and its place right."""
    blade: str | None
    """Blade that it lies on; always empty."""
    defect_id: int | None
    """Record of defects.json that it belongs to."""
    model: int | None
    """Number of the model whose world frame holds the place."""

    def to_dict(self) -> dict[str, Any]:
        """Flat JSON form, keys in the order of the columns."""
        return asdict(self)


DETECTION_COLUMNS: tuple[str, ...] = tuple(DetectionRow.__dataclass_fields__)


def _row(detection: Detection, **found: Any) -> DetectionRow:
    x1, y1, x2, y2 = detection.box
    values: dict[str, Any] = {
        "id": detection.id,
        "key": detection.key,
        "time_s": detection.time_s,
        "label": detection.label,
        "score": detection.score,
        **{"box_x1": x1, "box_y1": y1, "box_x2": x2, "box_y2": y2},
        **dict.fromkeys(("frame_index", "reason", "rung", "x", "y", "z", "confidence", "blade", "defect_id", "model")),
        "support_points": 0,
    }
    return DetectionRow(**{**values, **found})


def mapped_row(
    detection: Detection,
    frame_index: int,
    centroid: Sequence[float],
    support_points: int,
    rung: str = "sparse",
    model: int = 0,
) -> DetectionRow:
    """Row of a placed detection; `centroid` is its place in the world frame of `model`."""
    x, y, z = (float(value) for value in centroid)
    return _row(
        detection,
        frame_index=frame_index,
        outcome=Outcome.MAPPED,
        rung=rung,
        support_points=support_points,
        **{"x": x, "y": y, "z": z},
        model=model,
    )


def approximate_row(
    detection: Detection, frame_index: int | None, place: Sequence[float], rung: str, reason: str, model: int = 0
) -> DetectionRow:
    """Row of a detection whose place is an estimate; `reason` is a key of `REASONS` and says why it is not mapped."""
    if reason not in REASONS:
        raise ValueError(f"unknown reason {reason!r}")
    x, y, z = (float(value) for value in place)
    return _row(
        detection,
        frame_index=frame_index,
        outcome=Outcome.APPROXIMATE,
        reason=reason,
        rung=rung,
        **{"x": x, "y": y, "z": z},
        model=model,
    )


def unplaced_row(detection: Detection, reason: str, frame_index: int | None = None) -> DetectionRow:
    """Row of a detection without a place; `reason` is a key of `REASONS`."""
    if reason not in REASONS:
        raise ValueError(f"unknown reason {reason!r}")
    return _row(detection, outcome=Outcome.UNPLACED, reason=reason, frame_index=frame_index)


def rows_without_model(
    detections: Sequence[Detection], index_of_source: Mapping[int, int] | None = None
) -> list[DetectionRow]:
    """Rows for a run that has no model: every detection unplaced, none dropped.

    `index_of_source` gives the row of frames.csv of every source frame that took part in the search.
    """
    rows = []
    for detection in detections:
        frame = (index_of_source or {}).get(-1 if detection.source_index is None else detection.source_index)
        if detection.source_index is None:
            rows.append(unplaced_row(detection, "no_frame"))
        elif frame is not None:
            rows.append(unplaced_row(detection, "frame_not_registered", frame))
        else:
            rows.append(unplaced_row(detection, "no_registered_view"))
    return rows


def outcome_counts(rows: Sequence[DetectionRow]) -> dict[str, dict[str, int]]:
    """Rows by outcome and by reason, keys sorted."""
    outcomes = Counter(row.outcome for row in rows)
    reasons = Counter(row.reason for row in rows if row.reason)
    return {"outcomes": dict(sorted(outcomes.items())), "reasons": dict(sorted(reasons.items()))}
