"""Finished scores as files, so that a table can be gone on with, and the table as Markdown."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from core.flags import Severity

Found = dict[str, Any]
"""A score and how it came about, as JSON."""


def read_found(path: Path) -> Found:
    """The object of a JSON file; empty where there is none."""
    try:
        found: Found = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found


def kept_or_new(path: Path, key: str, make: Callable[[], Found]) -> Found:
    """The score kept in a file when its `key` is still this one; else a new one, which is kept whole or not at all."""
    known = read_found(path)
    if known.get("key") == key:
        return known
    text = json.dumps({"key": key, **make()}, indent=1, allow_nan=False)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_suffix(".part")
    part.write_text(text, encoding="utf-8")
    part.rename(path)
    # As it will be read the next time: a table must not depend on which of the two it is.
    return read_found(path)


def warnings_of(quality: Found) -> list[str]:
    """Codes of the flags of a `quality.json` that are more than information, in order."""
    return sorted({flag["code"] for flag in quality.get("flags", ()) if flag["severity"] != Severity.INFO})


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Lines of a Markdown table."""
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)
