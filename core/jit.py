"""How loops are compiled to machine code, everywhere in this package."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from numba import njit

Function = TypeVar("Function", bound=Callable[..., object])


def compiled(function: Function, **options: object) -> Function:
    """The same function as machine code that runs without the GIL, cached on disk for later processes.

    numba keeps the cache beside the source, or in the user's cache folder when that is read-only. Where neither can be
    written the function is compiled in each process. Compilation is single-threaded on purpose: callers split rows
    over threads themselves, which keeps results independent of their number.

    Args:
        function: in numba's subset of Python.
        options: of `numba.njit`.
    """
    try:
        made: Function = njit(cache=True, nogil=True, **options)(function)
    except RuntimeError:
        made = njit(nogil=True, **options)(function)
    return made
