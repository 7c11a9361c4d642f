"""Which images get a depth map, from which other images, and in what depth range."""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.geometry.pose import Pose, pose_of
from core.settings.groups import DenseSettings

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MIN_ANGLE_DEG, BEST_ANGLE_DEG, MAX_ANGLE_DEG = 3.0, 12.0, 65.0
"""Triangulation angles of a useful source image: the values of OpenMVS's documentation."""
SELECTED_BONUS = 1.5
"""Preference for sources that have a depth map themselves: only they can confirm a depth."""


@dataclass(frozen=True)
class DenseView:
    """One image that gets a depth map."""

    name: str
    index: int
    sources: tuple[str, ...]
    depth_min: float
    depth_max: float


@dataclass(frozen=True)
class SparseViews:
    """A sparse model as arrays, images ordered by id."""

    image_ids: tuple[int, ...]
    names: tuple[str, ...]
    poses: tuple[Pose, ...]
    centers: F64
    """(n, 3)"""
    points: F64
    """(p, 3)"""
    visible: tuple[I64, ...]
    """Per image, sorted rows of `points` that it observes."""


def sparse_views(model: pycolmap.Reconstruction) -> SparseViews:
    """Read poses and tracks of all posed images of a pycolmap.Reconstruction."""
    point_ids = sorted(model.points3D)
    row = {point_id: i for i, point_id in enumerate(point_ids)}
    ids = sorted(image_id for image_id, image in model.images.items() if image.has_pose)
    poses, visible = [], []
    for image_id in ids:
        image = model.images[image_id]
        poses.append(pose_of(image))
        observed = {row[o.point3D_id] for o in image.get_observation_points2D() if o.point3D_id in row}
        visible.append(np.array(sorted(observed), dtype=np.int64))
    points = np.array([model.points3D[i].xyz for i in point_ids]).reshape(-1, 3)
    centers = np.array([pose.center for pose in poses]).reshape(-1, 3)
    names = tuple(str(model.images[i].name) for i in ids)
    return SparseViews(tuple(ids), names, tuple(poses), centers, points, tuple(visible))


def select_views(views: SparseViews, count: int) -> list[int]:
    """Rows of the images that get a depth map: `count` of them (0 = all that see points), ascending.

    Five of six are spread evenly over the camera's path (translation in units of the median depth plus
    rotation in radians, so a turn on the spot counts too); the rest go where points are seen by fewer than three
    of those chosen so far.
    """
    usable = [i for i, seen in enumerate(views.visible) if len(seen) >= 3]
    if count == 0 or count >= len(usable):
        return usable
    path = _path_length(views, usable)
    even = np.linspace(0.0, path[-1], max(1, count - count // 6))
    chosen = {usable[int(np.argmin(np.abs(path - at)))] for at in even}
    seen = np.zeros(len(views.points), dtype=np.int64)
    for i in chosen:
        seen[views.visible[i]] += 1
    while len(chosen) < count:
        rest = [i for i in usable if i not in chosen]
        gains = [int((seen[views.visible[i]] < 3).sum()) for i in rest]
        best = rest[int(np.argmax(gains))]
        chosen.add(best)
        seen[views.visible[best]] += 1
    return sorted(chosen)


def _path_length(views: SparseViews, rows: Sequence[int]) -> F64:
    """Path length from the first to each of `rows`, translation / median depth + rotation."""
    depths = [np.median(_depths(views, i)) for i in rows]
    unit = max(float(np.median(depths)), 1e-12)
    length = [0.0]
    for a, b in itertools.pairwise(rows):
        cosine = (np.trace(views.poses[b].R @ views.poses[a].R.T) - 1.0) / 2.0
        turn = float(np.arccos(np.clip(cosine, -1.0, 1.0)))
        length.append(length[-1] + float(np.linalg.norm(views.centers[b] - views.centers[a])) / unit + turn)
    return np.array(length)


def _depths(views: SparseViews, row: int) -> F64:
    """Depths of the points that an image observes."""
    pose = views.poses[row]
    return np.asarray(views.points[views.visible[row]] @ pose.R[2] + pose.t[2])


def depth_range(views: SparseViews, row: int) -> tuple[float, float]:
    """1 - 99 % of the sparse depths, widened by 25 % (COLMAP's rule)."""
    depths = _depths(views, row)
    depths = depths[depths > 0]
    low, high = np.percentile(depths, [1.0, 99.0])
    return float(low) * 0.75, float(high) * 1.25


def angle_weight(angle_deg: F64) -> F64:
    """Worth of a triangulation angle: 1 at the best angle, 0 below the minimum and above the maximum."""
    rising = np.clip(angle_deg / BEST_ANGLE_DEG, 0.0, 1.0) ** 1.5
    falling = np.exp(-(((angle_deg - BEST_ANGLE_DEG) / 20.0) ** 2))
    weight = np.where(angle_deg <= BEST_ANGLE_DEG, rising, falling)
    return np.where((angle_deg < MIN_ANGLE_DEG) | (angle_deg > MAX_ANGLE_DEG), 0.0, weight)


def select_sources(views: SparseViews, row: int, preferred: frozenset[int], count: int) -> list[int]:
    """Rows of the best source images of one image, best first; at most `count`, perhaps none.

    The worth of a candidate for a point is the worth of their angle times that of their relative resolution.
    Sources are taken greedily by the sum over shared points, where a point counts less the better the sources taken so
    far already serve it. So the sources together cover the whole image: an image's border is seen by other
    frames than its centre.
    """
    served = np.zeros(len(views.visible[row]))
    worth = {
        other: values * (SELECTED_BONUS if other in preferred else 1.0)
        for other in range(len(views.names))
        if other != row and (values := _source_worth(views, row, other)).any()
    }
    taken: list[int] = []
    while len(taken) < count and worth:
        gain = {other: float((values / (1.0 + served) ** 2).sum()) for other, values in worth.items()}
        best = max(gain, key=lambda other: (gain[other], -other))
        taken.append(best)
        served += worth.pop(best)
    return taken


def _source_worth(views: SparseViews, row: int, other: int) -> F64:
    """(n,) worth of `other` for each point that `row` observes, 0 where it does not observe it."""
    seen = views.visible[row]
    worth = np.zeros(len(seen))
    shared = np.isin(seen, views.visible[other], assume_unique=True)
    if int(shared.sum()) < 3:
        return worth
    points = views.points[seen[shared]]
    a, b = views.centers[row] - points, views.centers[other] - points
    da, db = np.linalg.norm(a, axis=1), np.linalg.norm(b, axis=1)
    cosine = (a * b).sum(axis=1) / np.maximum(da * db, 1e-24)
    angle = np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))
    resolution = np.minimum(da, db) / np.maximum(np.maximum(da, db), 1e-12)
    worth[shared] = angle_weight(angle) * resolution
    return worth


def plan_views(views: SparseViews, settings: DenseSettings) -> list[DenseView]:
    """Views, sources and depth ranges. Views that find no source image are left out.

    Frame numbers come from COLMAP's ids: image_id = index + 1.
    """
    chosen = select_views(views, settings.views)
    preferred = frozenset(chosen)
    plan = []
    for row in chosen:
        sources = select_sources(views, row, preferred, settings.sources)
        if sources:
            low, high = depth_range(views, row)
            names = tuple(views.names[i] for i in sources)
            plan.append(DenseView(views.names[row], views.image_ids[row] - 1, names, low, high))
    return plan


_VIEWS = "views.json"


def write_views(folder: Path, plan: Sequence[DenseView]) -> None:
    """Write the plan of depth maps into the result of `undistort`."""
    (folder / _VIEWS).write_text(json.dumps([asdict(view) for view in plan], indent=1))


def read_views(folder: Path) -> list[DenseView]:
    """Read what `write_views` wrote."""
    rows = json.loads((folder / _VIEWS).read_text())
    return [DenseView(**{**row, "sources": tuple(row["sources"])}) for row in rows]
