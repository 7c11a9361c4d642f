"""How kernels are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from numba import njit

_OPTIONS: dict[str, Any] = {"nogil": True, "fastmath": True, "error_model": "numpy", "_nrt": False}
"""`_nrt` off: kernels allocate nothing, so numba need not count references (20 atomic operations a patch otherwise)."""


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


def inlined(function: Callable[..., Any]) -> Any:
    """A part of a kernel, copied into its callers before compilation.

    Calls between compiled functions copy every array's descriptor; in the innermost loops that costs more
    than the arithmetic.
    """
    return njit(inline="always", **_OPTIONS)(function)
