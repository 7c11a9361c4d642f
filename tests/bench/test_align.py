"""The alignment of a model with the truth: a known similarity is found again, and an undetermined one is none."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from bench.accuracy.align import align
from core.geometry.similarity import Similarity


def test_a_known_similarity_is_found() -> None:
    rng = np.random.default_rng(9)
    for seed in range(10):
        known = Similarity(
            float(rng.uniform(0.1, 9.0)), Rotation.random(random_state=seed).as_matrix(), rng.normal(size=3)
        )
        points = rng.normal(size=(20, 3))
        found = align(points, known.apply(points))
        assert found is not None
        assert np.allclose(found.apply(points), known.apply(points), atol=1e-12)
        assert np.allclose([found.scale, *found.shift], [known.scale, *known.shift])
        assert np.allclose(found.rotation, known.rotation, atol=1e-12)


def test_no_other_similarity_is_nearer() -> None:
    rng = np.random.default_rng(4)
    points = rng.normal(size=(30, 3))
    target = 2.0 * points @ Rotation.random(random_state=4).as_matrix().T + rng.normal(scale=0.05, size=(30, 3))
    best = align(points, target)
    assert best is not None

    def error(one: Similarity) -> float:
        return float(((one.apply(points) - target) ** 2).sum())

    for scale, turn, shift in ((1.001, 0.0, 0.0), (1.0, 0.002, 0.0), (1.0, 0.0, 0.002)):
        turned = Rotation.from_rotvec([turn, 0.0, 0.0]).as_matrix() @ best.rotation
        assert error(Similarity(best.scale * scale, turned, best.shift + shift)) > error(best)


def test_centres_on_a_line_in_one_place_or_too_few_fix_none() -> None:
    line = np.linspace(0.0, 1.0, 9)[:, None] * np.array([1.0, 2.0, 3.0])
    assert align(line, line) is None
    assert align(np.ones((5, 3)), np.ones((5, 3))) is None
    assert align(np.eye(3)[:2], np.eye(3)[:2]) is None
