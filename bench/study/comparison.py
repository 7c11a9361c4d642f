"""The page against the gallery, within each person; nothing is said with fewer than sixteen people.

Each person used both, on different scenes; which came first and on which scene is balanced over four groups, so the
mean difference within persons holds neither the order nor the scene. How likely a difference of that size is by chance
is computed by turning the signs of the persons' differences (Fisher's randomisation test), which needs no
distribution; four measures are looked at, so the figures are Holm's.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.study.records import N_GROUPS, Condition, Part, Person

NEEDED = 16
LEVEL = 0.05
_EXACT = 16
"""Persons up to which all ways to turn signs are counted; beyond, as many are drawn."""
_DRAWS = 1 << _EXACT

F64 = NDArray[np.float64]

MEASURES: Mapping[str, tuple[Callable[[Part], float], bool]] = {
    "answers right, share": (lambda part: part.share_right, True),
    "right answers a minute": (lambda part: part.right_a_minute, True),
    "usability (SUS, 0 to 100)": (lambda part: part.sus, True),
    "task load (NASA-TLX, 0 to 100)": (lambda part: part.tlx, False),
}
"""By name: how it is read off a part, and whether more is better."""


@dataclass(frozen=True)
class Difference:
    """One measure, page minus gallery."""

    measure: str
    gallery: float
    page: float
    difference: float
    low: float
    """Ends of the 95 % interval of the mean difference (bootstrap over persons)."""
    high: float
    chance: float
    """Holm's p."""
    page_is_better: bool | None
    """None: the study does not tell."""


def missing(people: Sequence[Person]) -> str:
    """A sentence that says what a comparison still needs; empty when nothing."""
    groups = Counter(one.group for one in people)
    least = NEEDED // N_GROUPS
    if len(people) < NEEDED:
        return f"{len(people)} people took part; at least {NEEDED} are needed: nothing is compared and nothing claimed."
    if any(groups[group] < least for group in range(N_GROUPS)):
        told = ", ".join(f"{groups[group]}" for group in range(N_GROUPS))
        return (
            f"The four groups hold {told} people; each needs at least {least}: nothing is compared and nothing claimed."
        )
    return ""


def differences(people: Sequence[Person]) -> list[Difference]:
    """All measures of a study; the people must be enough.

    Raises:
        ValueError: `missing` says what is needed.
    """
    if missing(people):
        raise ValueError(missing(people))
    table = {
        name: np.array([[read(one.parts[kind]) for kind in Condition] for one in people])
        for name, (read, _) in MEASURES.items()
    }
    own = {name: values[:, 1] - values[:, 0] for name, values in table.items()}
    chances = holm([chance(values) for values in own.values()])
    return [_difference(name, table[name], own[name], value) for name, value in zip(table, chances, strict=True)]


def _difference(name: str, values: F64, own: F64, value: float) -> Difference:
    gallery, page = values.mean(axis=0)
    low, high = interval(own)
    mean = float(own.mean())
    better = None if value >= LEVEL else (mean > 0) == MEASURES[name][1]
    return Difference(name, float(gallery), float(page), mean, low, high, value, better)


def chance(own: F64) -> float:
    """How often turned signs give a mean at least as far from 0 as these differences, both sides."""
    n = len(own)
    if n <= _EXACT:
        signs = 1.0 - 2.0 * ((np.arange(1 << n)[:, None] >> np.arange(n)) & 1)
    else:
        random = np.random.default_rng(0)
        drawn = 1.0 - 2.0 * random.integers(0, 2, (_DRAWS - 1, n))
        signs = np.vstack([np.ones(n), drawn])  # what was seen is one of the ways
    means = np.abs(signs @ own) / n
    return float((means >= abs(own.mean()) - 1e-12).mean())


def holm(chances: Sequence[float]) -> list[float]:
    """Holm's figures for several questions at once, in the same order."""
    order = np.argsort(chances, kind="stable")
    found = [0.0] * len(chances)
    largest = 0.0
    for rank, at in enumerate(order):
        largest = max(largest, min(1.0, (len(chances) - rank) * chances[at]))
        found[at] = largest
    return found


def interval(own: F64, draws: int = 10_000) -> tuple[float, float]:
    """The middle 95 % of the means of persons drawn anew with return, seed 0."""
    random = np.random.default_rng(0)
    means = own[random.integers(0, len(own), (draws, len(own)))].mean(axis=1)
    low, high = np.quantile(means, [0.025, 0.975])
    return float(low), float(high)
