"""Detections and rows for tests: plain values, everything that a test does not name is ordinary."""

from __future__ import annotations

from typing import Any

from core.scene.defect import MODEL_UNIT, DefectRecord, Extent, Persistence
from core.scene.detection import Detection, DetectionRow, Reason, mapped_row, unplaced_row
from core.scene.frame import Frame, Role, RunFrames

Box = tuple[float, float, float, float]


def detection(
    number: int = 0,
    time_s: float = 1.0,
    box: Box = (0.4, 0.4, 0.6, 0.6),
    source_index: int | None = 10,
    label: str = "dent",
    score: float | None = 0.9,
) -> Detection:
    return Detection(number, f"{time_s:.4f}", time_s, label, score, box, source_index=source_index)


def mapped(
    number: int,
    place: tuple[float, float, float],
    time_s: float = 1.0,
    label: str = "dent",
    frame: int = 0,
    score: float | None = 0.9,
) -> DetectionRow:
    return mapped_row(detection(number, time_s, label=label, score=score), frame, place, 12)


def unplaced(number: int, reason: str = "no_support", **more: object) -> DetectionRow:
    return unplaced_row(detection(number, **more), Reason(reason))  # type: ignore[arg-type]


def run_frames(count: int, step_s: float = 0.1, every: int = 1) -> RunFrames:
    """Frames `step_s` apart, each being the `every`-th of the video."""
    return RunFrames(tuple(Frame(i, every * i, i, step_s * i, "", Role.BOTH) for i in range(count)))


def defect(number: int, label: str = "dent", **more: Any) -> DefectRecord:
    """A defect that one detection of the same number shows, in one of two views."""
    values: dict[str, Any] = {
        "labels": {label: 1},
        "model": 0,
        "centroid": (1.0, 2.0, 3.0),
        "extent": Extent(0.5, MODEL_UNIT, 0.0625),
        "confidence": None,
        "persistence": Persistence(1, 2),
        "events": (number,),
        "detections": (number,),
        "frames": (),
        "faces": (),
    }
    return DefectRecord(id=number, label=label, **{**values, **more})
