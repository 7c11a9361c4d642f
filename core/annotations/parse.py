"""From JSON values to typed annotations (form: docs/method.md)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from core.annotations import checks
from core.annotations.model import Annotations, Detection, Entry, Mask, Polygon
from core.geometry.boxes import Box, box_iou

MIN_MASK_IOU = 0.5
"""A mask with the same label and at least this overlap of boxes belongs to a detection."""


def parse_annotations(value: Any) -> Annotations:
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
        time = checks.parse_time(key)
        path = checks.shown(key)
        members = checks.as_object(content, path)
        masks = _masks(members.get("masks"), f"{path}.masks", warnings)
        boxes = checks.as_list_or_null(members.get("detections"), f"{path}.detections")
        detections = []
        for i, item in enumerate(boxes):
            fields = _detection_fields(item, f"{path}.detections[{i}]", masks, warnings)
            detections.append(Detection(id=next_id, key=key, time=time, **fields))
            next_id += 1
        entries.append(Entry(key, time, tuple(detections), masks))
    return Annotations(tuple(entries), tuple(warnings))


def _masks(value: Any, path: str, warnings: list[str]) -> tuple[Mask, ...]:
    masks = []
    for i, item in enumerate(checks.as_list_or_null(value, path)):
        here = f"{path}[{i}]"
        members = checks.as_object(item, here)
        label = checks.as_label(members.get("label"), f"{here}.label")
        polygon = _area(members.get("polygon"), f"{here}.polygon", warnings)
        if polygon is not None:
            masks.append(Mask(label, polygon))
    return tuple(masks)


def _detection_fields(item: Any, path: str, masks: Sequence[Mask], warnings: list[str]) -> dict[str, Any]:
    members = checks.as_object(item, path)
    label = checks.as_label(members.get("label"), f"{path}.label")
    box = checks.as_box(members.get("bbox"), f"{path}.bbox")
    polygon = members.get("polygon")
    own = None if polygon is None else _area(polygon, f"{path}.polygon", warnings)
    return {
        "label": label,
        "score": checks.as_score(members.get("score"), f"{path}.score"),
        "box": box,
        "polygon": own or matching_mask(label, box, masks),
        "track_id": checks.as_track_id(members.get("track_id"), f"{path}.track_id"),
    }


def _area(value: Any, path: str, warnings: list[str]) -> Polygon | None:
    """A polygon that encloses something; contours of one or two corners occur and mean nothing."""
    polygon = checks.as_polygon(value, path)
    if len(polygon) < 3:
        warnings.append(f"{path} has {len(polygon)} corners and was left out")
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


def bounding_box(polygon: Polygon) -> Box:
    """Smallest box around a polygon."""
    xs, ys = [x for x, _ in polygon], [y for _, y in polygon]
    return (min(xs), min(ys), max(xs), max(ys))
