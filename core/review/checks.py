"""Checks of JSON values that strangers wrote: each gives the value in its type, or says which member is wrong."""

from __future__ import annotations

import math
from collections.abc import Sequence

from core.errors import BadInput
from core.json_files import JsonObject

_LONGEST = 1e12
"""Above this a coordinate is a mistake."""


def require_member(value: object, where: str, names: Sequence[str]) -> JsonObject:
    """An object with no other members than `names`.

    Raises:
        BadInput: it is none.
    """
    if not isinstance(value, dict):
        raise bad(where, "must be an object")
    for name in value:
        if name not in names:
            raise bad(where, f"has the unknown member '{str(name)[:64]}'; known: {', '.join(names)}")
    return value


def require_text(value: object, where: str, longest: int, *, empty: bool = False) -> str:
    """A text of at most `longest` characters that every file and database can keep.

    Raises:
        BadInput: it is none; an empty one is refused unless `empty`.
    """
    if not isinstance(value, str) or len(value) > longest:
        raise bad(where, f"must be a text of at most {longest} characters")
    if not empty and not value.strip():
        raise bad(where, "must not be empty")
    if any(is_unusable(character) for character in value):
        raise bad(where, "must not hold control characters")
    return value


def three(value: object, where: str) -> tuple[float, float, float]:
    """Three finite numbers.

    Raises:
        BadInput: they are none.
    """
    if not isinstance(value, list | tuple) or len(value) != 3 or not all(map(is_number, value)):
        raise bad(where, "must be three numbers")
    x, y, z = (float(one) for one in value)
    return x, y, z


def is_number(value: object) -> bool:
    """True for a finite number that can be a coordinate."""
    usable = isinstance(value, int | float) and not isinstance(value, bool)
    return usable and math.isfinite(value) and abs(value) <= _LONGEST  # type: ignore[arg-type]  # said above


def is_share(value: object) -> bool:
    """True for a number in [0, 1]."""
    return is_number(value) and 0 <= float(str(value)) <= 1


def is_index(value: object) -> bool:
    """True for a whole number from 0 that every database can keep."""
    return isinstance(value, int) and not isinstance(value, bool) and 0 <= value < 2**31


def is_unusable(character: str) -> bool:
    """True for a character that no text may have.

    No database keeps NUL, half a surrogate pair cannot be written, and the others hide what a text says.
    """
    code = ord(character)
    return (code < 32 and character not in "\n\t") or code == 127 or 0xD800 <= code <= 0xDFFF


def index(value: object, where: str) -> int:
    """A whole number from 0 that every database can keep.

    Raises:
        BadInput: it is none.
    """
    if not is_index(value):
        raise bad(where, "must be a whole number from 0")
    return int(str(value))


def length(value: object, where: str) -> float:
    """A finite number from 0.

    Raises:
        BadInput: it is none.
    """
    if not is_number(value) or float(str(value)) < 0:
        raise bad(where, "must be a number from 0")
    return float(str(value))


def bad(where: str, words: str) -> BadInput:
    """The error for a member: where it stands, and what it must be."""
    return BadInput(f"{where} {words}", code="bad_review", where=where)
