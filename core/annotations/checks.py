"""Checks of single values. Each takes the path of its value, e.g. ``"12.5".detections[0].bbox``, and names it."""

from __future__ import annotations

import json
import math
import re
from fractions import Fraction

from core.errors import BadInput
from core.geometry.boxes import Box
from core.scene.detection import Polygon

_SECONDS = re.compile(r"\+?([0-9]+(\.[0-9]*)?|\.[0-9]+)(e[+-]?[0-9]{1,2})?", re.IGNORECASE)
_CLOCK = re.compile(r"([0-9]{1,4}):([0-5][0-9]):([0-5][0-9](\.[0-9]*)?)")
_MAX_KEY = 40
_MAX_SHOWN = 60
_EDGE = 1e-6
"""Rounding of a detector at the frame's edge; such coordinates are moved onto it."""


def invalid(path: str, what: str, code: str = "annotations_invalid") -> BadInput:
    """The error for the value at `path`."""
    return BadInput(f"annotations: {path} {what}", code=code, where=path, what=what)


def shown(value: object) -> str:
    """A value for a message: short JSON, or only what kind of value it is."""
    if isinstance(value, dict):
        return "an object"
    if isinstance(value, list) and not (len(value) <= 4 and all(isinstance(item, int | float) for item in value)):
        return "a list"
    if isinstance(value, str):
        return json.dumps(value if len(value) <= _MAX_SHOWN else value[:_MAX_SHOWN] + "...")
    try:
        text = json.dumps(value)
    except (TypeError, ValueError):
        return f"a value of type {type(value).__name__}"
    return text if len(text) <= 2 * _MAX_SHOWN else text[: 2 * _MAX_SHOWN] + "..."


def parse_time(key: str) -> Fraction:
    """Exact seconds of a time key: decimal seconds, or HH:MM:SS with an optional fraction.

    Raises:
        BadInput: `bad_time` when it is neither, or negative.
    """
    text, path = key.strip(), shown(key)
    if len(text) <= _MAX_KEY:
        if _SECONDS.fullmatch(text):
            return Fraction(text)
        clock = _CLOCK.fullmatch(text)
        if clock:
            return int(clock[1]) * 3600 + int(clock[2]) * 60 + Fraction(clock[3])
        if text.startswith("-") and (_SECONDS.fullmatch(text[1:]) or _CLOCK.fullmatch(text[1:])):
            if parse_time(text[1:]) == 0:
                return Fraction(0)
            raise invalid(f"key {path}", "is a negative time", "bad_time")
    raise invalid(f"key {path}", "is not a time (seconds such as 12.5, or HH:MM:SS.fff)", "bad_time")


def as_object(value: object, path: str) -> dict[str, object]:
    """`value` if it is an object."""
    if not isinstance(value, dict):
        raise invalid(path, f"must be an object, not {shown(value)}")
    return value


def as_list(value: object, path: str) -> list[object]:
    """`value` if it is a list."""
    if not isinstance(value, list):
        raise invalid(path, f"must be a list, not {shown(value)}")
    return value


def as_label(value: object, path: str) -> str:
    """`value` if it is a text with something in it that UTF-8 and a database can hold."""
    if not isinstance(value, str) or not value.strip():
        raise invalid(path, f"must be a text that is not empty, not {shown(value)}")
    if "\0" in value:
        raise invalid(path, "holds the character NUL, which no database keeps")
    try:
        value.encode("utf-8")
    except UnicodeEncodeError:
        raise invalid(path, "holds half of a surrogate pair, which is no character") from None
    return value


def as_number(value: object, path: str) -> float:
    """`value` as a finite float; true and false are not numbers."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise invalid(path, f"must be a number, not {shown(value)}")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise invalid(path, f"is {'NaN' if math.isnan(number) else 'infinite'}; numbers must be finite", "not_finite")
    return number


def as_share(value: object, path: str, code: str) -> float:
    """`value` as a number in [0, 1]."""
    number = as_number(value, path)
    if not -_EDGE <= number <= 1 + _EDGE:
        hint = "; pixels? coordinates are shares of the source frame" if number > 2 and code != "bad_score" else ""
        raise invalid(path, f"is {number:g}, outside [0, 1]{hint}", code)
    return min(1.0, max(0.0, number))


def as_score(value: object, path: str) -> float | None:
    """A score in [0, 1], or None when there is none."""
    return None if value is None else as_share(value, path, "bad_score")


def as_track_id(value: object, path: str) -> str | int | None:
    """A text or a whole number that names a track, or None."""
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise invalid(path, f"must be a text or a whole number, not {shown(value)}")
    return as_label(value, path) if isinstance(value, str) else value


def as_box(value: object, path: str) -> Box:
    """Four shares [x1, y1, x2, y2] with x1 < x2 and y1 < y2."""
    items = as_list(value, path)
    if len(items) != 4:
        raise invalid(path, f"must be [x1, y1, x2, y2], not {len(items)} values")
    x1, y1, x2, y2 = (as_share(item, f"{path}[{i}]", "box_outside") for i, item in enumerate(items))
    if x2 <= x1 or y2 <= y1:
        raise invalid(
            path, f"is {shown(items)}, inverted or empty: it must be left, upper, right, lower", "box_inverted"
        )
    return (x1, y1, x2, y2)


def as_polygon(value: object, path: str) -> Polygon:
    """Corners [[x, y], ...] in shares; how many is for the caller to judge."""
    corners = []
    for i, item in enumerate(as_list(value, path)):
        pair = as_list(item, f"{path}[{i}]")
        if len(pair) != 2:
            raise invalid(f"{path}[{i}]", f"must be [x, y], not {shown(pair)}")
        corners.append(
            (
                as_share(pair[0], f"{path}[{i}][0]", "polygon_outside"),
                as_share(pair[1], f"{path}[{i}][1]", "polygon_outside"),
            )
        )
    return tuple(corners)
