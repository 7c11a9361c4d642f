"""How loops are compiled to machine code, everywhere in this package."""

from __future__ import annotations

from typing import Any

from numba import njit


def compiled(function: Any, **options: Any) -> Any:
    """Machine code that runs without the GIL, cached on disk for later processes.

    numba keeps the cache beside the source, or in the user's cache folder when that is read-only. Where neither can be
    written the function is compiled in each process. Compilation is single-threaded on purpose: callers split rows
    over threads themselves, which keeps results independent of their number.

    Args:
        function: in numba's subset of Python.
        options: of `numba.njit`.
    """
    try:
        return njit(cache=True, nogil=True, **options)(function)
    except RuntimeError:
        return njit(nogil=True, **options)(function)
