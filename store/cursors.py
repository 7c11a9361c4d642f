"""Opaque cursors: where the next page of a list begins, in a form that only the service makes."""

from __future__ import annotations

import base64
import binascii
import json
from collections.abc import Sequence
from datetime import UTC, datetime

from core.errors import BadInput

CursorValue = str | int
_LARGEST = 1 << 62


def encode_cursor(name: str, values: Sequence[CursorValue]) -> str:
    """A cursor of the list `name` that stands behind the entry with these values."""
    text = json.dumps([name, *values], separators=(",", ":"))
    return base64.urlsafe_b64encode(text.encode()).decode().rstrip("=")


def decode_cursor(name: str, kinds: Sequence[type], cursor: str) -> tuple[CursorValue, ...]:
    """The values of a cursor of the list `name`, one of each kind (``str`` or ``int``).

    Raises:
        BadInput: `bad_cursor`, it was not made by `encode_cursor` for this list.
    """
    try:
        text = base64.urlsafe_b64decode(cursor + "=" * (-len(cursor) % 4))
        own, *values = json.loads(text)
    except (ValueError, TypeError, RecursionError, binascii.Error):
        raise bad_cursor() from None
    if own != name or len(values) != len(kinds) or not all(map(_fits, values, kinds)):
        raise bad_cursor()
    return tuple(values)


def moment_cursor(name: str, moment: datetime, row_id: str) -> str:
    """A cursor of a list that is ordered by a moment and then by id."""
    return encode_cursor(name, (moment.isoformat(), row_id))


def read_moment_cursor(name: str, cursor: str) -> tuple[datetime, str]:
    """The moment, in UTC, and the id that `moment_cursor` was given.

    Raises:
        BadInput: `bad_cursor`, it was not made by `moment_cursor` for this list.
    """
    text, row_id = decode_cursor(name, (str, str), cursor)
    try:
        moment = datetime.fromisoformat(str(text))
        if moment.tzinfo is None:
            raise bad_cursor()
        return moment.astimezone(UTC), str(row_id)
    except (ValueError, OverflowError):
        raise bad_cursor() from None


def bad_cursor() -> BadInput:
    """The error of a cursor that is none of ours."""
    return BadInput("this cursor was not given out by the service", code="bad_cursor", where="cursor")


def _fits(value: object, kind: type) -> bool:
    """True for a value that a database can compare: no bool for a number, no NUL and no half character in a text."""
    if kind is int:
        return type(value) is int and 0 <= value < _LARGEST
    return isinstance(value, str) and "\0" not in value and not any("\ud800" <= c <= "\udfff" for c in value)
