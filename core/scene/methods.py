"""The two interfaces of a mapping method: placing detections, and grouping what was placed into defects."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Generic, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from core.scene.defect import DefectRecord, EventRow
from core.scene.detection import Detection, DetectionRow
from core.scene.size import Scale

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

T = TypeVar("T")

Report = Callable[[float, float, str], None]
"""Called with what is done, the total, and a short message; it raises `Cancelled` to stop."""


@dataclass(frozen=True)
class Support:
    """Sparse points that support detections: one entry per point and detection."""

    detection: I32
    """(n,) ids."""
    point_id: I64
    """(n,)"""
    position: F64
    """(n, 3) in the world frame of the model."""

    @classmethod
    def of(cls, parts: Iterable[tuple[int, I64, F64]]) -> Support:
        """From detection ids, each with its (k,) point ids and their (k, 3) positions, in the given order."""
        found = list(parts)
        return cls(
            np.concatenate([np.zeros(0, np.int32), *(np.full(len(ids), own, np.int32) for own, ids, _ in found)]),
            np.concatenate([np.zeros(0, np.int64), *(ids for _, ids, _ in found)]),
            np.concatenate([np.zeros((0, 3)), *(positions for _, _, positions in found)]),
        )

    @property
    def first(self) -> I64:
        """(m,) entries of the distinct points: of each the first detection that has it."""
        return np.asarray(np.unique(self.point_id, return_index=True)[1], np.int64)


@dataclass(frozen=True)
class Placed:
    """All detections after placing."""

    rows: tuple[DetectionRow, ...]
    """One per detection, in input order, without defects."""
    support: Support


class Placing(Protocol):
    """A way to give detections their places on a model."""

    def place(self, detections: Sequence[Detection], folder: Path) -> Placed:
        """Place all detections of the input.

        Writes the rows below `folder`, and whatever the grouping of the same method reads.
        """
        ...


@dataclass(frozen=True)
class Grouped(Generic[T]):
    """Placed detections as defects of one model."""

    rows: tuple[DetectionRow, ...]
    """One per detection, in input order, each with its defect."""
    events: tuple[EventRow, ...]
    """By start."""
    defects: tuple[DefectRecord, ...]
    """By id."""
    confidences: tuple[Mapping[str, Any], ...]
    """Records of ``mapping/confidence.json``; none by rules that know no confidence."""
    weight: F32
    """(v,) share of the defects' colour in that of every vertex."""
    vertex_defect: I32
    """(v,) defect of every vertex; -1 = none."""
    product: T
    """What the rules count, for the readers of the stage."""
    scale: Scale | None = None
    """Of the model; None while none is known."""


class Grouping(Protocol[T]):
    """A way to tell defects apart."""

    def group(self) -> Grouped[T]:
        """Group the detections that the placing of the same method left."""
        ...
