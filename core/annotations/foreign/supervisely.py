"""Supervisely: annotations of a video, and of pictures."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.checks import as_object
from core.annotations.foreign.bitmaps import largest, png_outlines
from core.annotations.foreign.sheet import FROM_ZERO, Points, Shape, Sheet, frame_number, number_in_name
from core.annotations.foreign.values import box_between, needed_size, numbers, objects, points, text, whole
from core.geometry.boxes import Box
from core.json_files import JsonObject

DROPS = {
    "point": "point",
    "line": "polyline",
    "graph": "graph of keypoints",
    "cuboid": "cuboid",
    "mask": "mask that cannot be unpacked",
    "part": "further part of an outline",
    "hole": "hole in an outline",
    "tag": "tag",
}
_OTHERS = {"point": "point", "line": "line", "graph": "graph", "graph_nodes": "graph"}


def recognises(document: object) -> bool:
    """Whether a JSON value is an annotation of Supervisely."""
    if not isinstance(document, dict) or not isinstance(document.get("size"), dict):
        return False
    return isinstance(document.get("objects"), list) and "height" in document["size"]


def read(document: JsonObject, name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read the figures of a video's frames (`index` is from 0), or of one picture, known by the file's name."""
    size = needed_size(document["size"].get("width"), document["size"].get("height"), "size")
    things = objects(document["objects"], "objects")
    if document.get("tags"):
        sheet.drop("tag", len(objects(document["tags"], "tags")))
    if "frames" not in document:
        shapes = [_shape(one, text(one.get("classTitle"), "classTitle"), None, f"objects[{i}]", sheet)
                  for i, one in enumerate(things)]  # fmt: skip
        sheet.add(number_in_name(name), name, [one for one in shapes if one is not None], unit=size, size=size)
        return
    sheet.clocks = FROM_ZERO
    known = {}
    for i, one in enumerate(things):
        for member in ("key", "id"):
            if isinstance(one.get(member), str | int):
                known[one[member]] = (i, text(one.get("classTitle"), f"objects[{i}].classTitle"))
    for f, frame in enumerate(objects(document["frames"], "frames")):
        where = f"frames[{f}]"
        key = frame_number(whole(frame.get("index"), f"{where}.index"), f"{where}.index")
        sheet.add(key, f"frame {key}", unit=size, size=size)
        for g, figure in enumerate(objects(frame.get("figures"), f"{where}.figures")):
            here = f"{where}.figures[{g}]"
            ids = (one for one in (figure.get("objectKey"), figure.get("objectId")) if isinstance(one, str | int))
            track, label = next((known[one] for one in ids if one in known), (None, ""))
            geometry = as_object(figure.get("geometry"), f"{here}.geometry")
            shape = _shape({**geometry, "geometryType": figure.get("geometryType")}, label, track, here, sheet)
            if shape is not None:
                sheet.add(key, f"frame {key}", [shape], unit=size, size=size)


def _shape(figure: JsonObject, label: str, track: int | None, where: str, sheet: Sheet) -> Shape | None:
    kind = text(figure.get("geometryType"), f"{where}.geometryType")
    box: Box | None = None
    outline: Points | None = None
    if kind in ("rectangle", "polygon"):
        drawn = as_object(figure.get("points"), f"{where}.points")
        corners = points(drawn.get("exterior"), f"{where}.points.exterior")
        if drawn.get("interior"):
            sheet.drop("hole", len(drawn["interior"]) if isinstance(drawn["interior"], list) else 1)
        box = box_between(corners)
        outline = corners if kind == "polygon" else None
    elif kind == "bitmap":
        outline = _bitmap(as_object(figure.get("bitmap"), f"{where}.bitmap"), where, sheet)
        box = box_between(outline)
    else:
        sheet.drop(_OTHERS.get(kind, "cuboid"))
        return None
    return None if box is None else Shape(label, box, outline, track_id=track)


def _bitmap(bitmap: JsonObject, where: str, sheet: Sheet) -> Points:
    x, y = numbers(bitmap.get("origin"), f"{where}.bitmap.origin", 2)
    data = text(bitmap.get("data"), f"{where}.bitmap.data")
    return largest(lambda: png_outlines(data, (x, y), sheet.spend, packed=True), sheet)
