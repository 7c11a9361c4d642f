"""The outlines of a finding in its views, and how far each point of the surface lies inside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import Box
from core.geometry.pose import transform
from core.mapping.pixels import in_polygon
from core.mapping.scene import Scene
from core.measure.patch import SurfacePatch

F64 = NDArray[np.float64]

ELLIPSE_CORNERS = 48
MASK_BORDER_PX = 0.25
"""A mask is taken to reach so far beyond its polygon. One that was traced from pixels runs through the centres of the
outermost of them, half a pixel inside; one that a person drew runs around what it marks: this lies between the two."""
MIN_COSINE = 0.17
"""A view sees a point of the surface when it faces it by at least 10 degrees."""


@dataclass(frozen=True)
class SizeView:
    """A registered view with an outline of the finding."""

    detection: int
    """Id of the detection."""
    view: int
    """Row of the scene's views."""
    outline_px: F64
    """(k, 2) corners in crop pixels."""
    is_mask: bool
    """False for the ellipse in a box."""
    weight: float
    """cos(angle of incidence) / squared distance: pixels that it spends on the place."""
    pixel_su: float
    """Length that a pixel across the line of sight covers at the place, scene units."""
    projected_length: float
    """Largest extent of the outline at the distance of the place, across the line of sight, scene units."""
    projected_width: float
    """Its extent across that."""
    depth_share: float
    """Standard deviation of the distance of the view from the place over that distance, by its pose."""

    @property
    def grown_px(self) -> float:
        """By how much what the outline stands for reaches beyond it."""
        return MASK_BORDER_PX if self.is_mask else 0.0


def ellipse_in(box: Box) -> F64:
    """(k, 2) corners of the ellipse that touches the sides of a box: what a box says of the shape inside it."""
    x1, y1, x2, y2 = box
    angle = 2.0 * np.pi * np.arange(ELLIPSE_CORNERS) / ELLIPSE_CORNERS
    # The polygon has the area of the ellipse: its corners lie a little outside.
    out = float(np.sqrt(2.0 * np.pi / ELLIPSE_CORNERS / np.sin(2.0 * np.pi / ELLIPSE_CORNERS)))
    half = out * np.array([x2 - x1, y2 - y1]) / 2
    return np.asarray(
        np.array([x1 + x2, y1 + y2]) / 2 + half * np.stack([np.cos(angle), np.sin(angle)], axis=1), np.float64
    )


def signed_distance(xy: F64, polygon: F64) -> F64:
    """(n,) distances of points (n, 2) from a closed polygon (k, 2): positive inside, NaN where a point is."""
    start, along = polygon, np.roll(polygon, -1, axis=0) - polygon
    squared = np.maximum((along**2).sum(axis=1), 1e-300)
    towards = xy[:, None] - start[None]
    share = np.clip((towards * along).sum(axis=2) / squared, 0.0, 1.0)
    distance = np.sqrt(((towards - share[..., None] * along) ** 2).sum(axis=2)).min(axis=1)
    return np.asarray(np.where(in_polygon(xy, polygon), distance, -distance), np.float64)


def levels(patch: SurfacePatch, scene: Scene, views: list[SizeView]) -> F64:
    """(v, n) how far each vertex of a patch lies inside the outline of each view, scene units across its line of sight.

    Positive inside, negative outside, NaN where the view does not see the vertex.
    """
    found = np.full((len(views), len(patch.vertices)), np.nan)
    for row, one in enumerate(views):
        R, t = scene.views.R[one.view], scene.views.t[one.view]
        center = scene.views.centers[one.view]
        in_cam = transform(patch.vertices, R, t)
        before = in_cam[:, 2] > 0
        towards = center - patch.vertices
        distance = np.linalg.norm(towards, axis=1)
        cosine = (towards * patch.normals).sum(axis=1) / np.maximum(distance, 1e-300)
        asked = np.flatnonzero(before & (cosine >= MIN_COSINE))
        if not len(asked):
            continue
        origins = np.broadcast_to(center, (len(asked), 3))
        asked = asked[scene.surface.clear(origins, patch.vertices[asked], scene.tolerance)]
        if not len(asked):
            continue
        xy = np.asarray(scene.views.camera.img_from_cam(np.ascontiguousarray(in_cam[asked]))).reshape(-1, 2)
        found[row, asked] = (signed_distance(xy, one.outline_px) + one.grown_px) * one.pixel_su
    return found


def median_level(levels_of_views: F64, weights: F64) -> F64:
    """(n,) weighted median over the views that see each vertex; NaN where none does.

    The outline at which as much weight says inside as outside: single outlines that are wrong do not move it.
    """
    order = np.argsort(levels_of_views, axis=0)  # NaN last
    ordered = np.take_along_axis(levels_of_views, order, axis=0)
    weight = np.where(np.isfinite(ordered), weights[order], 0.0)
    total = weight.sum(axis=0)
    cumulated = np.cumsum(weight, axis=0) - weight / 2
    found = np.full(levels_of_views.shape[1], np.nan)
    for column in np.flatnonzero(total > 0).tolist():
        n = int((weight[:, column] > 0).sum())
        found[column] = np.interp(total[column] / 2, cumulated[:n, column], ordered[:n, column])
    return found
