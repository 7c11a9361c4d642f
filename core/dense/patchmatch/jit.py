"""How kernels are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit

_OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": True, "error_model": "numpy"}


def kernel(function: Callable[..., Any]) -> Any:
    """Compile a function to machine code that runs without the GIL, cached on disk for later processes.

    numba keeps the cache beside the source, or in the user's cache folder when that is read-only. Where neither can be
    written the kernel is compiled in each process. Compilation is single-threaded on purpose: callers split rows
    over threads themselves, which keeps results independent of their number.
    """
    try:
        return njit(cache=True, **_OPTIONS)(function)
    except RuntimeError:
        return njit(**_OPTIONS)(function)
