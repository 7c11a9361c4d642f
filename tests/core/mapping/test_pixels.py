"""Pixels of a detection: inside its outline, on the frame, evenly spread."""

from __future__ import annotations

import numpy as np
import pytest

from core.mapping.pixels import CELLS, MIN_CELLS, SHRINK, footprint, in_polygon


def test_a_box_is_sampled_by_the_ellipse_in_it() -> None:
    found = footprint((10.0, 20.0, 50.0, 40.0), 100, 100)
    scaled = (found.xy - (30, 30)) / (20 * SHRINK, 10 * SHRINK)
    assert ((scaled**2).sum(axis=1) <= 1).all()
    assert found.xy.mean(axis=0) == pytest.approx((30, 30))
    assert found.offered == len(found.xy) > 60
    assert found.outline == "box"
    assert np.ptp(found.xy[:, 0]) > 1.8 * np.ptp(found.xy[:, 1]) * 0.9


def test_small_boxes_are_sampled_below_the_pixel_and_beyond_the_frame_counts() -> None:
    assert len(np.unique(footprint((5.0, 5.0, 7.0, 7.0), 100, 100).cell[:, 0])) >= MIN_CELLS - 2
    half = footprint((-10.0, 0.0, 10.0, 20.0), 100, 100)
    assert (half.xy[:, 0] > 0).all()
    assert len(half.xy) == pytest.approx(half.offered / 2, rel=0.15)
    assert len(footprint((-30.0, 0.0, -10.0, 20.0), 100, 100).xy) == 0


def test_a_mask_is_sampled_inside_only() -> None:
    triangle = [(10.0, 10.0), (40.0, 10.0), (10.0, 40.0)]
    found = footprint((0.0, 0.0, 50.0, 50.0), 100, 100, triangle)
    assert found.outline == "mask"
    assert (found.xy.sum(axis=1) < 50 + 1e-9).all()
    assert (found.xy > 10).all()
    sliver = [(10.0, 10.0), (60.0, 10.001), (60.0, 10.002)]
    along = footprint((0.0, 0.0, 50.0, 50.0), 100, 100, sliver)
    assert len(along.xy) >= MIN_CELLS
    assert np.ptp(along.xy[:, 0]) > 40
    assert np.abs(along.xy[:, 1] - 10.001).max() < 0.01
    assert len(np.unique(along.cell, axis=0)) == len(along.cell)


def test_a_mask_thinner_than_the_grid_is_sampled_along_its_outline() -> None:
    found = footprint((0.0, 0.0, 100.0, 100.0), 100, 100, [(10.0, 10.0), (60.0, 30.0), (60.0, 30.01)])
    assert len(np.unique(found.cell, axis=0)) == len(found.cell)
    assert (set(found.cell[:, 0]), set(found.cell[:, 1])) == (set(range(CELLS)), set(range(MIN_CELLS)))
    along = (found.xy - (10, 10)) / (50, 20)
    assert ((along > 0) & (along <= 1)).all()
    assert along[:, 0] == pytest.approx(along[:, 1], abs=0.001), "every sample lies on the outline"
    assert (np.floor(along * (CELLS, MIN_CELLS) - 1e-9) == found.cell).all(), "and in its cell"


def test_even_odd_rule() -> None:
    notch = np.array([(0, 0), (4, 0), (4, 4), (2, 1), (0, 4)], np.float64)
    points = np.array([(2, 0.5), (2, 2.0), (0.5, 2), (5, 1), (3.9, 0.1)])
    assert in_polygon(points, notch).tolist() == [True, False, True, False, True]
