"""The nearest of ascending values, such as the frame nearest to a time."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from fractions import Fraction


def nearest_index(values: Sequence[float | Fraction], wanted: float | Fraction) -> int:
    """Index of the value nearest to the one wanted; the smaller of two that are equally near.

    Args:
        values: at least one, strictly ascending. Fractions and whole numbers are compared exactly.
        wanted: may lie outside them.
    """
    right = bisect_left(values, wanted)
    if right == 0:
        return 0
    if right == len(values):
        return right - 1
    return right - 1 if wanted - values[right - 1] <= values[right] - wanted else right
