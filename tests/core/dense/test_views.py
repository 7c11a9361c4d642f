"""Selection of views and sources, and the plan of depth maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from core.dense.views import (
    SparseViews,
    angle_weight,
    depth_range,
    plan_views,
    read_views,
    select_sources,
    select_views,
    write_views,
)
from core.geometry.pose import Pose
from core.settings import make_settings


def _row_of_cameras(count: int = 41, step: float = 0.05) -> SparseViews:
    """Cameras side by side looking along +z at points on a wall at depth 5; each sees 4 units of it."""
    rng = np.random.default_rng(0)
    points = np.column_stack([rng.uniform(-3, 5, 600), rng.uniform(-2, 2, 600), np.full(600, 5.0)])
    centers = np.column_stack([np.arange(count) * step, np.zeros(count), np.zeros(count)])
    poses = tuple(Pose(np.eye(3), -center) for center in centers)
    visible = tuple(np.flatnonzero(np.abs(points[:, 0] - center[0]) < 2) for center in centers)
    names = tuple(f"{i:04d}.jpg" for i in range(count))
    return SparseViews(tuple(range(1, count + 1)), names, poses, centers, points, visible)


def test_angles_outside_3_to_65_degrees_are_worth_nothing_and_12_is_best() -> None:
    weight = angle_weight(np.array([2.9, 3.1, 12.0, 30.0, 66.0]))
    assert weight[0] == 0
    assert weight[4] == 0
    assert weight[2] == 1
    assert weight[2] > weight[3] > 0
    assert weight[1] > 0


def test_views_are_spread_over_the_path() -> None:
    chosen = select_views(_row_of_cameras(), 12)
    assert len(chosen) == 12
    assert chosen[0] == 0
    assert chosen[-1] == 40
    assert max(np.diff(chosen)) <= 6


def test_zero_views_means_all_that_see_points() -> None:
    views = _row_of_cameras(9)
    assert select_views(views, 0) == list(range(9))
    assert select_views(views, 50) == list(range(9))


def test_sources_have_useful_angles_and_lie_on_both_sides() -> None:
    views = _row_of_cameras()
    sources = select_sources(views, 20, frozenset(), 4)
    angles = [np.degrees(np.arctan2(abs(views.centers[s, 0] - 1.0), 5.0)) for s in sources]
    assert min(angles) >= 3
    assert {s < 20 for s in sources} == {True, False}


def test_views_with_a_depth_map_are_preferred_as_sources() -> None:
    views = _row_of_cameras()
    plain = select_sources(views, 20, frozenset(), 2)
    preferred = frozenset(i for i in range(41) if i not in plain)
    assert set(select_sources(views, 20, preferred, 2)) <= preferred


def test_depth_range_is_widened_by_a_quarter() -> None:
    low, high = depth_range(_row_of_cameras(), 3)
    assert low == pytest.approx(3.75)
    assert high == pytest.approx(6.25)


def test_plan_survives_its_file(tmp_path: Path) -> None:
    plan = plan_views(_row_of_cameras(), make_settings("default", {"dense.views": 5, "dense.sources": 3}).dense)
    write_views(tmp_path, plan)
    assert read_views(tmp_path) == plan
    assert [view.index for view in plan] == sorted(view.index for view in plan)
    assert all(1 <= len(view.sources) <= 3 and view.name not in view.sources for view in plan)


def test_views_without_a_partner_are_left_out() -> None:
    views = _row_of_cameras(3, step=0.001)
    assert plan_views(views, make_settings().dense) == []
