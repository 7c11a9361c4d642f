"""The nearest of ascending values: ties, ends, and the same index as the array forms that the callers had."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from core.geometry.nearest import nearest_index


@pytest.mark.parametrize(
    ("wanted", "expected"),
    [(-5, 0), (0, 0), (1, 0), (Fraction(3, 2), 1), (Fraction(7, 2), 1), (Fraction(36, 10), 2), (99, 2)],
)
def test_nearest_of_exact_values(wanted: int | Fraction, expected: int) -> None:
    assert nearest_index([0, 2, 5], wanted) == expected


def test_nearest_of_floats_is_what_arrays_give() -> None:
    rng = np.random.default_rng(4)
    for _ in range(50):
        times = np.cumsum(rng.choice([1 / 25, 1 / 24, 0.001, 0.2], 40))
        middle = (times[1:] + times[:-1]) / 2
        wanted = np.concatenate([times, middle, rng.uniform(-0.1, times[-1] + 0.1, 100)])
        after = np.clip(np.searchsorted(times, wanted), 0, len(times) - 1)
        before = np.clip(after - 1, 0, None)
        by_search = np.where(np.abs(times[before] - wanted) <= np.abs(times[after] - wanted), before, after)
        by_all = [int(np.abs(times - value).argmin()) for value in wanted]
        found = [nearest_index(times.tolist(), value) for value in wanted.tolist()]
        assert found == by_search.tolist() == by_all
