"""The user's files: refused early, with the cause, before anything tries to understand them."""

from __future__ import annotations

from pathlib import Path

from core.errors import BadInput


def require_file(path: Path, what: str) -> int:
    """Size in bytes of a non-empty readable regular file.

    Args:
        path: the user's file.
        what: what it should be, for the message, e.g. ``video``.

    Raises:
        BadInput: `missing_file`, `not_a_file`, `unreadable_file` or `empty_file`; the message names the file.
    """
    try:
        there = path.exists()
    except OSError as error:
        message = f"the {what} file's name cannot be used: {error.strerror}"
        raise BadInput(message, code="unreadable_file", where=what) from None
    if not there:
        raise BadInput(f"the {what} file '{path.name}' does not exist", code="missing_file", where=what)
    if not path.is_file():
        kind = "a directory" if path.is_dir() else "not a regular file"
        raise BadInput(f"the {what} '{path.name}' is {kind}", code="not_a_file", where=what)
    try:
        with path.open("rb") as stream:
            empty = not stream.read(1)
    except PermissionError:
        raise BadInput(f"the {what} file '{path.name}' may not be read", code="unreadable_file", where=what) from None
    if empty:
        raise BadInput(f"the {what} file '{path.name}' is empty", code="empty_file", where=what)
    return path.stat().st_size
