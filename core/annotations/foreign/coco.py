"""COCO: instances on pictures, with tracks and videos as later data sets have them."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.checks import as_list, as_object, invalid, shown
from core.annotations.foreign.bitmaps import coco_outlines, largest
from core.annotations.foreign.sheet import Points, Shape, Sheet, frame_number, number_in_name
from core.annotations.foreign.values import corner_box, needed_size, numbers, objects, pairs, text, track_of, whole
from core.errors import BadInput
from core.geometry.boxes import Box
from core.json_files import JsonObject

DROPS = {
    "keypoints": "set of keypoints",
    "mask": "mask that cannot be unpacked",
    "part": "further part of an outline",
    "picture": "annotation without a picture in the file",
}


def recognises(document: object) -> bool:
    """Whether a JSON value is a file of COCO."""
    if not isinstance(document, dict):
        return False
    return isinstance(document.get("images"), list) and isinstance(document.get("annotations"), list)


def read(document: JsonObject, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read pictures with boxes, polygons and masks; every picture of the file was looked at."""
    categories = objects(document.get("categories"), "categories")
    labels = {_id(one.get("id"), "categories.id"): text(one.get("name"), "categories.name") for one in categories}
    pictures: dict[object, tuple[str, str, tuple[float, float]]] = {}
    videos = set()
    for i, one in enumerate(objects(document["images"], "images")):
        where = f"images[{i}]"
        size = needed_size(one.get("width"), one.get("height"), where)
        key, known = _key(one, where)
        pictures[_id(one.get("id"), f"{where}.id")] = (key, known, size)
        videos.add(_id(one.get("video_id"), f"{where}.video_id"))
        if len(videos) > 1:
            raise _several(document)
        sheet.add(key, known, unit=size, size=size)
    for i, one in enumerate(objects(document["annotations"], "annotations")):
        where = f"annotations[{i}]"
        found = pictures.get(_id(one.get("image_id"), f"{where}.image_id"))
        if found is None:
            sheet.drop("picture")
            continue
        key, known, size = found
        sheet.add(key, known, [_shape(one, labels, where, sheet)], unit=size, size=size)


def _shape(one: JsonObject, labels: dict[object, str], where: str, sheet: Sheet) -> Shape:
    if one.get("keypoints"):
        sheet.drop("keypoints")
    attributes = one.get("attributes")
    attributes = attributes if isinstance(attributes, dict) else {}
    category = _id(one.get("category_id"), f"{where}.category_id")
    if category not in labels:
        raise invalid(f"{where}.category_id", f"is {shown(category)}, which no category has")
    score = one.get("score", attributes.get("score"))
    tracks = (one.get("track_id"), one.get("instance_id"), attributes.get("track_id"))
    return Shape(
        labels[category],
        _box(one.get("bbox"), f"{where}.bbox"),
        _outline(one.get("segmentation"), f"{where}.segmentation", sheet),
        None if score is None else numbers([score], f"{where}.score")[0],
        next((track for track in map(track_of, tracks) if track is not None), None),
    )


def _box(value: object, where: str) -> Box | None:
    if not value:
        return None
    x, y, width, height = numbers(value, where, 4)
    return corner_box(x, y, width, height)


def _outline(value: object, where: str, sheet: Sheet) -> Points | None:
    """The largest part of an outline."""
    if not value:
        return None
    if isinstance(value, dict):
        return unpacked(value, where, sheet) or None
    rings = as_list(value, where)
    rings = [rings] if rings and not isinstance(rings[0], list) else rings
    parts = [pairs(numbers(ring, f"{where}[{i}]"), f"{where}[{i}]") for i, ring in enumerate(rings)]
    sheet.drop("part", max(0, len(parts) - 1))
    return max(parts, key=_area, default=None)


def unpacked(value: JsonObject, where: str, sheet: Sheet) -> Points:
    """The largest part of run lengths {size [height, width], counts}."""
    height, width = (whole(one, f"{where}.size") for one in numbers(value.get("size"), f"{where}.size", 2))
    counts = value.get("counts")
    runs = counts if isinstance(counts, str) else as_list(counts, f"{where}.counts")
    return largest(lambda: coco_outlines(runs, height, width, sheet.spend), sheet)


def _area(corners: Points) -> float:
    ends = (*corners[1:], *corners[:1])
    return abs(sum(x1 * y2 - x2 * y1 for (x1, y1), (x2, y2) in zip(corners, ends, strict=True)))


def _key(one: JsonObject, where: str) -> tuple[str, str]:
    known = text(one.get("file_name"), f"{where}.file_name") or where
    for member in ("frame_id", "frame_index"):
        if one.get(member) is not None:
            return frame_number(whole(one[member], f"{where}.{member}"), f"{where}.{member}"), known
    return number_in_name(known), known


def _id(value: object, where: str) -> object:
    if isinstance(value, list | dict):
        raise invalid(where, f"must be a number or a text, not {shown(value)}")
    return value


def _several(document: JsonObject) -> BadInput:
    videos = objects(document.get("videos"), "videos")
    names = ", ".join(shown(as_object(one, "videos").get("file_name", one.get("name"))) for one in videos[:5])
    return BadInput(
        f"the annotations are of several videos ({names or 'by video_id'}); write one file for each",
        code="annotations_several_videos",
        where="videos",
    )
