"""Pairs over gaps: where they are sought, and which are believed."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.matching.bridges import (
    COMPONENT_FRAMES,
    MAX_PAIRS,
    SIDE,
    agreeing,
    bridge_places,
    components_of,
    facing,
    find_gaps,
    select,
)
from core.viewgraph import PairTable
from core.windows import sequential_pairs

N, WINDOW = 40, 5
TURNED = [Rotation.from_rotvec(np.radians([0.3, 1.1, 2.0]) * i) for i in range(N)]


def table(pairs: list[tuple[int, int]], inliers: list[int], error_deg: list[float] | None = None) -> PairTable:
    errors = error_deg or [0.0] * len(pairs)
    rotations = [
        (Rotation.from_euler("x", error, degrees=True) * TURNED[b] * TURNED[a].inv()).as_quat()
        for (a, b), error in zip(pairs, errors, strict=True)
    ]
    m = len(pairs)
    return PairTable(
        np.array(pairs, np.int32).reshape(-1, 2),
        np.zeros(m, np.uint8),
        np.array(inliers, np.int32),
        np.full(m, 2, np.uint8),
        np.cumsum([0, *inliers]).astype(np.int64),
        np.zeros((sum(inliers), 2), np.uint32),
        np.array(rotations).reshape(-1, 4),
        np.zeros((m, 3)),
        np.zeros(m, np.float32),
    )


def sought(base: PairTable, n_search: int) -> list[tuple[int, int]]:
    places = bridge_places(base, n_search)
    pairs = [pair for place in places for pair in place.pairs]
    assert len(set(pairs)) == len(pairs)
    assert all(place.pairs for place in places)
    return pairs


def sequence(dark: range = range(0)) -> PairTable:
    pairs = sequential_pairs(N, WINDOW)
    return table(pairs, [0 if a in dark or b in dark else 200 for a, b in pairs])


def test_an_unbroken_sequence_asks_for_nothing() -> None:
    assert find_gaps(sequence(), N) == []
    assert sought(sequence(), N) == []


def test_pairs_are_sought_across_a_dark_stretch_from_the_frames_that_are_good() -> None:
    dark = range(18, 25)
    base = sequence(dark)
    assert find_gaps(base, N) == [(17, 25)]
    pairs = sought(base, N)
    near = [(a, b) for a, b in pairs if a > 17 - SIDE and b < 25 + SIDE]
    assert len(near) == SIDE * SIDE
    assert not [pair for pair in pairs if set(pair) & set(dark)]
    assert {(a <= 17, b >= 25) for a, b in pairs} == {(True, True)}


def test_a_thin_place_is_strengthened_too() -> None:
    pairs = sequential_pairs(N, WINDOW)
    base = table(pairs, [0 if a <= 19 < b and (a, b) not in ((19, 20), (18, 20)) else 200 for a, b in pairs])
    assert find_gaps(base, N) == [(19, 20)]
    assert len(np.unique(components_of(base, N))) == 1
    known = {tuple(pair) for pair in base.pairs.tolist()}
    assert not known & set(sought(base, N))
    assert (14, 25) in sought(base, N)


def test_a_clip_without_texture_asks_for_nothing() -> None:
    pairs = sequential_pairs(N, WINDOW)
    assert sought(table(pairs, [0] * len(pairs)), N) == []


def test_small_components_are_not_sought_out() -> None:
    small = COMPONENT_FRAMES - 2
    dark = range(small, small + 10)
    pairs = sought(sequence(dark), N)
    assert len(pairs) == small * SIDE


@pytest.mark.parametrize("reverse", [False, True])
def test_pairs_that_agree_are_believed_and_the_odd_one_is_not(reverse: bool) -> None:
    base = sequence(range(18, 25))
    wanted = [(17, 25), (16, 26), (15, 25), (12, 30), (14, 27)]
    errors = [0.0, 1.0, -1.0, 0.5, 30.0]
    if reverse:  # the odd ones are most: nothing can be believed
        errors = [0.0, 20.0, -20.0, 40.0, 30.0]
    extra = table(wanted, [60] * 5, errors)
    assert agreeing(base, extra, N, N).tolist() == ([False] * 5 if reverse else [True] * 4 + [False])


@pytest.mark.parametrize(
    ("off_deg", "n_search", "believed"),
    [(0.0, N, True), (20.0, N, False), (0.0, 30, False)],
    ids=["as the motion foretells", "against it", "the motion after the gap is not known"],
)
def test_the_motion_before_and_after_stands_for_a_third_pair(off_deg: float, n_search: int, believed: bool) -> None:
    base = sequence(range(18, 25))
    extra = table([(17, 25), (16, 26), (15, 27)], [60, 60, 20], [off_deg, off_deg, 0.0])
    assert agreeing(base, extra, N, n_search).tolist() == [believed, believed, False]
    assert not agreeing(base, table([(17, 25)], [60]), N, n_search).any()


def test_a_motion_that_changes_over_the_gap_foretells_nothing() -> None:
    base = sequence(range(18, 25))
    later = (base.pairs >= 25).all(axis=1)  # from the gap on the view turns the other way
    turned = base.rotation_xyzw.copy()
    turned[later, :3] *= -1.0
    extra = table([(17, 25), (16, 26)], [60, 60])
    assert not agreeing(replace(base, rotation_xyzw=turned), extra, N, N).any()


def test_light_faces_light_over_a_dark_stretch_that_hangs_together_by_itself() -> None:
    dark = range(16, 24)
    pairs = sequential_pairs(N, WINDOW)
    base = table(pairs, [200 if (a in dark) == (b in dark) else 0 for a, b in pairs])
    places = bridge_places(base, N)
    assert [len(np.unique(components_of(base, N))), len(places[0].pairs), places[0].probes] == [
        3,
        SIDE * SIDE,
        MAX_PAIRS,
    ]
    assert places[0].pairs[0] == (15, 24)
    assert all(a <= 15 and b >= 24 for a, b in places[0].pairs)
    assert any(a in dark or b in dark for place in places[1:] for a, b in place.pairs)


def test_no_component_is_looked_over_by_a_smaller_one() -> None:
    sizes = [9, 3, 20, 5, 9]
    starts = np.cumsum([0, *sizes])
    components = [np.arange(start, start + size) for start, size in zip(starts, sizes, strict=False)]
    found = [(int(a[0]), int(b[0])) for a, b in facing(components)]
    of = {int(starts[row]): row for row in range(5)}
    assert [(of[a], of[b]) for a, b in found] == [(0, 2), (2, 4), (2, 3), (3, 4), (0, 1), (1, 2)]


def test_within_one_component_strong_pairs_are_believed() -> None:
    extra = table([(3, 12), (4, 14)], [40, 10])
    assert agreeing(sequence(), extra, N, N).tolist() == [True, False]


def test_what_is_not_believed_stays_as_tried_in_vain() -> None:
    extra = table([(3, 12), (4, 14)], [40, 50])
    kept = select(extra, np.array([False, True]))
    assert kept.pairs.tolist() == extra.pairs.tolist()
    assert kept.n_inliers.tolist() == [0, 50]
    assert len(kept.inliers) == 50
