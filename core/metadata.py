"""Metadata of an inspection: what the people who use the result know of the engine and the work, as names and texts.

Nothing in the method reads it. It travels with the inspection, and comes out in `summary.json`.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from core.errors import BadInput

KNOWN_METADATA = {
    "engine_type": "type of the engine",
    "engine_serial": "serial number of the engine",
    "module": "module of the engine, e.g. HPT",
    "stage": "stage of the module",
    "position": "where the probe went in",
    "work_order": "number of the work order",
    "inspector": "who inspects",
    "equipment": "borescope and probe",
}
"""Names with a fixed meaning; others are free."""
MAX_ENTRIES = 32
"""Entries that the metadata of one inspection may have."""
MAX_TEXT = 256
"""Characters of a value."""
NAME_PATTERN = "^[a-z][a-z0-9_]{0,63}$"
"""What a name is made of."""

_NAME = re.compile(NAME_PATTERN)


def is_metadata_name(name: str) -> bool:
    """True for a name that an entry may have."""
    return _NAME.fullmatch(name) is not None and not name.endswith("\n")


def parse_metadata(value: object, where: str) -> dict[str, str]:
    """The metadata of a parameter file.

    Args:
        value: what stands in the file under ``metadata``, not checked yet.
        where: the file, for messages.

    Raises:
        BadInput: it is no object of names and texts, or has more or longer ones than may be.
    """
    if not isinstance(value, dict):
        raise BadInput("'metadata' must be an object of names and texts", where=where)
    for name, text in value.items():
        if not isinstance(name, str) or not is_metadata_name(name):
            raise BadInput(f"'{str(name)[:64]}' is no name for metadata: small letters, digits and _", where=where)
        if not isinstance(text, str) or len(text) > MAX_TEXT or "\0" in text:
            raise BadInput(f"'metadata.{name}' must be a text of at most {MAX_TEXT} characters", where=where)
    require_few(value, where)
    return {name: text for name, text in value.items() if text}


def require_few(metadata: Mapping[str, str], where: str) -> None:
    """`BadInput` for more entries than may be."""
    if len(metadata) > MAX_ENTRIES:
        message = f"metadata may have at most {MAX_ENTRIES} entries, not {len(metadata)}"
        raise BadInput(message, code="too_much_metadata", where=where)
