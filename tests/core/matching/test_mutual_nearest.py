from __future__ import annotations

import numpy as np
import pytest
import torch

from core.matching.mutual_nearest import mutual_nearest, unit_descriptors


def _brute(first: np.ndarray, second: np.ndarray, ratio: float) -> list[tuple[int, int]]:
    distance = np.linalg.norm(first[:, None] - second[None], axis=2)
    found = []
    for i, row in enumerate(distance):
        j = int(row.argmin())
        runner_up = np.partition(row, 1)[1]
        if distance[:, j].argmin() == i and (ratio == 1 or row[j] < ratio * runner_up):
            found.append((i, j))
    return found


@pytest.mark.parametrize("ratio", [1.0, 0.9])
@pytest.mark.parametrize("sizes", [(700, 530), (3, 900), (1200, 2)])
def test_agrees_with_the_definition(ratio: float, sizes: tuple[int, int]) -> None:
    rng = np.random.default_rng(5)
    first, second = (unit_descriptors(rng.normal(size=(n, 16)).astype(np.float32)) for n in sizes)
    found = mutual_nearest(first, second, ratio)
    assert found.dtype == np.uint32
    assert [tuple(row) for row in found.tolist()] == _brute(first.numpy(), second.numpy(), ratio)


def test_finds_a_permutation() -> None:
    torch.set_num_threads(1)
    rng = np.random.default_rng(1)
    first = unit_descriptors(rng.normal(size=(600, 128)).astype(np.float16))
    order = rng.permutation(600)
    found = mutual_nearest(first, first[order], 0.8)
    np.testing.assert_array_equal(order[found[:, 1]], found[:, 0])
    assert len(found) == 600


@pytest.mark.parametrize("sizes", [(0, 5), (5, 0), (0, 0)])
def test_nothing_matches_nothing(sizes: tuple[int, int]) -> None:
    first, second = (torch.zeros(n, 8) for n in sizes)
    assert mutual_nearest(first, second).shape == (0, 2)


def test_bytes_become_unit_rows() -> None:
    rows = unit_descriptors(np.array([[3, 4], [0, 200]], np.uint8))
    np.testing.assert_allclose(rows.numpy(), [[0.6, 0.8], [0.0, 1.0]], atol=1e-6)
