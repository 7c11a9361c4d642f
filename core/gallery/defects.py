"""The table of defects: how large each is, when it was seen, and the frame that shows it best; largest first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from core.scene.defect import MODEL_UNIT, DefectRecord, EventRow, Extent, Sighting
from core.scene.frame import RunFrames, SourceFrame

_UNITS: Mapping[str, str] = {MODEL_UNIT: "model units"}
"""Units of an extent as people read them, where that differs."""


class Instant(NamedTuple):
    """A time in one of the videos; in order, instants are those of one video after the other."""

    video: int
    time_s: float


@dataclass(frozen=True)
class BestFrame:
    """The view that shows a defect best: the first of its `frames` in defects.json."""

    source: SourceFrame
    time_s: float
    place: tuple[float, float] | None
    """Where the defect appears, normalised on the source frame; None by rules that do not tell."""


@dataclass(frozen=True)
class DefectLine:
    """One row of the table."""

    number: int
    label: str
    model: int
    size: float | None
    """Length along the surface in `unit`, by the thesis's rules the extent; None = unknown."""
    size_sigma: float | None
    unit: str
    start: Instant | None
    """When it was first seen; None without a visit."""
    end: Instant | None
    """When it was last seen."""
    visits: int
    """Events: times that it came into sight."""
    n_detections: int
    n_frames: int
    """Frames that show a detection of it."""
    n_could_show: int
    """Views that could see it."""
    place: tuple[float, float, float]
    best: BestFrame | None
    """None when no registered view sees it."""

    @property
    def size_text(self) -> str:
        """The size with its standard deviation and unit."""
        if self.size is None:
            return "unknown"
        sigma = "unknown" if self.size_sigma is None else f"{self.size_sigma:.2g}"
        return f"{self.size:.3g} ± {sigma} {_UNITS.get(self.unit, self.unit)}"


def defect_lines(records: Sequence[DefectRecord], events: Sequence[EventRow], frames: RunFrames) -> list[DefectLine]:
    """Rows of the table, by size: the largest first, unknown sizes last, equal ones by number.

    Args:
        records: of all models.
        events: of all models.
        frames: of the run.
    """
    lines = [_line(record, [e for e in events if e.defect_id == record.id], frames) for record in records]
    return sorted(lines, key=lambda line: (line.size is None, -(line.size or 0.0), line.number))


def _line(record: DefectRecord, visits: Sequence[EventRow], frames: RunFrames) -> DefectLine:
    extent = _size(record)
    return DefectLine(
        number=record.id,
        label=record.label,
        model=record.model,
        size=extent.value,
        size_sigma=extent.sigma,
        unit=extent.unit,
        start=min((Instant(event.video, event.start_s) for event in visits), default=None),
        end=max((Instant(event.video, event.end_s) for event in visits), default=None),
        visits=len(visits),
        n_detections=len(record.detections),
        n_frames=record.persistence.k,
        n_could_show=record.persistence.n,
        place=record.centroid,
        best=_best(record.frames, frames),
    )


def _size(record: DefectRecord) -> Extent:
    """Its length along the surface; by rules that measure none, its extent."""
    if record.size is None:
        return record.extent or Extent(None, MODEL_UNIT, None)
    length = record.size.length
    value, sigma = (None, None) if length is None else (length.value, length.sigma)
    return Extent(value, record.size.unit, sigma)


def _best(views: Sequence[Sighting], frames: RunFrames) -> BestFrame | None:
    if not views:
        return None
    frame = frames[views[0].frame_index]
    return BestFrame(frame.source, frame.time_s, views[0].at)
