"""The bench of lenses: its plan ends where the lens is chosen, and its score is the angle at the edge."""

from __future__ import annotations

import pytest

from bench.accuracy.truth import Lens as TrueLens
from bench.scenes.lens import LENS_GRAPH, LENS_HEAD, edge_error_deg, lens_cells
from core.geometry.lens import Lens
from core.products.front import FramesProduct
from core.settings import make_settings
from store.graph import CORE_GRAPH
from tests.core.making_products import facts_of

FRAMES = facts_of(FramesProduct, n_frames=200, n_search=200)
TRUTH = TrueLens(480, 360, 300.0, 0.0)


def test_the_plan_ends_where_the_lens_is_chosen() -> None:
    settings = make_settings()
    assert LENS_GRAPH.expand(settings, {}) == CORE_GRAPH.expand(settings, {})
    tasks = LENS_GRAPH.expand(settings, {"frames": FRAMES})
    assert {task.stage for task in tasks} == {"probe", "annotations", "frames", "features", "motion", "focal", "camera"}
    assert tasks == [task for task in CORE_GRAPH.expand(settings, {"frames": FRAMES}) if task in tasks]


@pytest.mark.parametrize(("focal_px", "off"), [(300.0, 0.0), (330.0, -4.167), (270.0, 5.093)])
def test_the_error_is_the_angle_at_the_edge(focal_px: float, off: float) -> None:
    """240 px from the middle: 240 / 330 - 240 / 300 is -0.0727 rad, 240 / 270 - 240 / 300 is 0.0889."""
    assert edge_error_deg(TRUTH, Lens(focal_px, focal_px, 240.0, 180.0)) == pytest.approx(off, abs=0.01)


def test_a_lens_that_does_not_reach_the_edge_has_no_error() -> None:
    """A perspective polynomial that turns back before it."""
    folded = Lens(300.0, 300.0, 240.0, 180.0, (-0.6, 0.0, 0.0, 0.0), fisheye=False)
    error = edge_error_deg(TRUTH, folded)
    assert error is None
    found = {"scene": "a", "seed": 1, "model": "OPENCV", "focal_px": 300.0, "true_focal_px": 300.0}
    cells = lens_cells({**found, "edge_deg": error, "agreement": None, "cpu_s": 1.2})
    assert len(cells) == len(LENS_HEAD)
    assert cells[4:] == ["300.0 (+0.0%)", "-", "-", "1"]
