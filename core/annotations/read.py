"""From a file to JSON values, within limits: nothing here may exhaust memory or accept what is not JSON."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from core.annotations.checks import shown
from core.errors import BadInput
from core.files import require_file

MAX_BYTES = 64 * 1024 * 1024
"""Largest annotation file. The thesis's 3,745 timestamps, as dense as the sample (5 kB each with masks), take
20 MB. 64 MiB of the most wasteful JSON need 1.9 GiB once parsed (measured), half of what a stage may use."""


_CUT_WORD = 5
"""Characters of the longest word of JSON, false."""


def read_bytes(path: Path) -> bytes:
    """The content of an annotation file. The size is looked at before anything is read.

    Raises:
        BadInput: `annotations_too_large`, or what `require_file` raises.
    """
    size = require_file(path, "annotation")
    if size > MAX_BYTES:
        raise BadInput(
            f"the annotation file '{path.name}' has {size / 1e6:.0f} MB; at most {MAX_BYTES / 1e6:.0f} MB are read",
            code="annotations_too_large",
            where="annotations",
        )
    return path.read_bytes()


def parse_json(data: bytes) -> object:
    """The JSON value of UTF-8 text; numbers that are not finite are left for the checks, which know their place.

    Raises:
        BadInput: `annotations_not_utf8`, `annotations_malformed` (with line and column) or `duplicate_key`.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise BadInput(
            f"the annotations are not UTF-8 text (byte {error.start})", code="annotations_not_utf8", where="annotations"
        ) from None
    try:
        return json.loads(text, object_pairs_hook=_object)
    except json.JSONDecodeError as error:
        raise BadInput(
            f"the annotations are not valid JSON: {error.msg} at line {error.lineno}, column {error.colno}"
            f"{_guess(error, text)}",
            code="annotations_malformed",
            where=f"line {error.lineno}, column {error.colno}",
        ) from None
    except RecursionError:
        raise BadInput(
            "the annotations are not usable: their JSON is nested too deeply",
            code="annotations_malformed",
            where="annotations",
        ) from None
    except ValueError:
        raise BadInput(
            "the annotations are not usable: they hold a number with thousands of digits",
            code="annotations_malformed",
            where="annotations",
        ) from None


def _guess(error: json.JSONDecodeError, text: str) -> str:
    """What is probably wrong with the whole file."""
    if error.msg == "Extra data" and text[: error.pos].rstrip(" \t\r")[-1:] == "\n":
        return "; this seems to be one JSON value for each line, of which only one is read"
    rest = text[error.pos :].strip()
    # A word or number that ends with the file has its error a few characters before the end.
    if error.msg.startswith("Unterminated string") or (len(rest) <= _CUT_WORD and not rest.endswith(("}", "]"))):
        return "; the file seems to be cut off" if text.strip() else "; the file is empty"
    return ""


def _object(pairs: Sequence[tuple[str, object]]) -> dict[str, object]:
    """A JSON object; a key that occurs twice is refused, because one of the two would be lost silently."""
    values = dict(pairs)
    if len(values) != len(pairs):
        seen: set[str] = set()
        for key, _ in pairs:
            if key in seen:
                raise BadInput(
                    f"key {shown(key)} occurs twice in one object of the annotations",
                    code="duplicate_key",
                    where=shown(key),
                )
            seen.add(key)
    return values
