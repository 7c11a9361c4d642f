"""Detections and rows for tests: plain values, everything that a test does not name is ordinary."""

from __future__ import annotations

from core.mapping.rows import Detection, DetectionRow, mapped_row, unplaced_row

Box = tuple[float, float, float, float]


def detection(
    number: int = 0,
    time_s: float = 1.0,
    box: Box = (0.4, 0.4, 0.6, 0.6),
    source_index: int | None = 10,
    label: str = "dent",
    score: float | None = 0.9,
) -> Detection:
    return Detection(number, f"{time_s:.4f}", time_s, label, score, box, source_index)


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
    return unplaced_row(detection(number, **more), reason)  # type: ignore[arg-type]
