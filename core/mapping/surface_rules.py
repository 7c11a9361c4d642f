"""The placement of detections by casting, with lower rungs for those that the surface or the pose fails."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import in_box
from core.geometry.pose import transform
from core.mapping.casting import Cast, Missed, Sight, cast_sights
from core.mapping.confidence import Parts
from core.mapping.ladder import (
    MAX_ERROR_PX,
    Estimate,
    between,
    carried_over,
    from_depth_map,
    from_sparse_points,
)
from core.mapping.pixels import Footprint, footprint
from core.mapping.rows import Detection, DetectionRow, Outcome, approximate_row, mapped_row, unplaced_row
from core.mapping.scene import Scene
from core.mapping.support import box_in_crop_px

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

Matches = Callable[[int], Sequence[tuple[int, F64, F64]]]
"""Of a frame: (registered frame, (n, 2) own keypoints, (n, 2) its keypoints), most matches first."""


@dataclass(frozen=True)
class Times:
    """When frames of the run were seen."""

    index_of_source: Mapping[int, int]
    """Row of frames.csv of each source frame that took part."""
    time_of_index: Mapping[int, float]
    """Presentation time of each of them, s."""


@dataclass(frozen=True)
class Observation:
    """A detection after placement: its row, and what later steps need of its surface."""

    row: DetectionRow
    points: F64
    """(n, 3) visible surface under it; empty unless it was cast."""
    normal: F64
    """(3,) unit, towards the camera; zero when unknown."""
    radius: float
    """Of the patch, scene units."""
    sigma: float | None
    """Standard deviation of the place, scene units."""
    parts: Parts | None
    point_ids: I64
    """Sparse points that support it."""
    sparse: F64
    """(n, 3) of them."""
    track_id: str | None = None


def place_on_surface(
    detections: Sequence[Detection], scene: Scene, times: Times, matches: Matches, reach_s: float
) -> list[Observation]:
    """Place every detection; one observation each, in input order.

    Args:
        detections: of the annotation file.
        scene: model and surface.
        times: frames of the run.
        matches: verified matches of a frame that has no pose.
        reach_s: how far in time a pose may be interpolated.
    """
    sights: dict[int, Sight] = {}
    observations: dict[int, Observation] = {}
    estimated: dict[int, tuple[Sight, str, str]] = {}
    for number, detection in enumerate(detections):
        samples = _samples(detection, scene)
        index = None if detection.source_index is None else times.index_of_source.get(detection.source_index)
        view = None if index is None else scene.views.row(index)
        if detection.source_index is None:
            observations[number] = _without(unplaced_row(detection, "no_frame"), detection)
        elif not len(samples.xy):
            observations[number] = _without(unplaced_row(detection, "outside_roi", index), detection)
        elif view is not None:
            sights[number] = _sight(number, detection, samples, scene, view)
        else:
            reason = "no_registered_view" if index is None else "frame_not_registered"
            found = _without_pose(number, detection, samples, index, scene, times, matches, reach_s)
            if found is None:
                observations[number] = _without(unplaced_row(detection, reason, index), detection)
            else:
                estimated[number] = (*found, reason)
    observations |= _registered(detections, scene, sights)
    observations |= _estimates(detections, scene, estimated, times)
    return [observations[number] for number in range(len(detections))]


def _samples(detection: Detection, scene: Scene) -> Footprint:
    crop = scene.crop
    box = box_in_crop_px(detection.box, crop, "source")
    polygon = None
    if detection.polygon is not None:
        width, height = crop.source_width, crop.source_height
        polygon = [(x * width - crop.x0, y * height - crop.y0) for x, y in detection.polygon]
    return footprint(box, crop.width, crop.height, polygon)


def _sight(number: int, detection: Detection, samples: Footprint, scene: Scene, view: int) -> Sight:
    box = box_in_crop_px(detection.box, scene.crop, "source")
    views = scene.views
    center, R, frame = views.centers[view], views.R[view], int(views.frame_index[view])
    return Sight(number, detection.label, detection.score, box, samples, center, R, view, frame)


def _registered(detections: Sequence[Detection], scene: Scene, sights: Mapping[int, Sight]) -> dict[int, Observation]:
    """Mapped where the surface was met; else the depth map, then the sparse points, as estimates."""
    found: dict[int, Observation] = {}
    for (number, sight), cast in zip(sights.items(), cast_sights(scene, list(sights.values())), strict=True):
        detection = detections[number]
        assert sight.view is not None
        frame = int(scene.views.frame_index[sight.view])
        if isinstance(cast, Cast):
            found[number] = _cast_observation(detection, frame, cast, scene)
            continue
        estimate = from_depth_map(scene, sight) or from_sparse_points(scene, sight)
        found[number] = _estimate_observation(detection, frame, estimate, cast.reason, scene)
    return found


def _cast_observation(detection: Detection, frame: int, cast: Cast, scene: Scene) -> Observation:
    row = mapped_row(detection, frame, cast.place.tolist(), len(cast.point_ids), "surface", scene.model)
    if cast.contradicted:
        row = replace(row, outcome=Outcome.APPROXIMATE, reason="contradicted")
    return Observation(
        row,
        cast.patch.points,
        cast.normal,
        cast.patch.radius,
        cast.sigma,
        cast.parts,
        cast.point_ids,
        cast.points,
        detection.track_id,
    )


def _estimate_observation(
    detection: Detection, frame: int | None, estimate: Estimate | None, reason: str, scene: Scene
) -> Observation:
    if estimate is None:
        return _without(unplaced_row(detection, reason, frame), detection)
    row = approximate_row(detection, frame, estimate.place.tolist(), estimate.rung, reason, scene.model)
    return replace(_without(row, detection), sigma=estimate.sigma)


def _without_pose(
    number: int,
    detection: Detection,
    samples: Footprint,
    index: int | None,
    scene: Scene,
    times: Times,
    matches: Matches,
    reach_s: float,
) -> tuple[Sight, str] | None:
    """A sight from a registered neighbour that shows the same pixels, else from a pose between two of them."""
    sight = _sight_like(number, detection, samples, scene, times)
    if index is not None:
        for other, own_xy, other_xy in matches(index):
            view = scene.views.row(other)
            carried = None if view is None else carried_over(own_xy, other_xy, sight.box_px)
            if view is not None and carried is not None:
                moved = _moved(sight, carried, scene, view)
                if len(moved.samples.xy):
                    return moved, "propagated"
    view_times = np.array([times.time_of_index[int(i)] for i in scene.views.frame_index])
    pose = between(scene.views, view_times, detection.time_s, reach_s) if len(view_times) > 2 else None
    if pose is None or pose[2] > MAX_ERROR_PX:
        return None
    R, center, _ = pose
    return replace(sight, R=R, origin=center), "interpolated"


def _sight_like(number: int, detection: Detection, samples: Footprint, scene: Scene, times: Times) -> Sight:
    """A sight that still lacks its pose."""
    box = box_in_crop_px(detection.box, scene.crop, "source")
    frames = scene.views.frame_index.tolist()
    near = min(frames, key=lambda frame: abs(times.time_of_index[frame] - detection.time_s), default=-1)
    return Sight(number, detection.label, detection.score, box, samples, np.zeros(3), np.eye(3), None, near)


def _moved(sight: Sight, carried: F64, scene: Scene, view: int) -> Sight:
    """The same pixels in a registered view."""
    xy = transform(sight.samples.xy, carried[:, :2], carried[:, 2])
    inside = in_box(xy, (0, 0, scene.crop.width, scene.crop.height), border=False)
    samples = replace(sight.samples, xy=xy[inside], cell=sight.samples.cell[inside])
    x1, y1, x2, y2 = sight.box_px
    corners = transform(np.array([[x1, y1], [x2, y1], [x1, y2], [x2, y2]]), carried[:, :2], carried[:, 2])
    low, high = corners.min(axis=0), corners.max(axis=0)
    box = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return replace(
        sight, samples=samples, box_px=box, origin=scene.views.centers[view], R=scene.views.R[view], view=view
    )


def _estimates(
    detections: Sequence[Detection], scene: Scene, estimated: Mapping[int, tuple[Sight, str, str]], times: Times
) -> dict[int, Observation]:
    """Sights with a pose that is not their own, cast in the same way and marked as estimates."""
    found: dict[int, Observation] = {}
    results = cast_sights(scene, [sight for sight, _, _ in estimated.values()])
    for (number, (_, rung, reason)), cast in zip(estimated.items(), results, strict=True):
        detection = detections[number]
        index = times.index_of_source.get(-1 if detection.source_index is None else detection.source_index)
        if isinstance(cast, Missed):
            found[number] = _without(unplaced_row(detection, reason, index), detection)
        else:
            row = approximate_row(detection, index, cast.place.tolist(), rung, reason, scene.model)
            found[number] = replace(_without(row, detection), sigma=2.0 * cast.sigma, radius=cast.patch.radius)
    return found


def _without(row: DetectionRow, detection: Detection) -> Observation:
    nothing = np.zeros((0, 3))
    return Observation(row, nothing, np.zeros(3), 0.0, None, None, np.zeros(0, np.int64), nothing, detection.track_id)
