"""LabelMe: one JSON file for each picture."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.foreign.bitmaps import largest, png_outlines
from core.annotations.foreign.sheet import Points, Shape, Sheet, number_in_name
from core.annotations.foreign.values import box_between, needed_size, number, objects, points, text
from core.json_files import JsonObject

DROPS = {
    "circle": "circle",
    "line": "line",
    "linestrip": "polyline",
    "point": "point",
    "points": "set of points",
    "mask": "mask that cannot be unpacked",
    "part": "further part of an outline",
    "other": "shape of another kind",
}


def recognises(document: object) -> bool:
    """Whether a JSON value is a file of LabelMe."""
    return isinstance(document, dict) and isinstance(document.get("shapes"), list) and "imagePath" in document


def read(document: JsonObject, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read one picture; its number is in the name of the picture, else in that of the file."""
    picture = text(document.get("imagePath"), "imagePath") or name
    known = picture if any(char.isdigit() for char in picture) else name
    size = needed_size(document.get("imageWidth"), document.get("imageHeight"), "the picture")
    shapes = (_shape(one, f"shapes[{i}]", sheet) for i, one in enumerate(objects(document["shapes"], "shapes")))
    drawn = [one for one in shapes if one is not None]
    sheet.add(number_in_name(known), known, drawn, unit=size, size=size)


def _shape(one: JsonObject, where: str, sheet: Sheet) -> Shape | None:
    kind = text(one.get("shape_type"), f"{where}.shape_type") or "polygon"
    if kind not in ("rectangle", "polygon", "mask"):
        sheet.drop(kind if kind in DROPS else "other")
        return None
    corners = points(one.get("points"), f"{where}.points")
    box = box_between(corners)
    score = one.get("score")
    outline: Points | None = corners if kind == "polygon" else None
    if kind == "mask" and corners:
        packed, corner = text(one.get("mask"), f"{where}.mask"), corners[0]
        outline = largest(lambda: png_outlines(packed, corner, sheet.spend), sheet) or None
    return Shape(
        text(one.get("label"), f"{where}.label"),
        box,
        outline,
        None if score is None else number(score, f"{where}.score"),
    )
