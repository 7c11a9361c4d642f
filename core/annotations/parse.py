"""From JSON values to typed annotations (form: docs/method.md)."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations import checks
from core.annotations.form import DetectionForm, EntryForm, MaskForm, as_form
from core.annotations.model import Annotations, Entry
from core.geometry.boxes import Box, bounding_box, box_iou
from core.scene.detection import Detection, Mask, Polygon

MIN_MASK_IOU = 0.5
"""A mask with the same label and at least this overlap of boxes belongs to a detection."""


_NO_AREA = 1e-12
"""Twice the area of a polygon along a line, as a share of the picture: much less than a pixel of the largest one."""


def parse_annotations(value: object) -> Annotations:
    """Check a JSON value and give it types.

    Args:
        value: object of time keys; each holds an object with optional lists `detections` (label, score,
            bbox, optional track_id and polygon) and `masks` (label, polygon), either of which may be null.
            Further members are ignored.

    Returns:
        Entries and detection ids in input order. A detection without a polygon takes that of the mask with
        its label whose box overlaps best, IoU at least `MIN_MASK_IOU`.

    Raises:
        BadInput: names the key and the path of the first value that is wrong.
    """
    top = checks.as_object(value, "the top level")
    entries: list[Entry] = []
    warnings: list[str] = []
    next_id = 0
    for key, content in top.items():
        time, path = checks.parse_time(key), checks.shown(key)
        form = as_form(EntryForm, content, path)
        masks = _masks(form.masks, f"{path}.masks", warnings)
        detections = []
        for i, one in enumerate(form.detections):
            polygon = _own_polygon(one, f"{path}.detections[{i}].polygon", warnings)
            polygon = polygon or matching_mask(one.label, one.bbox, masks)
            detections.append(
                Detection(
                    id=next_id,
                    key=key,
                    time_s=float(time),
                    label=one.label,
                    score=one.score,
                    box=one.bbox,
                    polygon=polygon,
                    track_id=one.track_id,
                )
            )
            next_id += 1
        entries.append(Entry(key, time, tuple(detections), masks))
    return Annotations(tuple(entries), tuple(warnings))


def _masks(forms: Sequence[MaskForm], path: str, warnings: list[str]) -> tuple[Mask, ...]:
    masks = []
    for i, one in enumerate(forms):
        polygon = _with_area(one.polygon, f"{path}[{i}].polygon", warnings)
        if polygon is not None:
            masks.append(Mask(one.label, polygon))
    return tuple(masks)


def _own_polygon(one: DetectionForm, path: str, warnings: list[str]) -> Polygon | None:
    """The outline that a detection brings; one that is elsewhere than its box is a mistake of the program."""
    polygon = None if one.polygon is None else _with_area(one.polygon, path, warnings)
    if polygon is not None and box_iou(one.bbox, bounding_box(polygon)) == 0:
        warnings.append(f"{path} lies outside of its own box and was left out")
        return None
    return polygon


def _with_area(polygon: Polygon, path: str, warnings: list[str]) -> Polygon | None:
    """A polygon that encloses something; contours of one or two corners, or along a line, occur and mean nothing."""
    if len(polygon) < 3:
        warnings.append(f"{path} has {len(polygon)} corners and was left out")
        return None
    if not has_area(polygon):
        warnings.append(f"{path} encloses no area and was left out")
        return None
    return polygon


def matching_mask(label: str, box: Box, masks: Sequence[Mask]) -> Polygon | None:
    """Polygon of the mask with this label whose bounding box overlaps `box` best, if the IoU is at least
    `MIN_MASK_IOU`; the first of equals."""
    best, best_iou = None, MIN_MASK_IOU
    for mask in masks:
        if mask.label == label:
            overlap = box_iou(box, bounding_box(mask.polygon))
            if overlap > best_iou or (best is None and overlap == best_iou):
                best, best_iou = mask.polygon, overlap
    return best


def has_area(polygon: Polygon) -> bool:
    """Whether a polygon encloses more than rounding leaves along a line."""
    ends = (*polygon[1:], *polygon[:1])
    doubled = sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in zip(polygon, ends, strict=True))
    return abs(doubled) > _NO_AREA
