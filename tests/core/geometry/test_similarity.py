"""Applying a similarity has the bits of the expression."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry.similarity import Similarity


def test_a_similarity_is_applied() -> None:
    rng = np.random.default_rng(9)
    for seed in range(10):
        known = Similarity(
            float(rng.uniform(0.1, 9.0)), Rotation.random(random_state=seed).as_matrix(), rng.normal(size=3)
        )
        points = rng.normal(size=(20, 3))
        assert np.array_equal(known.apply(points), known.scale * points @ known.rotation.T + known.shift)
