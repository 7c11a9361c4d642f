"""The thesis's placement of detections (3.3.5): nearest registered image in time, sparse points in the box."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import Box
from core.geometry.nearest import nearest_index
from core.io.annotations import write_rows
from core.mapping.support import SparseModel, box_in_crop_px, overlaps_crop
from core.scene.detection import Detection, DetectionRow, Reason, mapped_row, unplaced_row
from core.scene.frame import Crop, RunFrames
from core.scene.methods import Placed, Report, Support
from core.settings.groups import MappingSettings
from core.surface.ply import Mesh
from core.thesis.coloring import color_by_support, write_coloring

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


@dataclass(frozen=True)
class Placement:
    """Row of a detection and the sparse points that support it (empty when unplaced)."""

    row: DetectionRow
    point_ids: I64
    positions: F64
    """(n, 3) world coordinates of the points."""


@dataclass(frozen=True)
class ThesisPlacing:
    """Placing by sparse support, and each vertex's strongest influence (equations 3.1 and 3.2)."""

    frames: RunFrames
    """Timed by the rule of the settings."""
    registered: Collection[int]
    """Indices of the registered frames."""
    crop: Crop
    settings: MappingSettings
    read_model: Callable[[Sequence[int]], SparseModel]
    """Gives the observations of the frame indices it is called with."""
    read_surface: Callable[[], Mesh]
    threads: int
    report: Report

    def place(self, detections: Sequence[Detection], folder: Path) -> Placed:
        """Place all detections; writes their rows and the influence of their support on the surface."""
        self.report(0, 4, "placing detections")
        placements = place_detections(
            detections, self.frames, self.registered, self.crop, self.settings, self.read_model
        )
        self.report(1, 4, "reading the surface")
        mesh = self.read_surface()
        self.report(2, 4, "colouring the surface")
        supported = sorted((p for p in placements if len(p.point_ids)), key=lambda p: (p.row.moment_s, p.row.id))
        support = Support.of((p.row.id, p.point_ids, p.positions) for p in supported)
        write_coloring(folder, color_by_support(mesh, support, self.settings, self.threads), support)
        rows = tuple(placement.row for placement in placements)
        write_rows(folder, rows)
        return Placed(rows, support)


def match_frames(
    detections: Sequence[Detection], frames: RunFrames, registered: Collection[int], tolerance_s: float
) -> dict[int, int]:
    """Frame index used for each detection id: the registered image nearest in time, nearer than the tolerance.

    Detections outside the video and those without such an image are absent. Of two equally near images the
    earlier one is taken.
    """
    known = set(registered)
    order = sorted(
        (frame for frame in frames if frame.index in known), key=lambda frame: frames.moment_of_index[frame.index]
    )
    asked = [d for d in detections if d.source_index is not None]
    if not order or not asked:
        return {}
    times = [frames.moment_of_index[frame.index] for frame in order]
    nearest = [nearest_index(times, d.moment_s) for d in asked]
    return {
        d.id: order[k].index for d, k in zip(asked, nearest, strict=True) if abs(times[k] - d.moment_s) < tolerance_s
    }


def place_detections(
    detections: Sequence[Detection],
    frames: RunFrames,
    registered: Collection[int],
    crop: Crop,
    settings: MappingSettings,
    read_model: Callable[[Sequence[int]], SparseModel],
) -> list[Placement]:
    """Place every detection by the thesis's rules; one placement per detection, in input order.

    Args:
        detections: of the annotation file.
        frames: of the run, timed by the rule of the settings.
        registered: indices of the registered frames.
        crop: from source to exported frames.
        settings: time tolerance, box frame.
        read_model: gives the observations of the frame indices it is called with.
    """
    used = match_frames(detections, frames, registered, settings.time_tolerance_s)
    model = read_model(sorted(set(used.values())))
    knows_own_frame = settings.time_rule == "pts"
    placements = []
    for detection in detections:
        frame = used.get(detection.id)
        if frame is None:
            source = detection.source
            own_frame = frames.index_of_source.get(source) if knows_own_frame and source is not None else None
            placements.append(_unplaced(detection, own_frame))
        else:
            box_px = box_in_crop_px(detection.box, crop, settings.box_frame)
            placements.append(_in_box(detection, frame, box_px, crop, model))
    return placements


def _unplaced(detection: Detection, own_frame: int | None) -> Placement:
    """No image near in time; says so more exactly where the detection's own frame took part."""
    if detection.source_index is None:
        return _without(unplaced_row(detection, Reason.NO_FRAME))
    if own_frame is not None:
        return _without(unplaced_row(detection, Reason.FRAME_NOT_REGISTERED, own_frame))
    return _without(unplaced_row(detection, Reason.NO_REGISTERED_VIEW))


def _in_box(detection: Detection, frame: int, box_px: Box, crop: Crop, model: SparseModel) -> Placement:
    if not overlaps_crop(box_px, crop):
        return _without(unplaced_row(detection, Reason.OUTSIDE_ROI, frame))
    ids = model.observations[frame].inside(box_px)
    if not len(ids):
        return _without(unplaced_row(detection, Reason.NO_SUPPORT, frame))
    positions = model.points(ids)
    return Placement(mapped_row(detection, frame, positions.mean(axis=0).tolist(), len(ids)), ids, positions)


def _without(row: DetectionRow) -> Placement:
    return Placement(row, np.zeros(0, np.int64), np.zeros((0, 3)))
