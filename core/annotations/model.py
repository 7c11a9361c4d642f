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

    @property
    def detections(self) -> tuple[Detection, ...]:
        """All detections, by id."""
        return tuple(d for entry in self.entries for d in entry.detections)
