"""YOLO and Ultralytics: a text file for each picture, with the names of the classes beside them.

A row is a class and its box (centre and size), or its outline; then, of detectors, a confidence and a track. How many
numbers a row has does not say which: that is settled over all rows of the data set.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import yaml

from core.annotations.checks import as_number, invalid, shown
from core.annotations.foreign.sheet import SHARES, Shape, Sheet, number_in_name
from core.annotations.foreign.values import centre_box, pairs
from core.errors import BadInput
from core.json_files import JsonObject

DROPS = {"keypoints": "set of keypoints"}
_MAX_YAML = 1 << 18
_MAX_CLASS = 100_000
_CLASS = re.compile(r"[0-9]{1,6}")
_ROW = re.compile(r"[0-9]+(\s+[-+]?([0-9]+(\.[0-9]*)?|\.[0-9]+)(e[-+]?[0-9]+)?){4,}", re.IGNORECASE)
_PICTURE = re.compile(r"(.*)\.(jpe?g|png|bmp|tiff?|webp)", re.IGNORECASE)
_NAMES = ("classes.txt", "labels.txt", "obj.names")
_LISTS = ("train", "val", "valid", "test")
_BOX = 5
"""Numbers of a row that is only a class and a box."""


@dataclass(frozen=True)
class _Row:
    label: str
    values: list[float]
    words: list[str]
    where: str


def is_label_text(text: str) -> bool:
    """Whether every line of a text is a row of YOLO. An empty text is one, too: of a picture without things."""
    return all(_ROW.fullmatch(line.strip()) for line in text.splitlines() if line.strip())


def read(texts: Mapping[str, str], pictures: Sequence[str], sheet: Sheet) -> None:
    """Read a data set.

    Args:
        texts: all text files of the archive by name.
        pictures: names of pictures in the archive; those without a text file have nothing on them.
        sheet: takes the pictures.

    Raises:
        BadInput: a row is no row of YOLO, or the file that names the classes cannot be read.
    """
    names, keypoints = _class_names(texts)
    if not names:
        sheet.note("nothing names the classes of YOLO (data.yaml, classes.txt, obj.names): labels are their numbers")
    rows: dict[str, list[_Row]] = {}
    listed = list(pictures)
    for name, content in texts.items():
        if name.rpartition("/")[2].lower() in _NAMES or not is_label_text(content):
            listed += [line.strip() for line in content.splitlines() if _PICTURE.fullmatch(line.strip())]
            continue
        stem = _stem(name)
        if not content.strip() and stem in _LISTS:
            continue
        if rows.get(stem):
            raise BadInput(
                f"two text files of YOLO are of the picture {shown(stem)}; one video at a time is read",
                code="annotations_several_videos",
                where=shown(name),
            )
        rows[stem] = [
            _row(line, names, f"{name}, line {i + 1}") for i, line in enumerate(content.splitlines()) if line.strip()
        ]
    for picture in listed:
        rows.setdefault(_stem(picture), [])
    longest = max((len(row.values) for found in rows.values() for row in found), default=0)
    scored = _sixth_is_score(rows)
    for stem, found in rows.items():
        shapes = [_shape(row, longest, scored, keypoints, sheet) for row in found]
        sheet.add(number_in_name(stem), stem, shapes, unit=SHARES)


def _stem(name: str) -> str:
    """Name of a picture, by that of its labels or its own."""
    last = name.replace("\\", "/").rpartition("/")[2]
    found = _PICTURE.fullmatch(last)
    return found[1] if found else last.removesuffix(".txt")


def _row(line: str, names: Mapping[int, str], where: str) -> _Row:
    words = line.split()
    number = int(words[0]) if len(words[0]) < 7 else _MAX_CLASS + 1
    if number > _MAX_CLASS or (names and number not in names):
        raise invalid(where, f"has the class {words[0][:20]}, which has no name")
    values = [as_number(float(word), where) for word in words]
    return _Row(names.get(number, words[0]), values, words, where)


def _sixth_is_score(rows: Mapping[str, Sequence[_Row]]) -> bool:
    """Whether rows of a box and one number more end with a confidence: a track is a whole number."""
    sixth = [row.words[_BOX] for found in rows.values() for row in found if len(row.values) == _BOX + 1]
    return any(not word.isdigit() for word in sixth)


def _shape(row: _Row, longest: int, scored: bool, keypoints: bool, sheet: Sheet) -> Shape:
    values, words = row.values[1:], row.words[1:]
    if keypoints and len(values) > 4:
        sheet.drop("keypoints")
        return Shape(row.label, centre_box(values[0], values[1], values[2], values[3]))
    if len(values) == 4:
        return Shape(row.label, centre_box(values[0], values[1], values[2], values[3]))
    if longest <= 7 and len(values) == 5:
        score, track = (values[4], None) if scored else (None, int(values[4]))
        return Shape(row.label, centre_box(values[0], values[1], values[2], values[3]), None, score, track)
    if longest <= 7 and len(values) == 6 and words[5].isdigit():
        box = centre_box(values[0], values[1], values[2], values[3])
        return Shape(row.label, box, None, values[4], int(values[5]))
    score, track = None, None
    # Corners are shares, so a whole number above 1 is a track; what is left over of the pairs is a confidence.
    if words[-1].isdigit() and values[-1] > 1:
        track = int(words[-1])
        values = values[:-1]
    if len(values) % 2:
        *values, score = values
    if len(values) < 6:
        raise invalid(row.where, f"has {len(row.values)} numbers, which are neither a box nor an outline")
    return Shape(row.label, None, pairs(values, row.where), score, track)


def _class_names(texts: Mapping[str, str]) -> tuple[dict[int, str], bool]:
    """Names by number, and whether rows hold keypoints."""
    for name, content in texts.items():
        last = name.rpartition("/")[2].lower()
        if last in _NAMES or last.endswith(".names"):
            return dict(enumerate(line.strip() for line in content.splitlines() if line.strip())), False
        if last.endswith((".yaml", ".yml")) and "names" in content:
            described = _yaml(content, name)
            return _names_of(described.get("names"), name), "kpt_shape" in described
    return {}, False


def _yaml(content: str, name: str) -> JsonObject:
    if len(content) > _MAX_YAML:
        raise BadInput(f"'{name}' is too long for a list of classes", code="annotations_too_large", where=name)
    try:
        # All values as texts: a class may be called "no", and nothing is made that a text could expand to.
        value = yaml.load(content, Loader=yaml.BaseLoader)
    except (yaml.YAMLError, RecursionError, ValueError):
        raise BadInput(f"'{name}' is not valid YAML", code="annotations_malformed", where=name) from None
    return value if isinstance(value, dict) else {}


def _names_of(value: object, where: str) -> dict[int, str]:
    if isinstance(value, list) and all(isinstance(one, str) for one in value):
        return dict(enumerate(value))
    if isinstance(value, dict) and all(_CLASS.fullmatch(key) and isinstance(one, str) for key, one in value.items()):
        return {int(key): one for key, one in value.items()}
    raise invalid(f"{where}: names", f"must be a list of names, not {shown(value)}")
