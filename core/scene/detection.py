"""A detection of the annotation file, and the row that says what became of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from typing import Any

from core.geometry.boxes import Box
from core.json_files import JsonObject
from core.scene.frame import SourceFrame
from core.scene.on_row import NOT_ON_A_ROW, ROW_COLUMNS, RowColumns
from core.scene.size import LengthUnit, SizeFrom
from core.videos import moment

Polygon = tuple[tuple[float, float], ...]
"""At least three corners (x, y)."""


@dataclass(frozen=True)
class Mask:
    """A labelled region; `blade` masks mark what the surface may support."""

    label: str
    polygon: Polygon
    """In shares of the source frame."""


@dataclass(frozen=True)
class Detection:
    """One detection of the annotation file; coordinates are shares of the source frame's width and height."""

    id: int
    """0-based, in input order."""
    key: str
    """Time key of the input, verbatim."""
    time_s: float
    """Seconds from the first frame; until a detection is put on frames, the number that its key spells."""
    label: str
    score: float | None
    box: Box
    """x1, y1, x2, y2."""
    polygon: Polygon | None = None
    """Its own outline, or that of the mask that fits it."""
    track_id: str | int | None = None
    source_index: int | None = None
    """Decoded frame of its video that shows it; None where the key lies outside the video, or is not yet put on it."""
    video: int = 0
    """Number of the video that its file is of, from 0 in the order given."""

    @property
    def source(self) -> SourceFrame | None:
        """The frame of which video shows it; None where none does."""
        return None if self.source_index is None else SourceFrame(self.video, self.source_index)

    @property
    def moment_s(self) -> float:
        """Its time on the one axis of all videos (`core.videos.moment`)."""
        return moment(self.video, self.time_s)

    def to_dict(self) -> JsonObject:
        """JSON form, keys in the order of the fields."""
        return dict(self.__dict__)

    @classmethod
    def from_dict(cls, row: JsonObject) -> Detection:
        """From the JSON form."""
        x1, y1, x2, y2 = (float(value) for value in row["box"])
        polygon = row.get("polygon")
        outline = None if polygon is None else tuple((float(x), float(y)) for x, y in polygon)
        return cls(**{**row, "box": (x1, y1, x2, y2), "polygon": outline})


class Outcome(StrEnum):
    """What became of a detection."""

    MAPPED = "mapped"
    APPROXIMATE = "approximate"
    """Its place is an estimate."""
    UNPLACED = "unplaced"


class Reason(StrEnum):
    """Why a detection is not mapped."""

    NO_FRAME = "no_frame"
    NO_REGISTERED_VIEW = "no_registered_view"
    FRAME_NOT_REGISTERED = "frame_not_registered"
    OUTSIDE_ROI = "outside_roi"
    NO_SUPPORT = "no_support"
    OFF_SURFACE = "off_surface"
    OCCLUDED = "occluded"
    CONTRADICTED = "contradicted"


class PlacementMethod(StrEnum):
    """How the place of a detection was found; published as the column `rung`."""

    SURFACE = "surface"
    """Its pixels were cast onto the supported surface."""
    DEPTH = "depth"
    """From the depth map of its own frame."""
    SPARSE = "sparse"
    """From the sparse points in its box; the only method of the thesis."""
    PROPAGATED = "propagated"
    """Its pixels were carried into a registered frame by matches."""
    INTERPOLATED = "interpolated"
    """Cast from a pose between two registered frames."""


REASONS: Mapping[Reason, str] = {
    Reason.NO_FRAME: "the time of the detection lies outside the video",
    Reason.NO_REGISTERED_VIEW: "no registered image is near enough in time",
    Reason.FRAME_NOT_REGISTERED: "the frame of the detection was used but could not be registered",
    Reason.OUTSIDE_ROI: "the box lies outside the region of interest",
    Reason.NO_SUPPORT: "no keypoint with a 3D point lies inside the box",
    Reason.OFF_SURFACE: "the place found is not on the surface",
    Reason.OCCLUDED: "another part of the surface hides the place",
    Reason.CONTRADICTED: "other views of the place show no such detection",
}
"""What each reason means, for people."""


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
    reason: Reason | None
    """Why it is not mapped, as a code; empty when it is."""
    rung: PlacementMethod | None
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
    """Blade that it lies on, where the row of blades is known; `1-B4` is blade 4 of model 1 where its number on the
    first model's row is not known."""
    defect_id: int | None
    """Record of defects.json that it belongs to."""
    model: int | None
    """Number of the model whose world frame holds the place."""
    video: int = 0
    """Number of the video that its key is of, from 0 in the order given."""
    length: float | None = None
    """Largest extent along the surface by this outline alone, in `length_unit`; only of the best views of a defect."""
    length_sigma: float | None = None
    """Standard deviation of the length."""
    width: float | None = None
    """Extent along the surface across the length, in `length_unit`."""
    width_sigma: float | None = None
    """Standard deviation of the width."""
    area: float | None = None
    """Area of the surface inside the outline, in the square of `length_unit`."""
    area_sigma: float | None = None
    """Standard deviation of the area."""
    length_unit: LengthUnit | None = None
    """`mm` where a scale is known, else `model`: the unit of the model's coordinates; empty without any length."""
    size_from: SizeFrom | None = None
    """What the outline is known from: `mask`, or `box` for the ellipse in the box."""
    on_row: RowColumns = NOT_ON_A_ROW
    """Columns of where on its blade it lies."""

    @property
    def moment_s(self) -> float:
        """Its time on the one axis of all videos (`core.videos.moment`)."""
        return moment(self.video, self.time_s)

    @property
    def box(self) -> Box:
        """x1, y1, x2, y2 in shares of the source frame."""
        return (self.box_x1, self.box_y1, self.box_x2, self.box_y2)

    def to_dict(self) -> JsonObject:
        """Flat JSON form, keys in the order of the columns."""
        own = {name: value for name, value in self.__dict__.items() if name != "on_row"}
        return {**own, **asdict(self.on_row)}

    @classmethod
    def from_dict(cls, row: JsonObject) -> DetectionRow:
        """From the JSON form; ValueError for an outcome, reason or method that is not known."""
        reason, method = row["reason"], row["rung"]
        enums = {
            "outcome": Outcome(row["outcome"]),
            "reason": None if reason is None else Reason(reason),
            "rung": None if method is None else PlacementMethod(method),
            "length_unit": None if row.get("length_unit") is None else LengthUnit(row["length_unit"]),
            "size_from": None if row.get("size_from") is None else SizeFrom(row["size_from"]),
        }
        own = {name: value for name, value in row.items() if name not in ROW_COLUMNS}
        return cls(**{**own, **enums}, on_row=RowColumns.from_dict(row))


DETECTION_COLUMNS: tuple[str, ...] = (
    *(field.name for field in fields(DetectionRow) if field.name != "on_row"),
    *ROW_COLUMNS,
)
"""Columns of ``mapping/detections.csv``."""


def _row(detection: Detection, **found: Any) -> DetectionRow:
    x1, y1, x2, y2 = detection.box
    values: JsonObject = {
        "id": detection.id,
        "key": detection.key,
        "time_s": detection.time_s,
        "label": detection.label,
        "score": detection.score,
        **{"box_x1": x1, "box_y1": y1, "box_x2": x2, "box_y2": y2},
        **dict.fromkeys(("frame_index", "reason", "rung", "x", "y", "z", "confidence", "blade", "defect_id", "model")),
        "support_points": 0,
        "video": detection.video,
    }
    return DetectionRow(**{**values, **found})


def mapped_row(
    detection: Detection,
    frame_index: int,
    centroid: Sequence[float],
    support_points: int,
    rung: PlacementMethod = PlacementMethod.SPARSE,
    model: int = 0,
) -> DetectionRow:
    """Row of a placed detection; `centroid` is its place in the world frame of `model`."""
    x, y, z = (float(value) for value in centroid)
    return _row(
        detection,
        frame_index=frame_index,
        outcome=Outcome.MAPPED,
        rung=PlacementMethod(rung),
        support_points=support_points,
        **{"x": x, "y": y, "z": z},
        model=model,
    )


def approximate_row(
    detection: Detection,
    frame_index: int | None,
    place: Sequence[float],
    rung: PlacementMethod,
    reason: Reason,
    model: int = 0,
) -> DetectionRow:
    """Row of a detection whose place is an estimate; `reason` says why it is not mapped."""
    x, y, z = (float(value) for value in place)
    return _row(
        detection,
        frame_index=frame_index,
        outcome=Outcome.APPROXIMATE,
        reason=Reason(reason),
        rung=PlacementMethod(rung),
        **{"x": x, "y": y, "z": z},
        model=model,
    )


def unplaced_row(detection: Detection, reason: Reason, frame_index: int | None = None) -> DetectionRow:
    """Row of a detection without a place; ValueError for a reason that is not known."""
    return _row(detection, outcome=Outcome.UNPLACED, reason=Reason(reason), frame_index=frame_index)


def rows_without_model(
    detections: Sequence[Detection], index_of_source: Mapping[SourceFrame, int] | None = None
) -> list[DetectionRow]:
    """Rows for a run that has no model: every detection unplaced, none dropped.

    `index_of_source` gives the row of frames.csv of every source frame that took part in the search.
    """
    rows = []
    for detection in detections:
        source = detection.source
        frame = (index_of_source or {}).get(source) if source is not None else None
        if source is None:
            rows.append(unplaced_row(detection, Reason.NO_FRAME))
        elif frame is not None:
            rows.append(unplaced_row(detection, Reason.FRAME_NOT_REGISTERED, frame))
        else:
            rows.append(unplaced_row(detection, Reason.NO_REGISTERED_VIEW))
    return rows


def outcome_counts(rows: Sequence[DetectionRow]) -> dict[str, dict[str, int]]:
    """Rows by outcome and by reason, keys sorted."""
    outcomes = Counter(row.outcome for row in rows)
    reasons = Counter(row.reason for row in rows if row.reason)
    return {"outcomes": dict(sorted(outcomes.items())), "reasons": dict(sorted(reasons.items()))}


def leading_label(rows: Sequence[DetectionRow]) -> str:
    """The most frequent label; among equals the one with the higher sum of scores, then by alphabet."""
    counts = Counter(row.label for row in rows)
    scores: Counter[str] = Counter()
    for row in rows:
        scores[row.label] += row.score or 0.0  # type: ignore[assignment]  # Counter adds floats as well
    return min(counts, key=lambda label: (-counts[label], -scores[label], label))
