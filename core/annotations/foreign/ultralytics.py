"""Ultralytics: results as JSON, of one picture or of the frames of a video in their order."""

from __future__ import annotations

from collections.abc import Sequence

from core.annotations.checks import as_list, as_object
from core.annotations.foreign.sheet import FROM_ZERO, SHARES, Shape, Sheet, number_in_name
from core.annotations.foreign.values import number, numbers, objects, text, track_of
from core.json_files import JsonObject

DROPS = {"keypoints": "set of keypoints", "class": "class of a whole picture"}


def recognises(document: object) -> bool:
    """Whether a JSON value is the results of a picture, or a list of such results."""
    if not isinstance(document, list):
        return False
    pictures = document if document and all(isinstance(one, list) for one in document) else [document]
    found = [one for picture in pictures for one in picture]
    return bool(found) and all(isinstance(one, dict) and "name" in one and "class" in one for one in found)


def read(document: list[object], name: str, sheet: Sheet, beside: Sequence[object] = ()) -> None:
    """Read the results of one picture, whose number is in the file's name, or of all frames from the first on."""
    if not isinstance(document[0], list):
        _add(number_in_name(name), name, document, "results", sheet)
        return
    sheet.clocks = FROM_ZERO
    for i, frame in enumerate(document):
        _add(str(i), f"frame {i}", frame, f"[{i}]", sheet)


def _add(key: str, name: str, results: object, where: str, sheet: Sheet) -> None:
    shapes = [_shape(one, f"{where}[{i}]", sheet) for i, one in enumerate(objects(results, where))]
    drawn = [one for one in shapes if one is not None]
    ends = [side for one in drawn if one.box is not None for side in one.box]
    unit = SHARES if ends and max(ends) <= 1 else None
    sheet.add(key, name, drawn, unit=unit)


def _shape(one: JsonObject, where: str, sheet: Sheet) -> Shape | None:
    if "box" not in one:
        sheet.drop("class")
        return None
    if one.get("keypoints"):
        sheet.drop("keypoints")
    sides = as_object(one["box"], f"{where}.box")
    outline = None
    if "x3" in sides:  # a turned box, by its corners
        outline = tuple((number(sides[f"x{i}"], where), number(sides[f"y{i}"], where)) for i in (1, 2, 3, 4)
                        if f"x{i}" in sides and f"y{i}" in sides)  # fmt: skip
        box = None
    else:
        x1, y1, x2, y2 = (number(sides.get(side), f"{where}.box.{side}") for side in ("x1", "y1", "x2", "y2"))
        box = (x1, y1, x2, y2)
        outline = _segments(one.get("segments"), where)
    score = one.get("confidence")
    return Shape(
        text(one.get("name"), f"{where}.name"),
        box,
        outline,
        None if score is None else number(score, f"{where}.confidence"),
        track_of(one.get("track_id")),
    )


def _segments(value: object, where: str) -> tuple[tuple[float, float], ...] | None:
    if not value:
        return None
    sides = as_object(value, f"{where}.segments")
    xs = numbers(as_list(sides.get("x"), f"{where}.segments.x"), f"{where}.segments.x")
    ys = numbers(sides.get("y"), f"{where}.segments.y", len(xs))
    return tuple(zip(xs, ys, strict=True))
