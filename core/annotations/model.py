"""What an annotation file says, typed: its time keys, each with detections and masks."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from core.scene.detection import Detection, Mask


@dataclass(frozen=True)
class Entry:
    """Everything at one time key."""

    key: str
    """Time key, verbatim."""
    time: Fraction
    """The exact number that it spells, seconds from the first frame unless the file follows another convention."""
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
