"""Similarities: one that is known is found again, and applying one has the bits of the expression."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from core.geometry.similarity import Similarity, umeyama


def test_a_known_similarity_is_found_and_applied() -> None:
    rng = np.random.default_rng(9)
    for seed in range(10):
        known = Similarity(
            float(rng.uniform(0.1, 9.0)), Rotation.random(random_state=seed).as_matrix(), rng.normal(size=3)
        )
        points = rng.normal(size=(20, 3))
        moved = known.apply(points)
        assert np.array_equal(moved, known.scale * points @ known.rotation.T + known.shift)
        found = umeyama(points, moved)
        assert found is not None
        assert np.allclose(found.apply(points), moved, atol=1e-12)
        assert np.allclose(found.scale, known.scale)


def test_points_on_a_line_or_too_few_fix_none() -> None:
    line = np.linspace(0.0, 1.0, 9)[:, None] * np.array([1.0, 2.0, 3.0])
    assert umeyama(line, line) is None
    assert umeyama(np.eye(3)[:2], np.eye(3)[:2]) is None
