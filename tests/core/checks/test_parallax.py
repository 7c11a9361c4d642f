import numpy as np
import pytest

from core.checks.parallax import graph_parallax, largest_angle_deg, model_parallax


def graph(config, angle_deg, inliers=200):
    n = len(config)
    return {
        "config": np.array(config, np.uint8),
        "triangulation_angle_deg": np.array(angle_deg, np.float32),
        "offsets": np.arange(n + 1) * inliers,
    }


def test_a_moving_camera_has_parallax():
    assert graph_parallax(graph([2] * 30 + [4] * 5, [1.2] * 35)) is None


def test_a_planar_clip_with_some_calibrated_pairs_is_left_alone():
    assert graph_parallax(graph([6] * 90 + [2] * 10, [0.0] * 90 + [3.0] * 10)) is None


@pytest.mark.parametrize(
    ("config", "angle"),
    [([5] * 40, [0.0] * 40), ([2] * 40, [0.01] * 40), ([6] * 40, [np.nan] * 40), ([8] * 40, [0.0] * 40)],
)
def test_a_static_or_turning_camera_has_none(config, angle):
    flag = graph_parallax(graph(config, angle))
    assert flag is not None
    assert (flag.code, flag.severity, flag.value) == ("no_parallax", "error", 0.0)
    assert flag.where == "40 pairs of frames"


def test_without_a_strong_pair_nothing_can_be_said():
    assert graph_parallax(graph([1] * 10, [0.0] * 10, inliers=5)) is None
    assert graph_parallax(graph([], [])) is None


def test_a_model_of_tiny_angles_has_no_parallax():
    assert model_parallax(np.full(100, 9.0)) is None
    assert model_parallax(np.zeros(0)) is None
    flag = model_parallax(np.full(100, 1.6))
    assert flag is not None
    assert flag.code == "no_parallax"


def test_the_largest_angle_is_between_the_outermost_views():
    centers = np.array([[-1.0, 0, 0], [0, 0, 0], [1.0, 0, 0]])
    assert largest_angle_deg(np.array([0.0, 0, 1.0]), centers) == pytest.approx(90.0)
