"""Boxes: closed forms, and the same bits as the forms that the callers had before they shared one."""

from __future__ import annotations

import numpy as np
import pytest

from core.geometry.boxes import box_iou, in_box


def random_boxes(count: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    low = rng.uniform(0.0, 1.0, (count, 2))
    return np.hstack([low, low + rng.uniform(0.0, 0.5, (count, 2))])


@pytest.mark.parametrize(
    ("other", "expected"),
    [((0.0, 0.0, 2.0, 2.0), 1.0), ((1.0, 0.0, 3.0, 2.0), 1 / 3), ((2.0, 0.0, 3.0, 2.0), 0.0), ((5, 5, 6, 6), 0.0)],
)
def test_iou_in_closed_form(other: tuple[float, float, float, float], expected: float) -> None:
    assert box_iou((0.0, 0.0, 2.0, 2.0), other) == expected


def test_iou_has_the_bits_of_sums_of_areas_and_of_arrays() -> None:
    boxes = random_boxes(400, seed=1)
    different = 0
    for a, b in zip(boxes[::2], boxes[1::2], strict=True):
        width, height = np.minimum(a[2:], b[2:]) - np.maximum(a[:2], b[:2])
        areas = [(one[2] - one[0]) * (one[3] - one[1]) for one in (a, b)]
        by_sum = 0.0 if width <= 0 or height <= 0 else float(width * height / (sum(areas) - width * height))
        assert box_iou(a, b) == box_iou(a.tolist(), b.tolist()) == by_sum
        different += by_sum > 0
    assert different > 20


def test_the_border_belongs_to_a_box_unless_told_otherwise() -> None:
    xy = np.array([[0.0, 0.0], [2.0, 1.0], [1.0, 0.5], [2.0, 1.5], [np.nan, 0.5], [np.inf, 0.5]])
    assert in_box(xy, (0, 0, 2, 1)).tolist() == [True, True, True, False, False, False]
    assert in_box(xy, (0, 0, 2, 1), border=False).tolist() == [False, False, True, False, False, False]


def test_many_points_are_held_against_many_boxes() -> None:
    boxes = random_boxes(7, seed=2)
    xy = np.random.default_rng(3).uniform(0.0, 1.0, (50, 1, 2))
    each = np.array([[in_box(point[0], box) for box in boxes] for point in xy])
    assert np.array_equal(in_box(xy, boxes), each)
    assert 0 < each.sum() < each.size


def test_boxes_have_any_number_of_dimensions() -> None:
    points = np.random.default_rng(4).uniform(0.0, 1.0, (50, 3))
    low, high = np.array([0.1, 0.2, 0.3]), np.array([0.9, 0.8, 0.7])
    assert np.array_equal(in_box(points, (*low, *high)), ((points >= low) & (points <= high)).all(axis=1))
