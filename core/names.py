"""Names that are not known: which known one was meant."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str | None:
    """The known name that is most like `name`; None when none is near."""
    return next(iter(difflib.get_close_matches(name, list(known), n=1)), None)


def unknown_name(what: str, name: str, known: Iterable[str]) -> str:
    """One sentence: what is unknown, and the name that was probably meant, or all that there are."""
    names = list(known)
    near = nearest(name, names)
    if near is not None:
        return f"unknown {what} '{name}'; did you mean '{near}'?"
    return f"unknown {what} '{name}'; known: {', '.join(names) or 'none'}"
