"""Equations 3.1 and 3.2 of the thesis, against closed form and against the rule written out point by point."""

from __future__ import annotations

import numpy as np
import pytest

from core.mapping.coloring import blend, coloring_radius, vertex_weights


def test_radius_is_a_hundredth_of_the_diagonal() -> None:
    assert coloring_radius(25.0, 0.01) == pytest.approx(0.25)


@pytest.mark.parametrize(("distance_in_sigma", "weight"), [(0.0, 1.0), (1.0, 0.6065306597), (2.0, 0.1353352832)])
def test_weight_is_a_gaussian_of_the_distance(distance_in_sigma: float, weight: float) -> None:
    radius, sigma = 1.0, 0.35
    vertices = np.array([[distance_in_sigma * sigma, 0.0, 0.0], [50.0, 0.0, 0.0]])
    coloring = vertex_weights(vertices, np.zeros((1, 3)), radius, sigma)
    assert coloring.weight[0] == pytest.approx(weight, abs=1e-6)
    assert (coloring.weight[1], coloring.point[1]) == (0.0, -1)


def test_several_points_give_the_maximum_not_the_sum() -> None:
    vertices = np.zeros((1, 3))
    points = np.array([[0.35, 0, 0], [-0.35, 0, 0], [0, 0.7, 0]])
    coloring = vertex_weights(vertices, points, 1.0, 0.35)
    assert coloring.weight[0] == pytest.approx(np.exp(-0.5), abs=1e-6)


def test_a_vertex_on_the_ball_belongs_to_it_and_one_beyond_does_not() -> None:
    vertices = np.array([[0.25, 0, 0], [0.2500001, 0, 0], [0.0, 0.1, 0]])
    coloring = vertex_weights(vertices, np.zeros((1, 3)), 0.25, 0.0875)
    assert coloring.point.tolist() == [0, -1, 0]


def test_an_empty_ball_colours_the_nearest_vertex_faintly() -> None:
    radius = 1.0
    vertices = np.array([[1.05, 0, 0], [1.4, 0, 0]])
    coloring = vertex_weights(vertices, np.zeros((1, 3)), radius, 0.35 * radius)
    assert coloring.point.tolist() == [0, -1]
    assert 0 < coloring.weight[0] < 0.017


def test_agrees_with_the_rule_written_out() -> None:
    rng = np.random.default_rng(3)
    vertices, points = rng.uniform(-1, 1, (800, 3)), rng.uniform(-1.4, 1.4, (60, 3))
    radius, sigma = 0.16, 0.056
    distance = np.linalg.norm(vertices[:, None] - points[None], axis=2)
    weights = np.exp(-0.5 * (distance / sigma) ** 2)
    expected = np.zeros(len(vertices))
    for j in range(len(points)):
        ball = np.flatnonzero(distance[:, j] <= radius)
        for i in ball if len(ball) else [distance[:, j].argmin()]:
            expected[i] = max(expected[i], weights[i, j])
    assert (distance.min(axis=0) > radius).any(), "the scene must have points with an empty ball"
    assert vertex_weights(vertices, points, radius, sigma).weight == pytest.approx(expected, abs=1e-6)


def test_nothing_to_colour() -> None:
    coloring = vertex_weights(np.zeros((4, 3)), np.zeros((0, 3)), 1.0, 0.35)
    assert not coloring.weight.any()
    assert (coloring.point == -1).all()


def test_blends_the_base_towards_red() -> None:
    base = np.array([[100, 200, 40]] * 3, np.uint8)
    colors = blend(base, np.array([0.0, 0.5, 1.0], np.float32))
    assert colors.tolist() == [[100, 200, 40], [178, 100, 20], [255, 0, 0]]


def test_a_mesh_without_colours_starts_grey() -> None:
    assert blend(None, np.array([0.0, 1.0], np.float32)).tolist() == [[180, 180, 180], [255, 0, 0]]
