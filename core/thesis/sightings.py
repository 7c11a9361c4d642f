"""Which registered views could see a place by the thesis's rules, and how well."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import in_box
from core.geometry.lens import lens_of
from core.geometry.pose import camera_center, transform
from core.mapping.surface import Surface
from core.scene.defect import Sighting
from core.scene.views import Views
from core.timeline.seen import MIN_VISIBLE_SHARE

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

MAX_SAMPLES = 64
"""Sample points of a defect that are tested for visibility."""


def sightings(points: F64, normal: F64, views: Views, surface: Surface, tolerance: float) -> list[Sighting]:
    """Views that could see a place given by sample points on it, best first (earlier first among equals).

    Args:
        points: (n, 3) sample points of the place.
        normal: (3,) unit normal of the surface there; its sign does not matter. Zero = unknown.
        views: registered images.
        surface: what may hide it.
        tolerance: depth by which the surface may lie before a point, scene units.
    """
    middle = points.mean(axis=0)
    found = []
    for row, frame_index in enumerate(views.frame_index.tolist()):
        center = camera_center(views.R[row], views.t[row])
        if _visible_share(points, views, row, center, surface, tolerance) >= MIN_VISIBLE_SHARE:
            towards = center - middle
            distance = float(np.linalg.norm(towards))
            incidence = abs(float(towards @ normal)) / distance if normal.any() else 1.0
            found.append((frame_index, incidence / distance**2))
    best = max((quality for _, quality in found), default=0.0) or 1.0
    ranked = [Sighting(index, quality / best) for index, quality in found]
    return sorted(ranked, key=lambda sighting: (-sighting.quality, sighting.frame_index))


def _visible_share(points: F64, views: Views, row: int, center: F64, surface: Surface, tolerance: float) -> float:
    in_camera = transform(points, views.R[row], views.t[row])
    xy = np.asarray(views.camera.img_from_cam(in_camera), dtype=np.float64)
    inside = in_box(xy, (0, 0, views.camera.width, views.camera.height)) & (in_camera[:, 2] > 0)
    inside &= lens_of(views.camera).before_fold(in_camera)
    if inside.mean() < MIN_VISIBLE_SHARE:
        return 0.0
    shown = points[inside]
    clear = surface.clear(np.broadcast_to(center, shown.shape), shown, tolerance)
    return float(clear.sum()) / len(points)


def sample_points(support: F64) -> F64:
    """At most `MAX_SAMPLES` of the support points, evenly picked in their order."""
    if len(support) <= MAX_SAMPLES:
        return support
    sampled: F64 = support[np.linspace(0, len(support) - 1, MAX_SAMPLES).round().astype(int)]
    return sampled


def mean_normal(normals: F64, vertex_defect: I32, weight: NDArray[np.float32], defect: int) -> F64:
    """(3,) unit normal of a defect's vertices weighted by influence; zero when it covers none."""
    own = np.flatnonzero(vertex_defect == defect)
    total: F64 = (normals[own] * weight[own, None]).sum(axis=0)
    length = float(np.linalg.norm(total))
    unit: F64 = total / length if length > 0 else np.zeros(3)
    return unit
