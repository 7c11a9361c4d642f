"""How kernels are compiled."""

from __future__ import annotations

from numba import njit

from core.jit import Function, compiled

_OPTIONS: dict[str, object] = {"fastmath": True, "error_model": "numpy", "_nrt": False}
"""`_nrt` off: kernels allocate nothing, so numba need not count references (20 atomic operations a patch otherwise)."""


def kernel(function: Function) -> Function:
    """Compile a function; see `core.jit.compiled`."""
    return compiled(function, **_OPTIONS)


def inlined(function: Function) -> Function:
    """A part of a kernel, copied into its callers before compilation.

    Calls between compiled functions copy every array's descriptor; in the innermost loops that costs more
    than the arithmetic.
    """
    made: Function = njit(inline="always", nogil=True, **_OPTIONS)(function)
    return made
