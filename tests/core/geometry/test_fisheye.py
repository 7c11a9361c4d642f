"""The fisheye polynomial: both forms agree, the slope is the derivative, the compiled bits are those of the loop."""

from __future__ import annotations

from typing import Any

import numpy as np

from core.geometry.fisheye import fisheye_radius, fisheye_radius_and_slope, viewing_angle
from core.jit import compiled

IN_LOOP = compiled(fisheye_radius_and_slope)


def written_out(theta: Any, lens: Any) -> tuple[float, float]:
    t2 = theta * theta
    bent = theta * (1.0 + t2 * (lens[4] + t2 * (lens[5] + t2 * (lens[6] + t2 * lens[7]))))
    slope = 1.0 + t2 * (3.0 * lens[4] + t2 * (5.0 * lens[5] + t2 * (7.0 * lens[6] + t2 * 9.0 * lens[7])))
    return bent, slope


def of_lens(theta: Any, lens: Any) -> tuple[float, float]:
    return IN_LOOP(theta, lens[4], lens[5], lens[6], lens[7])


def random_lenses(count: int) -> np.ndarray:
    rng = np.random.default_rng(5)
    return np.hstack([np.ones((count, 4)), rng.normal(scale=0.05, size=(count, 4))])


def test_compiled_bits_are_those_of_the_polynomial_in_the_loop() -> None:
    before, after = compiled(written_out), compiled(of_lens)
    for theta, lens in zip(np.linspace(0.0, 1.6, 500), random_lenses(500), strict=True):
        assert before(theta, lens) == after(theta, lens) == written_out(theta, lens)


def test_both_forms_and_the_inverse_agree() -> None:
    theta = np.linspace(0.01, 1.2, 50)
    for lens in random_lenses(20):
        radius = fisheye_radius(theta, lens[4:])
        pairs = np.array([fisheye_radius_and_slope(float(angle), *lens[4:]) for angle in theta])
        assert np.allclose(radius, pairs[:, 0], rtol=1e-14)
        step = 1e-6
        ahead, behind = fisheye_radius(theta + step, lens[4:]), fisheye_radius(theta - step, lens[4:])
        assert np.allclose((ahead - behind) / (2 * step), pairs[:, 1], atol=1e-8)
    mild = np.array([0.02, -0.003, 0.0, 0.0])
    angle = viewing_angle(float(fisheye_radius(np.array([0.7]), mild)[0]), mild)
    assert angle is not None
    assert abs(angle - 0.7) < 1e-6
