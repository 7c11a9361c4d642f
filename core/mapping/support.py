"""Boxes in pixels of the exported frames, and the sparse 3D points seen inside them (thesis 3.3.5)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import cv2  # noqa: F401  # must be loaded before pycolmap: the other order aborts in PNG writing
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.geometry.boxes import Box, in_box
from core.io.sparse import open_model
from core.scene.detection import Detection
from core.scene.frame import Crop, SourceFrame

if TYPE_CHECKING:
    import pycolmap

MIN_POINTS = 3
"""Points in a box that make it more than a chance match, as for `core.mapping.casting`."""
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


F64 = NDArray[np.float64]
I64 = NDArray[np.int64]


def box_in_crop_px(box: Box, crop: Crop, box_frame: Literal["source", "crop"]) -> Box:
    """A normalised box in pixels of the exported frame (pixel centres at 0.5); it may reach beyond the frame.

    `source` undoes the normalisation on the source frame and shifts by the crop offset. `crop` scales the
    numbers to the cropped image instead, as the thesis appears to do, which misplaces every box.
    """
    x1, y1, x2, y2 = box
    if box_frame == "crop":
        return (x1 * crop.width, y1 * crop.height, x2 * crop.width, y2 * crop.height)
    width, height = crop.source_width, crop.source_height
    return (x1 * width - crop.x0, y1 * height - crop.y0, x2 * width - crop.x0, y2 * height - crop.y0)


def boxes_by_frame(
    detections: Sequence[Detection],
    looked: Iterable[SourceFrame],
    index_of_source: Mapping[SourceFrame, int],
    crop: Crop,
) -> dict[int, list[tuple[Box, str]]]:
    """Boxes (crop pixels) and labels by frame index, for all frames that the detector saw.

    Args:
        detections: of the annotation file.
        looked: source frames with an entry in it, with detections or without.
        index_of_source: row of frames.csv of each source frame that took part.
        crop: of the exported frames.
    """
    found: dict[int, list[tuple[Box, str]]] = {}
    for source in looked:
        if source in index_of_source:
            found.setdefault(index_of_source[source], [])
    for detection in detections:
        index = None if detection.source is None else index_of_source.get(detection.source)
        if index is not None:
            found.setdefault(index, []).append((box_in_crop_px(detection.box, crop, "source"), detection.label))
    return dict(sorted(found.items()))


def overlaps_crop(box_px: Box, crop: Crop) -> bool:
    """Whether any part of a box in crop pixels lies on the exported frame."""
    x1, y1, x2, y2 = box_px
    return x1 < crop.width and y1 < crop.height and x2 > 0 and y2 > 0


@dataclass(frozen=True)
class Observations:
    """Keypoints of one registered image that carry a 3D point."""

    xy: F64
    """(n, 2) crop pixels."""
    point_ids: I64
    """(n,)"""

    def inside(self, box_px: Box) -> I64:
        """Sorted unique ids of the 3D points whose keypoints lie inside the box, its border included."""
        return np.unique(self.point_ids[in_box(self.xy, box_px)])


@dataclass(frozen=True)
class SparseModel:
    """What mapping needs of a sparse model: observations by frame index, positions by point id."""

    observations: Mapping[int, Observations]
    positions: Mapping[int, F64]
    """(3,) world coordinates."""

    def points(self, ids: Iterable[int]) -> F64:
        """(n, 3) positions of point ids, in their order."""
        return np.array([self.positions[int(i)] for i in ids], dtype=np.float64).reshape(-1, 3)


def read_sparse_model(folder: Path, frame_indices: Iterable[int] | None = None) -> SparseModel:
    """Read the observations of the registered images (all, or those with the given frame indices).

    Image id = frame index + 1, as every stage here writes it.

    Raises:
        StageFailed: the folder holds no COLMAP model.
    """
    model = open_model(folder)
    wanted = None if frame_indices is None else {int(i) for i in frame_indices}
    observations: dict[int, Observations] = {}
    for image_id in sorted(model.reg_image_ids()):
        if wanted is None or image_id - 1 in wanted:
            observations[image_id - 1] = observations_of(model.image(image_id))
    needed = {int(i) for seen in observations.values() for i in seen.point_ids}
    positions = {i: np.array(model.point3D(i).xyz, dtype=np.float64) for i in sorted(needed)}
    return SparseModel(observations, positions)


def observations_of(image: pycolmap.Image) -> Observations:
    """Keypoints with a 3D point of a registered image."""
    points = image.get_observation_points2D()
    xy = np.array([point.xy for point in points], dtype=np.float64).reshape(-1, 2)
    ids = np.array([point.point3D_id for point in points], dtype=np.int64)
    return Observations(xy, ids)
