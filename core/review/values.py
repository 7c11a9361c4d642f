"""What stands in `value` of a record: its form for each action, checked member by member.

| action | value |
| --- | --- |
| accept, reject | null |
| relabel, note, severity | the text |
| set_blade | name of the blade; empty for "on none" |
| undo | id of the record that shall not hold |
| merge | target of the finding that stays |
| split | `detections`: ids of those that are a finding of their own |
| move | `point`; `normal` and `frame` where they are known |
| measure | `length`, `unit`, `points` (two), `along` (on the surface), `sigma` |
| add | `label`, `frame`, `box` in shares of the source frame; `polygon`; `point` and `normal` where the picture's rays meet the surface, else `unplaced`, the reason |

Points are (3,) in the world frame of the target's model, lengths in its unit.
"""  # noqa: E501 - a table has one row a line

from __future__ import annotations

from collections.abc import Callable, Mapping

from core.json_files import JsonObject
from core.review.checks import bad, index, is_index, is_share, length, require_member, require_text, three
from core.review.target import MAX_LABEL, Target
from core.review.words import Action

MAX_NOTE = 2000
"""Characters of a note."""
_MAX_CORNERS = 1000
_MAX_DETECTIONS = 10_000


def value_of(action: Action, value: object, where: str) -> str | JsonObject | None:
    """The value of an action in the form in which it is kept.

    Raises:
        BadInput: it is not what the action needs.
    """
    if action in (Action.ACCEPT, Action.REJECT):
        if value is not None:
            raise bad(where, "must be null")
        return None
    return _FORMS[action](value, where)


def _label(value: object, where: str) -> str:
    return require_text(value, where, MAX_LABEL)


def _blade(value: object, where: str) -> str:
    return require_text(value, where, 64, empty=True)


def _severity(value: object, where: str) -> str:
    return require_text(value, where, 64)


def _note(value: object, where: str) -> str:
    return require_text(value, where, MAX_NOTE)


def _undone(value: object, where: str) -> str:
    return require_text(value, where, 64)


def _merge(value: object, where: str) -> JsonObject:
    return Target.parse(value, where).to_dict()


def _split(value: object, where: str) -> JsonObject:
    row = require_member(value, where, ("detections",))
    ids = row.get("detections")
    if not isinstance(ids, list) or not ids or len(ids) > _MAX_DETECTIONS or not all(map(is_index, ids)):
        raise bad(f"{where}.detections", "must be a list of ids of detections")
    return {"detections": sorted(set(ids))}


def _move(value: object, where: str) -> JsonObject:
    row = require_member(value, where, ("point", "normal", "frame"))
    return {"point": list(three(row.get("point"), f"{where}.point")), **_optional(row, where)}


def _measure(value: object, where: str) -> JsonObject:
    row = require_member(value, where, ("length", "unit", "points", "along", "sigma"))
    points, sigma = row.get("points"), row.get("sigma")
    if not isinstance(points, list) or len(points) != 2:
        raise bad(f"{where}.points", "must be two points")
    if not isinstance(row.get("along", False), bool):
        raise bad(f"{where}.along", "must be true or false")
    return {
        "length": length(row.get("length"), f"{where}.length"),
        "sigma": None if sigma is None else length(sigma, f"{where}.sigma"),
        "unit": require_text(row.get("unit"), f"{where}.unit", 16),
        "along": row.get("along", False),
        "points": [list(three(point, f"{where}.points")) for point in points],
    }


def _add(value: object, where: str) -> JsonObject:
    names = ("label", "frame", "box", "polygon", "point", "normal", "unplaced")
    row = require_member(value, where, names)
    point, polygon = row.get("point"), row.get("polygon")
    kept: JsonObject = {
        "label": _label(row.get("label"), f"{where}.label"),
        "frame": index(row.get("frame"), f"{where}.frame"),
        "box": _box(row.get("box"), f"{where}.box"),
        "point": None if point is None else list(three(point, f"{where}.point")),
    }
    if polygon is not None:
        kept["polygon"] = _polygon(polygon, f"{where}.polygon")
    if point is None:
        kept["unplaced"] = require_text(row.get("unplaced") or "not_cast", f"{where}.unplaced", 64)
    elif row.get("normal") is not None:
        kept["normal"] = list(three(row["normal"], f"{where}.normal"))
    return kept


def _optional(row: Mapping[str, object], where: str) -> JsonObject:
    kept: JsonObject = {}
    if row.get("normal") is not None:
        kept["normal"] = list(three(row["normal"], f"{where}.normal"))
    if row.get("frame") is not None:
        kept["frame"] = index(row["frame"], f"{where}.frame")
    return kept


_FORMS: Mapping[Action, Callable[[object, str], str | JsonObject]] = {
    Action.RELABEL: _label,
    Action.NOTE: _note,
    Action.SEVERITY: _severity,
    Action.SET_BLADE: _blade,
    Action.UNDO: _undone,
    Action.MERGE: _merge,
    Action.SPLIT: _split,
    Action.MOVE: _move,
    Action.MEASURE: _measure,
    Action.ADD: _add,
}


def _box(value: object, where: str) -> list[float]:
    if not isinstance(value, list) or len(value) != 4 or not all(map(is_share, value)):
        raise bad(where, "must be x0, y0, x1, y1 in shares of the frame")
    x0, y0, x1, y1 = (float(one) for one in value)
    if not (x0 < x1 and y0 < y1):
        raise bad(where, "must have a width and a height")
    return [x0, y0, x1, y1]


def _polygon(value: object, where: str) -> list[list[float]]:
    if not isinstance(value, list) or not 3 <= len(value) <= _MAX_CORNERS:
        raise bad(where, f"must be 3 to {_MAX_CORNERS} corners")
    if not all(isinstance(corner, list) and len(corner) == 2 and all(map(is_share, corner)) for corner in value):
        raise bad(where, "must be corners x, y in shares of the frame")
    return [[float(x), float(y)] for x, y in value]
