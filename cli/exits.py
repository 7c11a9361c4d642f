"""How errors leave the command line: exit codes (a contract, docs/outputs.md) and one line of text."""

from __future__ import annotations

from core.errors import BadInput, BladeAtlasError, Cancelled, NoReconstruction

DONE = 0
INTERNAL = 1
BAD_INPUT = 2
NO_RECONSTRUCTION = 3
PARTIAL = 4
INTERRUPTED = 130

_BY_KIND: tuple[tuple[type[BladeAtlasError], int], ...] = (
    (BadInput, BAD_INPUT),
    (NoReconstruction, NO_RECONSTRUCTION),
    (Cancelled, INTERRUPTED),
)


def exit_code(error: BladeAtlasError) -> int:
    """Exit code of an expected error; resources and failed stages are internal errors."""
    return next((code for kind, code in _BY_KIND if isinstance(error, kind)), INTERNAL)


def one_line(error: BladeAtlasError) -> str:
    """An expected error: where, then what. `cli.terminal.say` keeps it on one line."""
    message = error.message.strip()
    return f"{error.where}: {message}" if error.where and error.where not in message else message
