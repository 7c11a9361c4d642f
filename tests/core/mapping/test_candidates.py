"""Which of the patches under a detection is its place, and when none is."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from core.mapping.candidates import Candidate, choose


def candidate(share: float = 0.9, depth: float | None = None, sparse: float | None = None, **more: Any) -> Candidate:
    patch: Any = SimpleNamespace(share=share)
    return Candidate(more.get("detection", 0), patch, np.zeros(3), np.ones(3), more.get("nearest", True), depth, sparse)


def chosen(
    candidates: list[Candidate], visible: list[int], support: list[int], maps: bool = True
) -> dict[int, tuple[int, float]]:
    said: Any = SimpleNamespace(n_visible=np.array(visible), n_support=np.array(support))
    return choose(candidates, said, maps)


def test_the_pixels_are_no_place_when_nothing_else_speaks_for_it() -> None:
    assert chosen([candidate(0.2)], [0], [0]) == {}
    assert chosen([candidate(0.9)], [0], [0]) == {}
    assert chosen([candidate(0.4)], [0], [0], maps=False) == {}
    assert chosen([candidate(0.6)], [0], [0], maps=False) == {0: (0, float("inf"))}, "nothing could have spoken"
    assert chosen([candidate(0.2, depth=0.2, sparse=0.3)], [4], [0]) == {}
    for heard in (candidate(0.6, depth=0.5), candidate(0.2, depth=0.7), candidate(0.2, sparse=0.7)):
        assert chosen([heard], [0], [0]) == {0: (0, float("inf"))}
    assert chosen([candidate(0.2)], [3], [1]) == {0: (0, float("inf"))}, "a view has a box over it"


def test_what_is_heard_wins_over_the_nearest_that_is_not() -> None:
    rows = [candidate(0.9), candidate(0.3, depth=0.9, nearest=False), candidate(0.7, depth=0.6, detection=1)]
    assert {detection: row for detection, (row, _) in chosen(rows, [0, 0, 0], [0, 0, 0]).items()} == {0: 1, 1: 2}


def test_sparse_points_before_a_patch_contradict_it_unless_maps_or_views_show_it_there() -> None:
    assert chosen([candidate(sparse=0.1)], [6], [2]) == {}
    assert chosen([candidate(sparse=0.1)], [6], [4]) == {0: (0, float("inf"))}
    assert chosen([candidate(sparse=0.1, depth=0.8)], [6], [2]) == {0: (0, float("inf"))}


def test_a_fifth_of_the_points_on_a_patch_is_enough() -> None:
    assert chosen([candidate(sparse=0.2)], [6], [2]) == {0: (0, float("inf"))}
    assert chosen([candidate(sparse=0.199)], [6], [2]) == {}
    assert chosen([candidate(sparse=0.1)], [6], [3]) == {}, "no more than half of the views"


def test_the_nearer_of_two_that_as_much_speaks_for_is_meant() -> None:
    """What is seen through a nick may lie under most of its pixels."""
    rows = [candidate(0.8, nearest=False), candidate(0.1)]
    assert {detection: row for detection, (row, _) in chosen(rows, [8, 8], [4, 4]).items()} == {0: 1}
    assert {detection: row for detection, (row, _) in chosen(rows, [8, 8], [8, 4]).items()} == {0: 0}
