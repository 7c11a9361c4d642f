"""The thesis's placement of detections (3.3.5): nearest registered image in time, sparse points in the box."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import Box
from core.geometry.nearest import nearest_index
from core.mapping.rows import Detection, DetectionRow, mapped_row, unplaced_row
from core.mapping.support import SparseModel, box_in_crop_px, overlaps_crop
from core.roi import Crop
from core.settings.groups import MappingSettings

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True)
class FrameTimes:
    """Which frames took part, when each was seen, and which of them are registered."""

    index: I64
    """(n,) rows of frames.csv."""
    source_index: I64
    """(n,) decoded frames of the video."""
    time_s: F64
    """(n,) by the chosen time rule."""
    registered: NDArray[np.bool_]
    """(n,)"""

    @classmethod
    def from_rows(
        cls, rows: Sequence[Mapping[str, Any]], registered: Sequence[int], rule: str, average_rate: str
    ) -> FrameTimes:
        """From ``frames.json`` and ``registered.json``.

        `rule` is ``pts`` (presentation time) or ``average_rate`` (source index / rate, the thesis's way);
        `average_rate` is the probe's "num/den" in frames per second.
        """
        source = np.array([row["source_index"] for row in rows], dtype=np.int64)
        if rule == "average_rate":
            time_s = source / float(Fraction(average_rate))
        else:
            time_s = np.array([row["time_s"] for row in rows], dtype=np.float64)
        index = np.array([row["index"] for row in rows], dtype=np.int64)
        return cls(index, source, time_s, np.isin(index, np.array(registered, dtype=np.int64)))


@dataclass(frozen=True)
class Placement:
    """Row of a detection and the sparse points that support it (empty when unplaced)."""

    row: DetectionRow
    point_ids: I64
    positions: F64
    """(n, 3) world coordinates of the points."""


def match_frames(detections: Sequence[Detection], frames: FrameTimes, tolerance_s: float) -> dict[int, int]:
    """Frame index used for each detection id: the registered image nearest in time, nearer than the tolerance.

    Detections outside the video and those without such an image are absent. Of two equally near images the
    earlier one is taken.
    """
    order = np.flatnonzero(frames.registered)
    order = order[np.argsort(frames.time_s[order], kind="stable")]
    asked = [d for d in detections if d.source_index is not None]
    if not len(order) or not asked:
        return {}
    times = frames.time_s[order].tolist()
    nearest = [nearest_index(times, d.time_s) for d in asked]
    return {
        d.id: int(frames.index[order[k]])
        for d, k in zip(asked, nearest, strict=True)
        if abs(times[k] - d.time_s) < tolerance_s
    }


def place_detections(
    detections: Sequence[Detection],
    frames: FrameTimes,
    crop: Crop,
    settings: MappingSettings,
    read_model: Callable[[Sequence[int]], SparseModel],
) -> list[Placement]:
    """Place every detection by the thesis's rules; one placement per detection, in input order.

    Args:
        detections: of the annotation file.
        frames: the frame table with its registered images.
        crop: from source to exported frames.
        settings: time tolerance, box frame.
        read_model: gives the observations of the frame indices it is called with.
    """
    used = match_frames(detections, frames, settings.time_tolerance_s)
    model = read_model(sorted(set(used.values())))
    own = dict(zip(frames.source_index.tolist(), frames.index.tolist(), strict=True))
    knows_own_frame = settings.time_rule == "pts"
    placements = []
    for detection in detections:
        frame = used.get(detection.id)
        if frame is None:
            own_frame = own.get(detection.source_index) if knows_own_frame else None
            placements.append(_unplaced(detection, own_frame))
        else:
            box_px = box_in_crop_px(detection.box, crop, settings.box_frame)
            placements.append(_in_box(detection, frame, box_px, crop, model))
    return placements


def _unplaced(detection: Detection, own_frame: int | None) -> Placement:
    """No image near in time; says so more exactly where the detection's own frame took part."""
    if detection.source_index is None:
        return _without(unplaced_row(detection, "no_frame"))
    if own_frame is not None:
        return _without(unplaced_row(detection, "frame_not_registered", own_frame))
    return _without(unplaced_row(detection, "no_registered_view"))


def _in_box(detection: Detection, frame: int, box_px: Box, crop: Crop, model: SparseModel) -> Placement:
    if not overlaps_crop(box_px, crop):
        return _without(unplaced_row(detection, "outside_roi", frame))
    ids = model.observations[frame].inside(box_px)
    if not len(ids):
        return _without(unplaced_row(detection, "no_support", frame))
    positions = model.points(ids)
    return Placement(mapped_row(detection, frame, positions.mean(axis=0), len(ids)), ids, positions)


def _without(row: DetectionRow) -> Placement:
    return Placement(row, np.zeros(0, np.int64), np.zeros((0, 3)))
