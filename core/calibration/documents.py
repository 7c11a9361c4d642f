"""The text of a calibration file as plain dictionaries, lists and texts: YAML, JSON and XML, of OpenCV and of others.

Nothing in a file can name a type to be made, refer to another file or grow: YAML is read by the loader that knows
texts only, XML without document types, and both only up to `MAX_BYTES`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import TypeAlias
from xml.etree.ElementTree import Element

import yaml

from core.calibration.model import CODE
from core.errors import BadInput
from core.xml_tree import parse_xml

MAX_BYTES = 1 << 16
"""Largest file; one of a camera has some hundred bytes, and YAML is read at some ten thousand a second."""

Document: TypeAlias = Mapping[str, object]

_NOT_YAML = re.compile(r"\A\s*%YAML[: ]1\.\d[^\n]*\n")
"""OpenCV's first line, `%YAML:1.0`, which is not YAML."""
_COLMAP_LINE = re.compile(r"\s*\d+\s+[A-Z][A-Z_]*\s+\d+\s+\d+\s")


def text_of(data: bytes, where: str) -> str:
    """The text of a file; `BadInput` when it is too large or no text."""
    if len(data) > MAX_BYTES:
        raise refused(f"the file has {len(data)} bytes; a calibration has at most {MAX_BYTES}", where)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise refused("the file is not text in UTF-8", where) from None
    if not text.strip():
        raise refused("the file is empty", where)
    return text


def is_colmap(text: str) -> bool:
    """Whether the first line that is no comment is one of COLMAP's cameras.txt."""
    lines = (line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#"))
    return _COLMAP_LINE.match(next(lines, "")) is not None


def document_of(text: str, where: str) -> Document:
    """The object that a text holds; `BadInput` when it is malformed or no object."""
    first = text.lstrip()[:1]
    value: object
    try:
        if first == "<":
            value = _of_xml(parse_xml(text.encode(), "calibration"))
        elif first == "{":
            value = json.loads(text)
        else:
            value = yaml.load(_NOT_YAML.sub("", text), Loader=yaml.BaseLoader)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark
        place = f" at line {mark.line + 1}, column {mark.column + 1}" if mark is not None else ""
        raise refused(f"the file is not valid YAML: {error.problem}{place}", where) from None
    except RecursionError:
        raise refused("the file is nested too deeply", where) from None
    except (yaml.YAMLError, ValueError) as error:
        raise refused(f"the file cannot be read: {str(error).splitlines()[0]}", where) from None
    if not isinstance(value, dict):
        raise refused("the file holds no fields of a calibration", where)
    return value


def refused(message: str, where: str) -> BadInput:
    """The error of a calibration file that cannot be used."""
    return BadInput(message, code=CODE, where=where)


def _of_xml(element: Element) -> object:
    """An element of OpenCV's XML: its text, or its children by name."""
    if not len(element):
        return (element.text or "").strip().strip('"')
    return {child.tag: _of_xml(child) for child in element}
