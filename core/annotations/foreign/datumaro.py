"""Datumaro: items of a data set."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.checks import as_object, invalid, shown
from core.annotations.foreign.coco import unpacked
from core.annotations.foreign.sheet import FROM_ZERO, Points, Shape, Sheet, frame_number, number_in_name
from core.annotations.foreign.values import (
    box_between,
    corner_box,
    number,
    numbers,
    objects,
    pairs,
    text,
    track_of,
    whole,
)
from core.geometry.boxes import Box
from core.json_files import JsonObject

DROPS = {
    "label": "label of a whole picture",
    "polyline": "polyline",
    "points": "set of points",
    "caption": "caption",
    "cuboid": "cuboid",
    "ellipse": "ellipse",
    "mask": "mask that cannot be unpacked",
    "part": "further part of an outline",
    "other": "annotation of another kind",
}
_CUBOIDS = ("cuboid_3d", "cuboid_2d", "cuboid")


def recognises(document: object) -> bool:
    """Whether a JSON value is a subset of a Datumaro data set."""
    return isinstance(document, dict) and isinstance(document.get("items"), list) and "categories" in document


def read(document: JsonObject, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read all items; the number is the attribute `frame` where every item has it, else in the item's id."""
    kinds = as_object(document["categories"], "categories").get("label") or {}
    labels = [
        text(one.get("name"), "categories.label")
        for one in objects(as_object(kinds, "categories.label").get("labels"), "categories.label.labels")
    ]
    items = objects(document["items"], "items")
    numbered = bool(items) and all(_frame(one) is not None for one in items)
    if numbered:
        sheet.clocks = FROM_ZERO
    for i, item in enumerate(items):
        where = f"items[{i}]"
        known = text(item.get("id"), f"{where}.id")
        frame = _frame(item)
        key = frame_number(whole(frame, f"{where}.frame"), f"{where}.frame") if numbered else number_in_name(known)
        picture = as_object(item.get("image") or {}, f"{where}.image")
        sides = numbers(picture["size"], f"{where}.image.size", 2) if picture.get("size") else None
        size = None if sides is None else (sides[1], sides[0])
        sheet.add(key, known, unit=size, size=size)
        for a, one in enumerate(objects(item.get("annotations"), f"{where}.annotations")):
            shape = _shape(one, labels, f"{where}.annotations[{a}]", sheet)
            if shape is not None:
                sheet.add(key, known, [shape], unit=size, size=size)


def _frame(item: JsonObject) -> object:
    attributes, video = item.get("attr"), item.get("video_frame")
    if isinstance(video, dict) and "frame_index" in video:
        return video["frame_index"]
    return attributes.get("frame") if isinstance(attributes, dict) else None


def _shape(one: JsonObject, labels: list[str], where: str, sheet: Sheet) -> Shape | None:
    kind = text(one.get("type"), f"{where}.type")
    if kind not in ("bbox", "polygon", "mask"):
        sheet.drop("cuboid" if kind in _CUBOIDS else kind if kind in DROPS else "other")
        return None
    box: Box | None = None
    outline: Points | None = None
    if kind == "bbox":
        box = corner_box(*numbers(one.get("bbox"), f"{where}.bbox", 4))
    else:
        outline = (
            unpacked(as_object(one.get("rle"), f"{where}.rle"), f"{where}.rle", sheet)
            if kind == "mask"
            else pairs(numbers(one.get("points"), f"{where}.points"), f"{where}.points")
        )
        box = box_between(outline)
    if box is None:
        return None
    number_of = one.get("label_id")
    if number_of is not None and not (isinstance(number_of, int) and 0 <= number_of < len(labels)):
        raise invalid(f"{where}.label_id", f"is {shown(number_of)}, which no category has")
    attributes = one.get("attributes")
    attributes = attributes if isinstance(attributes, dict) else {}
    score = attributes.get("score")
    return Shape(
        "" if number_of is None else labels[number_of],
        box,
        outline,
        None if score is None else number(score, f"{where}.score"),
        track_of(attributes.get("track_id")),
    )
