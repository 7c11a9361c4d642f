"""JSON files as results are kept in: UTF-8, finite numbers, keys in their given order."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

JsonObject = dict[str, Any]
"""An object of a JSON file. `Any`, because its members are of many types: each gets its own where it is read, those of
strangers' files by functions that name the place when it is of another."""


def write_json(path: Path, value: object) -> None:
    """Write JSON in UTF-8, keys in their given order; ValueError for a number that is not finite."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, indent=1)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text + "\n", encoding="utf-8", newline="\n")


def replace_file(path: Path, write: Callable[[Path], object]) -> None:
    """Have a file of a result written beside its place and put there at once: who reads it sees the old or the new."""
    beside = path.with_name(f".{path.name}.new")
    write(beside)
    beside.replace(path)


def read_json(path: Path) -> Any:
    """Read a JSON file in UTF-8.

    The value has no type: files read here were written by this program, and the reader knows the form of its own.
    """
    return json.loads(path.read_text(encoding="utf-8"))
