from __future__ import annotations

from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core.products.adjustment import LensDecision, RadialTerms
from core.settings.groups import MapperSettings
from core.sparse.adjust import adjust, adjustment_options
from core.sparse.cases import Case
from core.sparse.lens_trial import (
    MIN_FIRST_SIGMAS,
    MIN_IMAGES,
    MIN_SHIFT_SIGMAS,
    Trial,
    judge_principal_point,
    judge_radial_terms,
    try_lens,
)
from core.sparse.mapper import mapper_options, open_cache
from core.sparse.trimming import set_lens
from tests.core.sparse.scene import FOCAL, HEIGHT, WIDTH, make_scene, model_of, view_graph, write_graph

pytestmark = pytest.mark.slow

SETTINGS = MapperSettings(search_tracks=0)
NOISE_PX = 0.3


@pytest.fixture(scope="module")
def graph(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scene = make_scene(24, noise_px=NOISE_PX)
    return write_graph(tmp_path_factory.mktemp("trial") / "graph", scene, view_graph(scene))


@pytest.fixture(scope="module")
def mapped(graph: Path) -> pycolmap.Reconstruction:
    """24 images of an equidistant lens; its camera has two radial terms, both 0."""
    model = model_of(Case(graph, 0, 24, SETTINGS, 0))
    set_lens(model, "RADIAL_FISHEYE")
    model.camera(1).params = list(np.array([FOCAL, WIDTH / 2, HEIGHT / 2, 0.0, 0.0]))
    return model


def seen_through(model: pycolmap.Reconstruction, k1: float) -> pycolmap.Reconstruction:
    """The model with the keypoints that a lens with k1 would give, in a camera that knows nothing of it."""
    found = pycolmap.Reconstruction(model)
    rng = np.random.default_rng(0)
    found.camera(1).params = list(np.array([FOCAL, WIDTH / 2, HEIGHT / 2, k1, 0.0]))
    for image_id in found.reg_image_ids():
        image = found.image(image_id)
        for point in image.points2D:
            if point.has_point3D():
                seen = image.project_point(found.point3D(point.point3D_id).xyz)
                assert seen is not None
                point.xy = seen + rng.normal(0, NOISE_PX, 2)
    found.camera(1).params = list(model.camera(1).params)
    return found


def trial_of(model: pycolmap.Reconstruction, **more: bool) -> Trial:
    return try_lens(model, adjustment_options(more.get("principal_point", True), 0.0, 1))


def test_an_equidistant_lens_is_not_given_radial_terms(mapped: pycolmap.Reconstruction) -> None:
    found = judge_radial_terms(trial_of(seen_through(mapped, 0.0)))
    assert (found.number, found.decision) == (0, LensDecision.INSIGNIFICANT)
    assert found.first is not None
    assert found.second is not None
    assert 0.0 < found.first < MIN_FIRST_SIGMAS
    assert 0.0 < found.second < MIN_SHIFT_SIGMAS


@pytest.mark.parametrize("k1", [0.08, -0.06])
def test_a_lens_with_radial_terms_keeps_them(mapped: pycolmap.Reconstruction, k1: float) -> None:
    trial = trial_of(seen_through(mapped, k1))
    found = judge_radial_terms(trial)
    assert (found.number > 0, found.decision) == (True, LensDecision.SIGNIFICANT)
    assert found.first is not None
    assert trial.camera is not None
    assert found.first > MIN_SHIFT_SIGMAS > MIN_FIRST_SIGMAS
    assert trial.camera.params[3] == pytest.approx(k1, abs=0.02)


@pytest.mark.parametrize(
    ("k1", "k2", "number"),
    [
        (0.02, 0.022, 0),
        (0.05, 0.03, 1),
        (-0.06, 0.0, 1),
        (0.05, 0.05, 2),
        # Alone, the first has a sigma of 0.0052: 2.0 of them are enough for it, 3.0 of 0.012 for the second.
        (0.0101, 0.0, 0),
        (0.0108, 0.0, 1),
        (0.0, 0.0355, 1),
        (0.0, 0.0365, 2),
    ],
)
def test_terms_are_judged_one_by_one(k1: float, k2: float, number: int) -> None:
    """Each has a sigma of 0.012; they are correlated by 0.9: 0.02 beside 0.022 says nothing."""
    camera = pycolmap.Camera(model="RADIAL_FISHEYE", width=320, height=240, params=[200.0, 160.0, 120.0, k1, k2])
    covariance = np.zeros((5, 5))
    covariance[3:, 3:] = 0.012**2 * np.array([[1.0, 0.9], [0.9, 1.0]])
    found = judge_radial_terms(Trial(None, camera, np.array(camera.params), covariance))
    assert found.number == number
    assert found.second == pytest.approx(abs(k2) / 0.012)
    assert found.first == pytest.approx(abs(k1 - 0.9 * k2) / (0.012 * np.sqrt(1 - 0.81)))


def test_a_trial_that_holds_the_principal_point_knows_nothing_of_it(mapped: pycolmap.Reconstruction) -> None:
    trial = trial_of(seen_through(mapped, 0.08), principal_point=False)
    assert judge_radial_terms(trial).number > 0
    assert trial.covariance is not None
    assert trial.camera is not None
    assert not trial.covariance[1:3].any()
    assert trial.covariance[3, 3] > 0
    assert trial.camera.params[1:3].tolist() == [WIDTH / 2, HEIGHT / 2]


def test_a_trial_changes_nothing(mapped: pycolmap.Reconstruction) -> None:
    model = seen_through(mapped, 0.05)
    before = model.camera(1).params.tolist()
    trial = trial_of(model)
    assert trial.start is not None
    assert model.camera(1).params.tolist() == before == trial.start.tolist()


def test_too_few_images_say_nothing(graph: Path) -> None:
    few = model_of(Case(graph, 0, MIN_IMAGES - 1, SETTINGS, 0))
    trial = trial_of(few)
    assert judge_principal_point(trial).decision == LensDecision.FEW_IMAGES
    radial = judge_radial_terms(trial)
    assert radial == RadialTerms(decision=LensDecision.FEW_IMAGES, number=2)


def test_the_adjustment_does_without_terms_that_nothing_asks_for(graph: Path) -> None:
    start = model_of(Case(graph, 0, 24, SETTINGS, 0))
    cache = open_cache(graph / "database.db")
    options = mapper_options(SETTINGS, threads=1, seed=0, tuned=False)
    for judged in (True, False):
        done = adjust(start, cache, options, refine_principal_point=False, trim_tracks=True, judge_radial=judged)
        decision = done.adjustment.radial_terms.decision
        assert decision == (LensDecision.INSIGNIFICANT if judged else LensDecision.OFF)
        assert (done.model.camera(1).params[4:] == 0.0).all() == judged
        assert done.model.camera(1).model.name == "OPENCV_FISHEYE"
        assert done.model.camera(1).mean_focal_length() == pytest.approx(FOCAL, rel=0.005)
    # Without a choice of tracks there is nothing to judge by.
    whole = adjust(start, cache, options, refine_principal_point=False, judge_radial=True)
    assert whole.adjustment.radial_terms.decision == LensDecision.OFF
