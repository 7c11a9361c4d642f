"""Detections that a sparse model verifies: what a case is worth to the inspection, before it has a surface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING

from core.geometry.boxes import Box
from core.mapping.support import observations_of

if TYPE_CHECKING:
    import pycolmap

MIN_POINTS = 3
"""Points in a box that make it more than a chance match, as for `core.mapping.support_check`."""
MIN_VIEWS = 3
"""Views that must agree on a point; two rays nearly always meet somewhere."""


def verified_detections(model: pycolmap.Reconstruction, boxes: Mapping[int, Sequence[tuple[Box, str]]]) -> int:
    """How many boxes hold points of the model that other views confirm.

    Args:
        model: its image_id = frame index + 1.
        boxes: crop pixels and label by frame index, see `core.mapping.support.boxes_by_frame`; those of frames that
            are not registered count as not verified.
    """
    registered = set(model.reg_image_ids())

    @cache
    def views(point: int) -> int:
        return len({element.image_id for element in model.point3D(point).track.elements})

    count = 0
    for frame, found in boxes.items():
        if not found or frame + 1 not in registered:
            continue
        seen = observations_of(model.image(frame + 1))
        for box, _ in found:
            confirmed = sum(views(point) >= MIN_VIEWS for point in seen.inside(box).tolist())
            count += confirmed >= MIN_POINTS
    return count
