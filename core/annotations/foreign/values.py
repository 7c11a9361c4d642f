"""Values of foreign files, each taken as what it must be or refused with its place."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.annotations.checks import as_list, as_number, as_object, invalid, shown
from core.annotations.foreign.sheet import Points, Size
from core.geometry.boxes import Box, bounding_box
from core.json_files import JsonObject


def objects(value: object, where: str) -> list[JsonObject]:
    """A list of objects; null is an empty one."""
    return [] if value is None else [as_object(one, f"{where}[{i}]") for i, one in enumerate(as_list(value, where))]


def numbers(value: object, where: str, count: int | None = None) -> list[float]:
    """A list of finite numbers, of a certain length."""
    items = as_list(value, where)
    if count is not None and len(items) != count:
        raise invalid(where, f"must be {count} numbers, not {len(items)} values")
    return [number(item, f"{where}[{i}]") for i, item in enumerate(items)]


def number(value: object, where: str) -> float:
    """A finite number; tools write numbers as texts here and there."""
    if isinstance(value, str):
        try:
            return as_number(float(value), where)
        except ValueError:
            raise invalid(where, f"must be a number, not {shown(value)}") from None
    return as_number(value, where)


def whole(value: object, where: str) -> int:
    """A whole number."""
    found = number(value, where)
    if found != int(found):
        raise invalid(where, f"must be a whole number, not {shown(value)}")
    return int(found)


def text(value: object, where: str) -> str:
    """A text, or a number as text; null is an empty one."""
    if value is None:
        return ""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise invalid(where, f"must be a text, not {shown(value)}")
    return str(value)


def size_of(width: object, height: object, where: str) -> Size | None:
    """Width and height in pixels; None when they are missing or zero, as tools write what they do not know."""
    if width is None or height is None:
        return None
    found = (number(width, f"{where}.width"), number(height, f"{where}.height"))
    return found if min(found) > 0 else None


def needed_size(width: object, height: object, where: str) -> Size:
    """Width and height in pixels of a format that always names them."""
    found = size_of(width, height, where)
    if found is None:
        raise invalid(where, "names no size of its picture; coordinates in pixels say nothing without it")
    return found


def pairs(flat: Sequence[float], where: str) -> Points:
    """Corners from x1, y1, x2, y2, ..."""
    if len(flat) % 2:
        raise invalid(where, f"holds {len(flat)} numbers, which are no pairs of x and y")
    return tuple(zip(flat[::2], flat[1::2], strict=True))


def points(value: object, where: str) -> Points:
    """Corners from [[x, y], ...] or [{"x": ..., "y": ...}, ...]."""
    corners: list[tuple[float, float]] = []
    for i, one in enumerate(as_list(value, where)):
        here = f"{where}[{i}]"
        if isinstance(one, dict):
            corners.append((number(one.get("x"), f"{here}.x"), number(one.get("y"), f"{here}.y")))
        else:
            x, y = numbers(one, here, 2)
            corners.append((x, y))
    return tuple(corners)


def box_between(corners: Points) -> Box | None:
    """The box around corners, in whatever order they are; None without any."""
    return bounding_box(corners) if corners else None


def corner_box(x: float, y: float, width: float, height: float) -> Box:
    """The box of its upper left corner, width and height."""
    return (x, y, x + width, y + height)


def centre_box(x: float, y: float, width: float, height: float) -> Box:
    """The box of its centre, width and height."""
    return (x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def track_of(value: object) -> str | int | None:
    """A track's name, if it is one; many files have -1, empty texts or nothing where there is none."""
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        return None
    if isinstance(value, str):
        return value.strip() or None
    return int(value) if math.isfinite(value) and value == int(value) and value >= 0 else None
