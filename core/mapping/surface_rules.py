"""The placement of detections by casting, with fallback methods for those that the surface or the pose fails."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import in_box
from core.geometry.pose import transform
from core.mapping.casting import Cast, Missed, RayBundle, cast_bundles
from core.mapping.fallback_methods import (
    MAX_ERROR_PX,
    Estimate,
    between,
    carried_over,
    from_depth_map,
    from_sparse_points,
)
from core.mapping.observations import Observation, write_observations
from core.mapping.pixels import Footprint, footprint
from core.mapping.scene import Scene
from core.mapping.support import box_in_crop_px
from core.scene.detection import (
    Detection,
    DetectionRow,
    Outcome,
    PlacementMethod,
    Reason,
    approximate_row,
    mapped_row,
    unplaced_row,
)
from core.scene.frame import RunFrames
from core.scene.methods import Placed, Report, Support

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

Matches = Callable[[int], Sequence[tuple[int, F64, F64]]]
"""Of a frame: (registered frame, (n, 2) own keypoints, (n, 2) its keypoints), most matches first."""


@dataclass(frozen=True)
class SurfacePlacing:
    """Placing by casting onto the supported surface, checked by other views."""

    scene: Scene
    frames: RunFrames
    matches: Matches
    """Verified matches of a frame that has no pose."""
    reach_s: float
    """How far in time a pose may be interpolated."""
    report: Report

    def place(self, detections: Sequence[Detection], folder: Path) -> Placed:
        """Place all detections; writes them as observations."""
        self.report(1, 4, "placing detections")
        observations = place_on_surface(detections, self.scene, self.frames, self.matches, self.reach_s)
        self.report(3, 4, "writing")
        write_observations(folder, observations)
        supported = [one for one in observations if len(one.point_ids)]
        support = Support.of((one.row.id, one.point_ids, one.sparse) for one in supported)
        return Placed(tuple(one.row for one in observations), support)


def place_on_surface(
    detections: Sequence[Detection], scene: Scene, frames: RunFrames, matches: Matches, reach_s: float
) -> list[Observation]:
    """Place every detection; one observation each, in input order.

    Args:
        detections: of the annotation file.
        scene: model and surface.
        frames: of the run.
        matches: verified matches of a frame that has no pose.
        reach_s: how far in time a pose may be interpolated.
    """
    bundles: dict[int, RayBundle] = {}
    observations: dict[int, Observation] = {}
    estimated: dict[int, tuple[RayBundle, PlacementMethod, Reason]] = {}
    for number, detection in enumerate(detections):
        samples = _samples(detection, scene)
        index = None if detection.source is None else frames.index_of_source.get(detection.source)
        view = None if index is None else scene.views.row(index)
        if detection.source_index is None:
            observations[number] = _without(unplaced_row(detection, Reason.NO_FRAME), detection)
        elif not len(samples.xy):
            observations[number] = _without(unplaced_row(detection, Reason.OUTSIDE_ROI, index), detection)
        elif view is not None:
            bundles[number] = _bundle(number, detection, samples, scene, view)
        else:
            reason = Reason.NO_REGISTERED_VIEW if index is None else Reason.FRAME_NOT_REGISTERED
            found = _without_pose(number, detection, samples, index, scene, frames, matches, reach_s)
            if found is None:
                observations[number] = _without(unplaced_row(detection, reason, index), detection)
            else:
                estimated[number] = (*found, reason)
    observations |= _registered(detections, scene, bundles)
    observations |= _estimates(detections, scene, estimated, frames)
    return [observations[number] for number in range(len(detections))]


def _samples(detection: Detection, scene: Scene) -> Footprint:
    crop = scene.crop
    box = box_in_crop_px(detection.box, crop, "source")
    polygon = None
    if detection.polygon is not None:
        width, height = crop.source_width, crop.source_height
        polygon = [(x * width - crop.x0, y * height - crop.y0) for x, y in detection.polygon]
    return footprint(box, crop.width, crop.height, polygon)


def _bundle(number: int, detection: Detection, samples: Footprint, scene: Scene, view: int) -> RayBundle:
    box = box_in_crop_px(detection.box, scene.crop, "source")
    views = scene.views
    center, R, frame = views.centers[view], views.R[view], int(views.frame_index[view])
    return RayBundle(number, detection.label, detection.score, box, samples, center, R, view, frame)


def _registered(
    detections: Sequence[Detection], scene: Scene, bundles: Mapping[int, RayBundle]
) -> dict[int, Observation]:
    """Mapped where the surface was met; else the depth map, then the sparse points, as estimates."""
    found: dict[int, Observation] = {}
    for (number, bundle), cast in zip(bundles.items(), cast_bundles(scene, list(bundles.values())), strict=True):
        detection = detections[number]
        assert bundle.view is not None
        frame = int(scene.views.frame_index[bundle.view])
        if isinstance(cast, Cast):
            found[number] = _cast_observation(detection, frame, cast, scene)
            continue
        estimate = from_depth_map(scene, bundle) or from_sparse_points(scene, bundle)
        found[number] = _estimate_observation(detection, frame, estimate, cast.reason, scene)
    return found


def _cast_observation(detection: Detection, frame: int, cast: Cast, scene: Scene) -> Observation:
    row = mapped_row(detection, frame, cast.place.tolist(), len(cast.point_ids), PlacementMethod.SURFACE, scene.model)
    if cast.contradicted:
        row = replace(row, outcome=Outcome.APPROXIMATE, reason=Reason.CONTRADICTED)
    return Observation(
        row,
        cast.patch.points,
        cast.normal,
        cast.patch.radius,
        cast.sigma,
        cast.parts,
        cast.point_ids,
        cast.points,
        _track(detection),
    )


def _estimate_observation(
    detection: Detection, frame: int | None, estimate: Estimate | None, reason: Reason, scene: Scene
) -> Observation:
    if estimate is None:
        return _without(unplaced_row(detection, reason, frame), detection)
    row = approximate_row(detection, frame, estimate.place.tolist(), estimate.method, reason, scene.model)
    return replace(_without(row, detection), sigma=estimate.sigma)


def _without_pose(
    number: int,
    detection: Detection,
    samples: Footprint,
    index: int | None,
    scene: Scene,
    frames: RunFrames,
    matches: Matches,
    reach_s: float,
) -> tuple[RayBundle, PlacementMethod] | None:
    """A ray bundle from a registered neighbour that shows the same pixels, else from a pose between two of them."""
    bundle = _bundle_without_pose(number, detection, samples, scene, frames)
    if index is not None:
        for other, own_xy, other_xy in matches(index):
            view = scene.views.row(other)
            carried = None if view is None else carried_over(own_xy, other_xy, bundle.box_px)
            if view is not None and carried is not None:
                moved = _moved(bundle, carried, scene, view)
                if len(moved.samples.xy):
                    return moved, PlacementMethod.PROPAGATED
    view_times = np.array([frames.moment_of_index[int(i)] for i in scene.views.frame_index])
    pose = between(scene.views, view_times, detection.moment_s, reach_s) if len(view_times) > 2 else None
    if pose is None or pose[2] > MAX_ERROR_PX:
        return None
    R, center, _ = pose
    return replace(bundle, R=R, origin=center), PlacementMethod.INTERPOLATED


def _bundle_without_pose(
    number: int, detection: Detection, samples: Footprint, scene: Scene, frames: RunFrames
) -> RayBundle:
    """A ray bundle that still lacks its pose."""
    box = box_in_crop_px(detection.box, scene.crop, "source")
    registered = scene.views.frame_index.tolist()
    near = min(registered, key=lambda frame: abs(frames.moment_of_index[frame] - detection.moment_s), default=-1)
    return RayBundle(number, detection.label, detection.score, box, samples, np.zeros(3), np.eye(3), None, near)


def _moved(bundle: RayBundle, carried: F64, scene: Scene, view: int) -> RayBundle:
    """The same pixels in a registered view."""
    xy = transform(bundle.samples.xy, carried[:, :2], carried[:, 2])
    inside = in_box(xy, (0, 0, scene.crop.width, scene.crop.height), border=False)
    samples = replace(bundle.samples, xy=xy[inside], cell=bundle.samples.cell[inside])
    x1, y1, x2, y2 = bundle.box_px
    corners = transform(np.array([[x1, y1], [x2, y1], [x1, y2], [x2, y2]]), carried[:, :2], carried[:, 2])
    low, high = corners.min(axis=0), corners.max(axis=0)
    box = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return replace(
        bundle, samples=samples, box_px=box, origin=scene.views.centers[view], R=scene.views.R[view], view=view
    )


def _estimates(
    detections: Sequence[Detection],
    scene: Scene,
    estimated: Mapping[int, tuple[RayBundle, PlacementMethod, Reason]],
    frames: RunFrames,
) -> dict[int, Observation]:
    """Ray bundles with a pose that is not their own, cast in the same way and marked as estimates."""
    found: dict[int, Observation] = {}
    results = cast_bundles(scene, [bundle for bundle, _, _ in estimated.values()])
    for (number, (_, method, reason)), cast in zip(estimated.items(), results, strict=True):
        detection = detections[number]
        index = None if detection.source is None else frames.index_of_source.get(detection.source)
        if isinstance(cast, Missed):
            found[number] = _without(unplaced_row(detection, reason, index), detection)
        else:
            row = approximate_row(detection, index, cast.place.tolist(), method, reason, scene.model)
            found[number] = replace(_without(row, detection), sigma=2.0 * cast.sigma, radius=cast.patch.radius)
    return found


def _without(row: DetectionRow, detection: Detection) -> Observation:
    nothing = np.zeros((0, 3))
    return Observation(row, nothing, np.zeros(3), 0.0, None, None, np.zeros(0, np.int64), nothing, _track(detection))


def _track(detection: Detection) -> str | None:
    """Detectors number tracks or name them; as text they compare alike."""
    return None if detection.track_id is None else str(detection.track_id)
