"""Pairs that triplets contradict: all wrong ones are found and no right one is lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.matching.cycles import contradicted
from core.viewgraph import PairTable
from core.windows import sequential_pairs

N, WINDOW = 30, 5
PAIRS = sequential_pairs(N, WINDOW)
TURNED = [Rotation.from_rotvec(np.radians([0.5, 2.0, 0.3]) * i) for i in range(N)]


def graph(wrong: dict[tuple[int, int], float], noise_deg: float = 0.4, inliers: int = 100) -> PairTable:
    """Pairs of a turning camera; those of `wrong` are off by so many degrees, each about an axis of its own."""
    rng = np.random.default_rng(2)
    rotations = []
    for a, b in PAIRS:
        axis = rng.standard_normal(3)
        off = Rotation.from_rotvec(np.radians(wrong.get((a, b), 0.0)) * axis / np.linalg.norm(axis))
        noise = Rotation.from_rotvec(np.radians(noise_deg) * rng.standard_normal(3))
        rotations.append((noise * off * TURNED[b] * TURNED[a].inv()).as_quat())
    m = len(PAIRS)
    return PairTable(
        np.array(PAIRS, np.int32),
        np.zeros(m, np.uint8),
        np.full(m, inliers, np.int32),
        np.full(m, 2, np.uint8),
        np.arange(m + 1) * inliers,
        np.zeros((m * inliers, 2), np.uint32),
        np.array(rotations),
        np.zeros((m, 3)),
        np.zeros(m, np.float32),
    )


def found(table: PairTable) -> set[tuple[int, int]]:
    return {PAIRS[row] for row in np.flatnonzero(contradicted(table))}


def test_a_consistent_graph_loses_nothing() -> None:
    assert found(graph({})) == set()


@pytest.mark.parametrize("wrong", [{(10, 13): 20.0}, {(10, 11): 12.0, (20, 25): 90.0}, {(3, 4): 30.0, (4, 5): 30.0}])
def test_single_wrong_pairs_are_told_from_the_right_ones_of_their_triplets(wrong: dict[tuple[int, int], float]) -> None:
    assert found(graph(wrong)) == set(wrong)


def test_at_a_jump_all_pairs_are_wrong_and_none_beside_it_is_lost() -> None:
    across = {pair: 40.0 + 7.0 * row for row, pair in enumerate(PAIRS) if pair[0] <= 14 < pair[1]}
    lost = found(graph(across))
    assert lost <= set(across)
    # What is left has too few triplets left to be asked.
    assert len(across) - len(lost) <= WINDOW


def test_weak_pairs_and_those_of_a_plane_have_no_say() -> None:
    wrong = {(10, 13): 20.0}
    assert found(graph(wrong, inliers=20)) == set()
    assert found(replace(graph(wrong), config=np.full(len(PAIRS), 4, np.uint8))) == set()


def test_a_graph_without_triplets_is_left_alone() -> None:
    empty = graph({})
    none = replace(empty, pairs=empty.pairs[:0], config=empty.config[:0], offsets=empty.offsets[:1])
    assert contradicted(replace(none, rotation_xyzw=empty.rotation_xyzw[:0])).tolist() == []
