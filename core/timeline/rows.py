"""One row per event: the columns of the published timeline."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class EventRow:
    """One row of ``mapping/timeline.csv``; the fields are its columns, in order."""

    event_id: int
    """Number of the event, by its start."""
    defect_id: int
    """Record of defects.json that it is a visit to."""
    label: str
    """Most frequent label of its detections."""
    start_s: float
    """Time of its first detection, in seconds from the first frame."""
    end_s: float
    """Time of its last detection, in seconds from the first frame."""
    n_detections: int
    """Its detections."""
    n_frames: int
    """Frames that show them."""
    x: float
    """First coordinate of the mean place of its detections, in the world frame of the defect's model."""
    y: float
    """Second coordinate of the mean place."""
    z: float
    """Third coordinate of the mean place."""
    radius: float
    """Largest distance of one of its detections from the mean place, in units of the model."""
    confidence: float | None
    """Probability that the defect is real and its place right."""

    def to_dict(self) -> dict[str, Any]:
        """Flat JSON form, keys in the order of the columns."""
        return asdict(self)


TIMELINE_COLUMNS: tuple[str, ...] = tuple(EventRow.__dataclass_fields__)
