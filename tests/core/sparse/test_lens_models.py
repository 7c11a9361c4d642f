"""Every model that a run can be told maps, is adjusted, and comes out as itself; a lens that is held does not move."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from core.geometry.lens import LensModel, lens_of, make_lens
from core.products.adjustment import LensDecision
from core.settings.groups import MapperSettings
from core.sparse.adjust import adjust
from core.sparse.cases import Case
from core.sparse.mapper import mapper_options, open_cache
from core.verification import CALIBRATED, CameraFields
from core.viewgraph import database_of
from tests.core.sparse.scene import HEIGHT, WIDTH, center_errors, make_scene, model_of, view_graph, write_graph

pytestmark = pytest.mark.slow

FRAMES = 16
TRUE: dict[str, list[float]] = {
    LensModel.OPENCV_FISHEYE: [330.0, 330.0, 322.0, 238.0, 0.03, -0.01, 0.0, 0.0],
    LensModel.OPENCV: [420.0, 420.0, 322.0, 238.0, -0.08, 0.01, 0.0005, -0.0005],
    LensModel.PINHOLE: [420.0, 420.0, 322.0, 238.0],
    LensModel.SIMPLE_RADIAL: [420.0, 322.0, 238.0, -0.05],
}


def fields(model: str, params: list[float]) -> CameraFields:
    return {"model": model, "width": WIDTH, "height": HEIGHT, "params": params}


@pytest.mark.parametrize("model", TRUE)
def test_a_held_lens_stays_as_it_was_told_and_the_cameras_follow(model: str, tmp_path: Path) -> None:
    scene = make_scene(FRAMES, lens=fields(model, TRUE[model]))
    table = view_graph(scene)
    assert (table.config[table.n_inliers > 0] == CALIBRATED).mean() > 0.9
    graph = write_graph(tmp_path / "graph", scene, table)
    settings = MapperSettings(refine_lens=False)
    start = model_of(Case(graph, 0, FRAMES, settings, 0))
    assert list(start.camera(1).params) == TRUE[model]
    options = mapper_options(settings, threads=1, seed=0, tuned=False)
    done = adjust(
        start,
        open_cache(database_of(graph)),
        options,
        refine_principal_point=True,
        trim_tracks=True,
        judge_radial=True,
        hold_lens=True,
    )
    assert (done.model.camera(1).model_name, list(done.model.camera(1).params)) == (model, TRUE[model])
    asked = done.adjustment.principal_point.decision, done.adjustment.radial_terms.decision
    assert asked == (LensDecision.OFF, LensDecision.OFF)
    assert done.model.num_reg_images() == FRAMES
    assert np.median(center_errors(done.model, scene)) < 0.004


@pytest.mark.parametrize("model", [LensModel.OPENCV, LensModel.PINHOLE, LensModel.SIMPLE_RADIAL])
def test_a_perspective_lens_is_found_from_a_wrong_start(model: LensModel, tmp_path: Path) -> None:
    scene = make_scene(FRAMES, lens=fields(model, TRUE[model]))
    lens = make_lens(model, TRUE[model])
    off = replace(lens, fx=1.06 * lens.fx, fy=1.06 * lens.fy).params(model)
    scene = replace(scene, lens=fields(model, off))
    graph = write_graph(tmp_path / "graph", scene, view_graph(scene))
    settings = MapperSettings()
    start = model_of(Case(graph, 0, FRAMES, settings, 0))
    options = mapper_options(settings, threads=1, seed=0, tuned=False)
    done = adjust(
        start,
        open_cache(database_of(graph)),
        options,
        refine_principal_point=False,
        trim_tracks=True,
        judge_radial=True,
    )
    assert done.model.camera(1).model_name == model
    assert lens_of(done.model.camera(1)).focal_px == pytest.approx(420.0, rel=0.02)
