"""Equation 3.3 of the thesis: who joins whom."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from core.scene.detection import DetectionRow
from core.thesis.grouping import cluster_detections, cluster_radius
from tests.core.making_rows import mapped, unplaced


def members(rows: Sequence[DetectionRow], radius: float) -> list[list[int]]:
    return [[row.id for row in cluster.rows] for cluster in cluster_detections(rows, radius)]


def test_radius_is_a_fiftieth_of_the_diagonal() -> None:
    assert cluster_radius(50.0, 0.02) == pytest.approx(1.0)


def test_at_most_the_radius_joins_beyond_it_starts() -> None:
    rows = [mapped(0, (0, 0, 0), 1.0), mapped(1, (1.0, 0, 0), 2.0), mapped(2, (0, 1.2, 0), 3.0)]
    assert members(rows, 1.0) == [[0, 1], [2]]


def test_the_mean_runs_along() -> None:
    # The third is 1.0 from the mean (0.5) of the first two, though 1.5 from the first.
    rows = [mapped(0, (0, 0, 0), 1.0), mapped(1, (1.0, 0, 0), 2.0), mapped(2, (1.5, 0, 0), 3.0)]
    assert members(rows, 1.0) == [[0, 1, 2]]
    assert cluster_detections(rows, 1.0)[0].centroid == pytest.approx((2.5 / 3, 0, 0))


def test_the_nearest_cluster_is_joined_not_the_first() -> None:
    rows = [mapped(0, (0, 0, 0), 1.0), mapped(1, (1.5, 0, 0), 2.0), mapped(2, (0.9, 0, 0), 3.0)]
    assert members(rows, 1.0) == [[0], [1, 2]]


def test_time_order_counts_not_input_order() -> None:
    rows = [mapped(0, (1.5, 0, 0), 3.0), mapped(1, (1.0, 0, 0), 2.0), mapped(2, (0, 0, 0), 1.0)]
    assert members(rows, 1.0) == [[2, 1, 0]]


def test_labels_and_long_pauses_do_not_split() -> None:
    rows = [mapped(0, (0, 0, 0), 1.0, "dent"), mapped(1, (0.1, 0, 0), 900.0, "crack")]
    assert members(rows, 1.0) == [[0, 1]]


def test_clusters_are_numbered_by_start_and_unplaced_rows_left_out() -> None:
    rows = [mapped(0, (9, 0, 0), 5.0), unplaced(1), mapped(2, (0, 0, 0), 2.0), mapped(3, (9, 0, 0), 1.0)]
    assert members(rows, 1.0) == [[3, 0], [2]]


def test_radius_of_a_cluster_is_its_farthest_member() -> None:
    cluster = cluster_detections([mapped(0, (0, 0, 0)), mapped(1, (2, 0, 0), 2.0)], 5.0)[0]
    assert cluster.radius == pytest.approx(1.0)
    assert (cluster.start_s, cluster.end_s) == (1.0, 2.0)
