"""Mutual nearest neighbours of unit descriptors, with an optional distance ratio (Lowe, IJCV 2004)."""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from core.features.io import Descriptors

Matches = NDArray[np.uint32]

_BLOCK = 512


def unit_descriptors(descriptors: Descriptors) -> torch.Tensor:
    """Descriptors of any stored type as float32 rows of unit length."""
    return torch.nn.functional.normalize(torch.from_numpy(descriptors.astype(np.float32)), dim=-1)


def mutual_nearest(first: torch.Tensor, second: torch.Tensor, ratio: float = 1.0) -> Matches:
    """Pairs of rows that are each other's nearest.

    Args:
        first, second: (n, d) and (m, d) unit rows (`unit_descriptors`).
        ratio: keep a pair only if its distance is below `ratio` times that of the second nearest row of
            `second`; 1 switches the test off.

    Returns:
        (k, 2) row indices, ordered by the first; of equally near rows the lower index counts.
    """
    if len(first) == 0 or len(second) == 0:
        return np.empty((0, 2), np.uint32)
    nearest = torch.empty(len(first), dtype=torch.int64)
    passed = torch.ones(len(first), dtype=torch.bool)
    column_best = torch.full((len(second),), -torch.inf)
    column_row = torch.zeros(len(second), dtype=torch.int64)
    with torch.inference_mode():
        for start in range(0, len(first), _BLOCK):
            similarity = first[start : start + _BLOCK] @ second.T
            rows = slice(start, start + len(similarity))
            best, nearest[rows] = similarity.max(dim=1)
            block_best, block_row = similarity.max(dim=0)
            better = block_best > column_best
            column_best[better] = block_best[better]
            column_row[better] = block_row[better] + start
            if ratio < 1 and len(second) > 1:
                runner_up = similarity.scatter_(1, nearest[rows, None], -torch.inf).amax(dim=1)
                passed[rows] = _distance(best) < ratio * _distance(runner_up)
        mutual = column_row[nearest] == torch.arange(len(first))
        kept = torch.nonzero(mutual & passed)[:, 0]
    return torch.stack([kept, nearest[kept]], dim=1).numpy().astype(np.uint32)


def _distance(similarity: torch.Tensor) -> torch.Tensor:
    return (2 - 2 * similarity).clamp_min(0).sqrt()
