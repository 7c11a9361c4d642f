"""Rays and projections of all views at once, through the fisheye."""

from __future__ import annotations

import numpy as np
import pytest

from core.mapping.consensus import could_see, looked_at, widened
from core.mapping.surface import Surface
from tests.core import making_plates as plates


def test_a_pixel_goes_out_and_comes_back() -> None:
    views = plates.views([0, 4])
    rng = np.random.default_rng(0)
    xy = rng.uniform((5, 5), (plates.WIDTH - 5, plates.HEIGHT - 5), (50, 2))
    for row in (0, 1):
        points = views.centers[row] + views.rays(xy, views.R[row]) * rng.uniform(2, 9, (50, 1))
        back, inside = views.project(points)
        assert back[:, row] == pytest.approx(xy, abs=1e-6)
        assert inside[:, row].all()


def test_behind_and_beyond_is_not_on_the_frame() -> None:
    views = plates.views([0])
    _, inside = views.project(np.array([[0, 0, -4.0], [50.0, 0, 4.0], [0, 0, 4.0]]))
    assert inside[:, 0].tolist() == [False, False, True]
    assert views.row(0) == 0
    assert views.row(3) is None


def test_who_could_see_a_place() -> None:
    views = plates.views(range(12))
    mesh = plates.plates()
    surface = Surface(mesh.vertices, mesh.faces)
    behind = np.array([[-0.5, 0.0, plates.FAR]])
    towards = np.array([[0.0, 0.0, -1.0]])
    seen, _ = could_see(behind, towards, views, np.arange(12), surface, 0.05)
    # The near plate ends at x = 0: the line of sight from x = c crosses z = 4 at (c - 1) / 3.
    assert seen[0].tolist() == [False] * 10 + [(0.1 * c - 1) / 3 > 0 for c in (10, 11)]
    flat, _ = could_see(behind, np.array([[1.0, 0.0, 0.0]]), views, np.arange(12), surface, 0.05)
    assert not flat.any(), "seen too flat"


def test_frames_that_the_detector_saw() -> None:
    views = plates.views([0, 1, 3])
    said = looked_at(views, {0: [((1.0, 1.0, 5.0, 9.0), "dent")], 2: [], 3: []})
    assert said.rows.tolist() == [0, 2]
    assert [len(boxes) for boxes in said.boxes] == [1, 0]
    grown = widened(np.array([[10.0, 10.0, 20.0, 30.0]]))[0]
    assert grown == pytest.approx([10 - 3.5, 10 - 5, 20 + 3.5, 30 + 5])
