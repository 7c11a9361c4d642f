"""What an annotation file says, typed. Coordinates are shares of the source frame's width and height."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from core.geometry.boxes import Box

Polygon = tuple[tuple[float, float], ...]
"""At least three corners (x, y)."""


@dataclass(frozen=True)
class Mask:
    """A labelled region; `blade` masks mark what the surface may support."""

    label: str
    polygon: Polygon


@dataclass(frozen=True)
class Detection:
    """One detection of the input, in input order."""

    id: int
    key: str
    """Time key, verbatim."""
    time: Fraction
    """Seconds from the first frame."""
    label: str
    score: float | None
    box: Box
    polygon: Polygon | None
    """Its own, or that of the mask that fits it."""
    track_id: str | int | None


@dataclass(frozen=True)
class Entry:
    """Everything at one time key."""

    key: str
    time: Fraction
    detections: tuple[Detection, ...]
    masks: tuple[Mask, ...]


@dataclass(frozen=True)
class Annotations:
    """A whole file. `entries` are in input order."""

    entries: tuple[Entry, ...] = ()
    warnings: tuple[str, ...] = ()
    """Oddities that were tolerated, each naming its place."""
    left_out: tuple[str, ...] = ()
    """What the file holds and nobody reads, one sentence for each kind; `warnings` has these as well."""
    format: str = "bladeatlas"
    """Name of the format that the file was of."""
    n_frames: int | None = None
    """Frames of the video as the tool that wrote the file counted them; None when it does not say."""
    clocks: tuple[str, ...] = ()
    """Clocks that the keys can follow by the format (`core.annotations.clocks`); none = any."""

    @property
    def detections(self) -> tuple[Detection, ...]:
        """All detections, by id."""
        return tuple(d for entry in self.entries for d in entry.detections)
