"""Sizes of defects from the outlines of their detections, measured on the surface."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.boxes import bounding_box, box_iou
from core.mapping.observations import Observation
from core.mapping.scene import Scene
from core.mapping.sigma import BOX_JITTER, MASK_JITTER
from core.mapping.support import box_in_crop_px
from core.measure.depth import depth_of
from core.measure.outline import MASK_BORDER_PX, SizeView, ellipse_in, levels, median_level
from core.measure.patch import SurfacePatch, cut_patch
from core.measure.shape import Region, region_of, straight_extents
from core.scene.detection import Detection
from core.scene.size import Measure, Size, SizeFrom, Unmeasured, together
from core.surface.ply import Mesh

F64 = NDArray[np.float64]

MAX_VIEWS = 16
"""The best views of a finding that are measured."""
LEAST_WEIGHT = 0.2
"""A view is measured when its weight is at least this share of the best one's."""
MARGIN = 1.9
"""A patch reaches this many radii of what the detections showed: the finding, and a ring around it."""
GROWTH, GROWINGS = 1.6, 3
"""A patch that a region reaches the rim of is cut again, larger by this factor, at most so many times."""
WHOLE = 0.9
"""Where what the views agree on is shorter than this share of what they see each, it is only a part."""
SAME_BOX_IOU = 0.6
"""A mask that overlaps the box of its own detection less is only a part of the finding, and the box counts."""
VANISHED = 0.5
"""Where the views agree on less than this share of the area that they see each, their outlines are too thin to lie on
each other, and what each sees alone counts."""
PIXELS = 0.7
"""Standard deviation of an outline's place that all views have in common, px: labelling tools differ by so much in
whether a mask's border runs through pixels or around them."""
BOX_SHAPE = 0.05
"""Standard deviation of a length by a box, over the length: it does not say how the finding lies in it."""
BOX_WIDTH = 0.15
"""The same of a width: a line across a box is as likely as a disc."""
BOX_SLANT = 0.35
"""The same over what a length gains by the slant of the surface: where the surface falls away from the view, what a box
has too much reaches far."""
BOX_AREA = 0.25
"""The same of an area: an ellipse fills 79 % of its box, a line next to nothing of it."""
_MAD = 1.4826


@dataclass(frozen=True)
class Sizes:
    """Sizes of the defects of a model."""

    defects: tuple[Size, ...]
    """By defect."""
    detections: Mapping[int, Size]
    """By detection, from its own outline alone: those that were measured."""


@dataclass(frozen=True)
class _Seen:
    """What one view shows: lengths by straight lines."""

    view: SizeView
    length: float
    width: float
    area: float


def measure_defects(
    members: Sequence[Sequence[Observation]],
    places: Sequence[F64],
    detections: Mapping[int, Detection],
    scene: Scene,
) -> Sizes:
    """Measure every defect, in units of the model.

    A defect is measured from its masks where it has any, else from the ellipses in its boxes: from its best views, by
    the pixels that they spend on it (`MAX_VIEWS`). The outlines of the views are carried onto the surface, and where
    at least half of them, by weight, say inside, it is covered. Its length is the largest extent of this region along
    the surface, its width the extent across that, its area that of the triangles inside, cut at the outline. Of a
    finding so thin that the outlines miss each other, the weighted median of what the views see each is taken. So it
    is where the surface does not fill the outlines, as at a nick, which is missing metal: there a view sees at least
    the extent of its outline across the line of sight at the distance of the place.

    Args:
        members: by defect the mapped observations of it.
        places: by defect its place, (3,).
        detections: of the annotation file, by id.
        scene: model and surface.
    """
    defects: list[Size] = []
    single: dict[int, Size] = {}
    for own, place in zip(members, places, strict=True):
        size, seen = _measure(own, place, detections, scene)
        defects.append(size)
        single |= seen
    return Sizes(tuple(defects), single)


def _measure(
    own: Sequence[Observation], place: F64, detections: Mapping[int, Detection], scene: Scene
) -> tuple[Size, dict[int, Size]]:
    views = _views(own, place, detections, scene)
    if not views:
        return Size(reason=Unmeasured.NO_VIEW), {}
    masks = [view for view in views if view.is_mask]
    used = _best(masks or views)
    known = SizeFrom.MASK if masks else SizeFrom.BOX
    reach = MARGIN * _radius(own, place) + 2.0 * scene.spacing
    found = _outlined(scene, used, place, reach)
    if found is None:
        return Size(reason=Unmeasured.NO_SURFACE), {}
    patch, of_views, regions = found
    seen = [
        _Seen(
            view,
            max(region.straight.length, view.projected_length),
            max(region.straight.width, view.projected_width),
            region.area,
        )
        for view, region in zip(used, regions, strict=True)
        if region is not None
    ]
    if not seen:
        return Size(reason=Unmeasured.NOT_SEEN), {}
    level = median_level(of_views, np.array([view.weight for view in used]))
    joined = region_of(patch, level)
    best = next(region for region in regions if region is not None)
    size, bends = _joined(joined, best, seen, scene.spacing)
    if joined is not None:
        depth = depth_of(joined, level, 0.5 * scene.spacing, _brightness(patch, scene.mesh))
        if depth is not None:
            pose = depth.value * _common_depth([one.view for one in seen])
            size = replace(size, depth=Measure(depth.value, 0.0, pose, depth.sigma))
    size = replace(size, size_from=known)
    return size, {one.view.detection: _alone(one, bends, scene.spacing) for one in seen}


def _brightness(patch: SurfacePatch, mesh: Mesh) -> F64 | None:
    """(n,) grey value at the vertices of a patch, that of the nearest vertex of the mesh; None without colours."""
    if mesh.colors is None:
        return None
    reach = float(np.linalg.norm(patch.vertices - patch.place, axis=1).max())
    near = np.flatnonzero(np.linalg.norm(mesh.vertices - patch.place, axis=1) <= reach * (1.0 + 1e-9))
    nearest = near[cKDTree(mesh.vertices[near]).query(patch.vertices)[1]]
    return np.asarray(mesh.colors[nearest].mean(axis=1), np.float64)


def _outlined(
    scene: Scene, views: list[SizeView], place: F64, reach: float
) -> tuple[SurfacePatch, F64, list[Region | None]] | None:
    """A piece of the surface that holds what the views outline, (v, n) levels on it and the region of each view."""
    found = None
    for _ in range(GROWINGS):
        patch = cut_patch(scene.mesh, place, reach)
        if patch is None:
            break
        of_views = levels(patch, scene, views)
        regions = [region_of(patch, level) for level in of_views]
        found = patch, of_views, regions
        if not any(region is not None and region.at_rim for region in regions):
            break
        reach *= GROWTH
    return found


def _views(own: Sequence[Observation], place: F64, detections: Mapping[int, Detection], scene: Scene) -> list[SizeView]:
    found = []
    for one in own:
        frame = one.row.frame_index
        view = None if frame is None else scene.views.row(frame)
        if view is None or one.row.id not in detections:
            continue
        detection = detections[one.row.id]
        towards = scene.views.centers[view] - place
        distance = float(np.linalg.norm(towards))
        cosine = max(float(towards @ one.normal) / max(distance, 1e-300), 0.05)
        outline, is_mask = _outline(detection, scene)
        pixel = distance / scene.focal_px
        on_outline = distance * scene.views.rays(outline, scene.views.R[view])
        extents = straight_extents(on_outline, towards / max(distance, 1e-300))
        grown = 2.0 * MASK_BORDER_PX * pixel if is_mask else 0.0
        found.append(
            SizeView(
                detection=detection.id,
                view=view,
                outline_px=outline,
                is_mask=is_mask,
                weight=cosine / distance**2,
                pixel_su=pixel,
                projected_length=extents.length + grown,
                projected_width=extents.width + grown,
                depth_share=_depth_share(scene, view, distance),
            )
        )
    return found


def _outline(detection: Detection, scene: Scene) -> tuple[F64, bool]:
    """(k, 2) corners in crop pixels, and whether they are those of a mask."""
    crop = scene.crop
    if detection.polygon is None or box_iou(bounding_box(detection.polygon), detection.box) < SAME_BOX_IOU:
        return ellipse_in(box_in_crop_px(detection.box, crop, "source")), False
    shares = np.array(detection.polygon, np.float64)
    return shares * (crop.source_width, crop.source_height) - (crop.x0, crop.y0), True


def _depth_share(scene: Scene, view: int, distance: float) -> float:
    """By the covariance of its translation in its own frame, along the line of sight; 0 where that is not known."""
    pose = scene.pose_covariance(view)
    return 0.0 if pose is None else float(np.sqrt(max(pose.matrix[5, 5], 0.0))) / distance


def _best(views: Sequence[SizeView]) -> list[SizeView]:
    ordered = sorted(views, key=lambda view: (-view.weight, view.detection))
    return [view for view in ordered if view.weight >= LEAST_WEIGHT * ordered[0].weight][:MAX_VIEWS]


def _radius(own: Sequence[Observation], place: F64) -> float:
    """Median over the detections of how far the surface under each reaches from the place."""
    far = [float(np.linalg.norm(one.points - place, axis=1).max()) for one in own if len(one.points)]
    return float(np.median(far)) if far else max((one.radius for one in own), default=0.0)


def _joined(
    joined: Region | None, best: Region, seen: Sequence[_Seen], spacing: float
) -> tuple[Size, tuple[float, float]]:
    """Size of a defect over its views, and how much longer its length and width are along the surface than straight."""
    weights = np.array([one.view.weight for one in seen])
    length, width, area = (
        _weighted_median(np.array(values), weights)
        for values in (
            [one.length for one in seen],
            [one.width for one in seen],
            [one.area for one in seen],
        )
    )
    whole = joined is not None and joined.area >= VANISHED * area and joined.straight.length >= WHOLE * length
    if joined is not None and whole:
        bends = joined.bends()
        length, width, area = joined.straight.length, joined.straight.width, joined.area
    else:
        bends = best.bends()
    length, width = bends[0] * length, bends[1] * width
    own = _sigmas([one.length for one in seen], length, seen, spacing)
    across = _sigmas([one.width for one in seen], width, seen, spacing, BOX_WIDTH)
    covered = _area_sigmas(length, width, area, [one.area for one in seen], seen, spacing)
    return Size(Measure(length, *own), Measure(width, *across), Measure(area, *covered)), bends


def _sigmas(
    values: Sequence[float], value: float, seen: Sequence[_Seen], spacing: float, box_shape: float = BOX_SHAPE
) -> tuple[float, float, float]:
    """Standard deviations of a length by outline, pose and surface."""
    spread = _spread(values, value, [one.view for one in seen])
    common = np.sqrt(2.0) * PIXELS * float(np.median([one.view.pixel_su for one in seen]))
    views = [one.view for one in seen]
    shape = 0.0
    if not views[0].is_mask:
        slant = max(0.0, value - float(np.median([view.projected_length for view in views])))
        shape = together(box_shape * value, BOX_SLANT * slant)
    return together(spread, common, shape), value * _common_depth(views), spacing


def _area_sigmas(
    length: float, width: float, area: float, values: Sequence[float], seen: Sequence[_Seen], spacing: float
) -> tuple[float, float, float]:
    """The same of an area: the border moves by what moves the ends of a length."""
    border = np.pi * (length + width) / 2
    spread = _spread(values, 2.0 * area, [one.view for one in seen])
    common = border * PIXELS * float(np.median([one.view.pixel_su for one in seen]))
    shape = 0.0 if seen[0].view.is_mask else BOX_AREA * area
    pose = 2.0 * area * _common_depth([one.view for one in seen])
    return together(spread, common, shape), pose, border * spacing / 2


def _spread(values: Sequence[float], size: float, views: Sequence[SizeView]) -> float:
    """Of a robust mean over views; never below what outlines are exact to in one view."""
    jitter = (MASK_JITTER if views[0].is_mask else BOX_JITTER) * np.sqrt(2.0) * size
    found = np.array(values)
    observed = _MAD * float(np.median(np.abs(found - np.median(found)))) if len(found) >= 3 else 0.0
    return max(observed, float(jitter)) / float(np.sqrt(len(found)))


def _common_depth(views: Sequence[SizeView]) -> float:
    """Share by which the distances are off together: that of the median view, since neighbours err alike."""
    return float(np.median([view.depth_share for view in views]))


def _alone(one: _Seen, bends: tuple[float, float], spacing: float) -> Size:
    """Size by one detection alone; how the surface bends is the defect's."""
    length, width = bends[0] * one.length, bends[1] * one.width
    return Size(
        Measure(length, *_sigmas([one.length], length, [one], spacing)),
        Measure(width, *_sigmas([one.width], width, [one], spacing, BOX_WIDTH)),
        Measure(one.area, *_area_sigmas(length, width, one.area, [one.area], [one], spacing)),
        size_from=SizeFrom.MASK if one.view.is_mask else SizeFrom.BOX,
    )


def _weighted_median(values: F64, weights: F64) -> float:
    order = np.argsort(values)
    cumulated = np.cumsum(weights[order]) - weights[order] / 2
    return float(np.interp(weights.sum() / 2, cumulated, values[order]))
