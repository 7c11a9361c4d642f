"""What was understood of an annotation file, for people (`bladeatlas check`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from core.annotations.checks import shown
from core.annotations.clocks import MEANINGS
from core.annotations.convention import Fitted
from core.annotations.model import Annotations
from core.annotations.placed import PlacedAnnotations
from core.annotations.reading import Reading


def advice(fitted: Fitted) -> list[str]:
    """One sentence for each ambiguity of the time keys; none for a file that leaves none, or whose reading is told."""
    if fitted.forced:
        return []
    one, said = fitted.reading, []
    if fitted.ambiguous:
        said.append(_ambiguous(one, fitted.others))
    if one.blurred:
        said.append(
            f"the time keys have too few decimals to tell frames apart: {len(one.blurred)} of {len(one.frames)} may "
            f"mean a frame beside the one taken, such as {shown(one.blurred[0])}; write more decimals or frame numbers"
        )
    if one.strays:
        said.append(
            f"{len(one.strays)} of {len(one.frames)} time keys are no time of a frame, such as "
            f"{shown(one.strays[0])}; the nearest frame was taken"
        )
    if one.clock == "displayed":
        said.append(
            "the time keys are no times of frames by any reading; the frame on the screen was taken "
            "(input.time_convention can say what they mean)"
        )
    return said


def _ambiguous(taken: Reading, others: tuple[Reading, ...]) -> str:
    differing = [key for key in taken.frames if any(one.frames[key] != taken.frames[key] for one in others)]
    key = differing[-1]
    ways = [f"{one.clock} ({MEANINGS[one.clock]}: {_frame(one, key)})" for one in (taken, *others)]
    return (
        f"the time keys fit {len(ways)} readings that mean different frames, here of key {shown(key)}: "
        f"{', or '.join(ways)}. {taken.clock} was taken; set input.time_convention to the one that is meant"
    )


def _frame(one: Reading, key: str) -> str:
    frame = one.frames[key]
    return "outside the video" if frame is None else f"frame {frame}"


_BOXES = "boxes are [left, upper, right, lower] and polygons [x, y], both as shares of the whole source frame"
_SHOWN = 10


@dataclass(frozen=True)
class AnnotationSummary:
    """Counts and oddities; times in seconds from the first frame."""

    format: str
    """Of the file, as `--format` takes it."""
    n_keys: int
    n_keys_with_detections: int
    n_detections: int
    detections_by_label: dict[str, int]
    n_masks: int
    masks_by_label: dict[str, int]
    n_with_polygon: int
    """Detections that have an outline, their own or that of a mask."""
    n_with_track: int
    first_time_s: float | None
    last_time_s: float | None
    convention: str
    n_keys_outside_video: int | None
    """None when no video was given."""
    time_convention: dict[str, object] | None
    """How the time keys were read, as in `quality.json`; None when no video was given."""
    n_annotated_frames: int | None
    """Source frames with a detection; None when no video was given."""
    n_warnings: int
    warnings: tuple[str, ...]
    """The first few."""

    def to_dict(self) -> dict[str, object]:
        """JSON form."""
        return {**self.__dict__, "warnings": list(self.warnings)}


def summarise(annotations: Annotations, placed: PlacedAnnotations | None = None) -> AnnotationSummary:
    """Summarise checked annotations, with their frames when the video is known."""
    detections = annotations.detections
    first, last = _interval(annotations, placed)
    warnings = list(annotations.warnings)
    if placed is not None:
        warnings = advice(placed.convention) + warnings
        warnings += [f"key {key!r} lies outside the video" for key in placed.keys_outside]
    return AnnotationSummary(
        format=annotations.format,
        n_keys=len(annotations.entries),
        n_keys_with_detections=sum(bool(entry.detections) for entry in annotations.entries),
        n_detections=len(detections),
        detections_by_label=_counts(d.label for d in detections),
        n_masks=sum(len(entry.masks) for entry in annotations.entries),
        masks_by_label=_counts(mask.label for entry in annotations.entries for mask in entry.masks),
        n_with_polygon=sum(d.polygon is not None for d in detections),
        n_with_track=sum(d.track_id is not None for d in detections),
        first_time_s=first,
        last_time_s=last,
        convention=f"keys are {MEANINGS['pts' if placed is None else placed.convention.reading.clock]}; {_BOXES}",
        n_keys_outside_video=None if placed is None else len(placed.keys_outside),
        time_convention=None if placed is None else placed.convention.to_dict(),
        n_annotated_frames=None if placed is None else n_annotated_frames(placed),
        n_warnings=len(warnings),
        warnings=tuple(warnings[:_SHOWN]),
    )


def _interval(annotations: Annotations, placed: PlacedAnnotations | None) -> tuple[float | None, float | None]:
    """First and last time, s: of the keys where they are seconds from the first frame, else of their frames."""
    if placed is not None and placed.convention.reading.clock not in ("pts", "displayed"):
        first, last = placed.convention.first, placed.convention.last
        return (first.time_s if first else None), (last.time_s if last else None)
    times = [entry.time for entry in annotations.entries]
    return (float(min(times)), float(max(times))) if times else (None, None)


def n_annotated_frames(placed: PlacedAnnotations) -> int:
    """How many source frames carry a detection."""
    return len({d.source_index for d in placed.detections} - {None})


def _counts(labels: Iterable[str]) -> dict[str, int]:
    return dict(sorted(Counter(labels).items()))
