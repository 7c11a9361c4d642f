"""Fallback methods: places for detections whose frame has no pose, or whose pixels meet no supported surface.

They are estimates and are marked `approximate`; none of them is ever counted with the mapped ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation, Slerp

from core.geometry.boxes import in_box
from core.mapping.casting import RayBundle
from core.mapping.scene import Scene
from core.scene.detection import PlacementMethod
from core.scene.views import Views

F64 = NDArray[np.float64]

MIN_POINTS = 3
MIN_MATCHES = 6
NEAR_SHARE = 0.25
"""The nearest quarter of the depths in a box stands for its nearest surface."""
MAX_ERROR_PX = 8.0
"""Poses are interpolated only where leaving out a registered frame costs no more than this, in the median."""


@dataclass(frozen=True)
class Estimate:
    """A place that was not found by casting onto the surface."""

    place: F64
    method: PlacementMethod
    sigma: float


def from_depth_map(scene: Scene, bundle: RayBundle) -> Estimate | None:
    """The nearest surface that the frame's own depth map shows in the box."""
    if bundle.view is None or bundle.frame not in scene.depth.frames:
        return None
    rays = scene.views.rays(bundle.samples.xy, bundle.R)
    distance, _ = scene.depth.distances(bundle.frame, bundle.origin + rays)
    valid = np.flatnonzero(distance > 0)
    if len(valid) < MIN_POINTS:
        return None
    points = bundle.origin + distance[valid, None] * rays[valid]
    return _nearest_surface(points, distance[valid], scene, bundle, PlacementMethod.DEPTH)


def from_sparse_points(scene: Scene, bundle: RayBundle) -> Estimate | None:
    """The nearest surface that the sparse points in the box show."""
    if bundle.view is None:
        return None
    xy, _, points = scene.sparse.of(int(scene.views.frame_index[bundle.view]))
    inside = in_box(xy, bundle.box_px)
    if inside.sum() < MIN_POINTS:
        return None
    distance = np.linalg.norm(points[inside] - bundle.origin, axis=1)
    return _nearest_surface(points[inside], distance, scene, bundle, PlacementMethod.SPARSE)


def _nearest_surface(points: F64, distance: F64, scene: Scene, bundle: RayBundle, method: PlacementMethod) -> Estimate:
    """Mean of the points about as far away as the nearest quarter of them."""
    x1, y1, x2, y2 = bundle.box_px
    # One of the distances, so that at least its point is kept: between two far apart there is none.
    near = float(np.quantile(distance, NEAR_SHARE, method="lower"))
    kept = np.abs(distance - near) <= near * max(x2 - x1, y2 - y1) / scene.focal_px
    place = points[kept].mean(axis=0)
    return Estimate(place, method, float(np.linalg.norm(points[kept] - place, axis=1).mean()))


def carried_over(own_xy: F64, other_xy: F64, box_px: tuple[float, float, float, float]) -> F64 | None:
    """(2, 3) similarity that carries pixels around a box from one frame to another; None when matches do not fix it.

    Args:
        own_xy: (n, 2) matched keypoints of the frame with the box.
        other_xy: (n, 2) theirs in the other frame.
        box_px: the box; matches within twice its size count.
    """
    low, high = np.array(box_px[:2]), np.array(box_px[2:])
    around = (np.abs(own_xy - (low + high) / 2) <= np.maximum(high - low, 16.0)).all(axis=1)
    if around.sum() < MIN_MATCHES:
        return None
    matrix, inliers = cv2.estimateAffinePartial2D(
        own_xy[around].astype(np.float64), other_xy[around].astype(np.float64), ransacReprojThreshold=3.0
    )
    if matrix is None or int(inliers.sum()) < MIN_MATCHES:
        return None
    result: F64 = np.asarray(matrix, np.float64)
    return result


def between(views: Views, times_s: F64, time_s: float, reach_s: float) -> tuple[F64, F64, float] | None:
    """Pose (R, centre) at a time between two registered views, and the typical error of such a pose in px.

    Args:
        views: registered views.
        times_s: (f,) their times.
        time_s: wanted.
        reach_s: both neighbours must be nearer than this.
    """
    order = np.argsort(times_s, kind="stable")
    times = times_s[order]
    after = int(np.searchsorted(times, time_s))
    if after == 0 or after == len(times):
        return None
    a, b = order[after - 1], order[after]
    if time_s - times_s[a] >= reach_s or times_s[b] - time_s >= reach_s:
        return None
    R, center = _blend(views, a, b, (time_s - times_s[a]) / (times_s[b] - times_s[a]))
    return R, center, _leave_one_out_px(views, order, times_s, times_s[b] - times_s[a])


def _blend(views: Views, a: int, b: int, share: float) -> tuple[F64, F64]:
    turn = Slerp([0.0, 1.0], Rotation.from_matrix(views.R[[a, b]]))
    R: F64 = turn([share]).as_matrix()[0]
    center: F64 = (1.0 - share) * views.centers[a] + share * views.centers[b]
    return R, center


def _leave_one_out_px(views: Views, order: NDArray[np.int64], times_s: F64, gap_s: float) -> float:
    """Median error in px over registered views left out, between neighbours about `gap_s` apart; rotation only.

    A wrong centre shows as a wrong direction of the scene, which the rotation error of the same views exceeds
    in practice: an unsteady probe turns more than it shifts.
    """
    focal = float(views.camera.mean_focal_length())
    times = times_s[order]
    errors = []
    for k in range(1, len(order) - 1):
        first = int(np.searchsorted(times, times[k] - gap_s / 2, side="right")) - 1
        last = int(np.searchsorted(times, times[k] + gap_s / 2, side="left"))
        first, last = min(first, k - 1), max(last, k + 1)
        if first < 0 or last >= len(order) or times[last] - times[first] > 2.0 * gap_s + 1e-9:
            continue
        a, b = order[first], order[last]
        R, _ = _blend(views, a, b, (times[k] - times[first]) / (times[last] - times[first]))
        errors.append(focal * float(Rotation.from_matrix(R @ views.R[order[k]].T).magnitude()))
    return float(np.median(errors)) if errors else float("inf")
