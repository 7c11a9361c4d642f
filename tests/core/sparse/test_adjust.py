from __future__ import annotations

from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core.checks.stats import model_stats
from core.products.adjustment import LensDecision
from core.settings.groups import MapperSettings
from core.sparse.adjust import adjust, adjustment_options
from core.sparse.cases import Case
from core.sparse.lens_trial import MIN_IMAGES, judge_principal_point, try_lens
from core.sparse.mapper import mapper_options, open_cache
from tests.core.sparse.scene import HEIGHT, WIDTH, Scene, center_errors, make_scene, model_of, view_graph, write_graph

pytestmark = pytest.mark.slow

SETTINGS = MapperSettings(search_tracks=150)
OPTIONS = mapper_options(SETTINGS, threads=1, seed=0, tuned=False)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return make_scene(36)


@pytest.fixture(scope="module")
def graph(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_graph(tmp_path_factory.mktemp("adjust") / "graph", scene, view_graph(scene))


@pytest.fixture(scope="module")
def model(graph: Path) -> pycolmap.Reconstruction:
    return model_of(Case(graph, 0, 36, SETTINGS, 0))


@pytest.fixture(scope="module")
def cache(graph: Path) -> pycolmap.DatabaseCache:
    return open_cache(graph / "database.db")


def disturbed(
    model: pycolmap.Reconstruction, *, shift_px: tuple[float, float] = (0.0, 0.0), points_su: float = 0.0
) -> pycolmap.Reconstruction:
    """A copy with another principal point and moved points."""
    other = pycolmap.Reconstruction(model)
    camera = other.camera(1)
    params = np.array(camera.params)
    params[2:4] += shift_px
    camera.params = list(params)
    rng = np.random.default_rng(0)
    for point in other.points3D.values():
        point.xyz = point.xyz + points_su * rng.standard_normal(3)
    return other


def test_a_disturbed_model_comes_back_and_the_input_stays(
    model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache, scene: Scene
) -> None:
    start = disturbed(model, points_su=0.03)
    before = model_stats(start).mean_reprojection_error_px
    result = adjust(start, cache, OPTIONS, refine_principal_point=False)
    assert result.adjustment.error_before_px == pytest.approx(before)
    assert result.adjustment.error_after_px < 0.5 * before
    assert result.adjustment.stable
    assert center_errors(result.model, scene).max() < 0.01
    assert model_stats(start).mean_reprojection_error_px == pytest.approx(before)
    assert result.adjustment.principal_point.decision == LensDecision.OFF
    assert np.array(result.model.camera(1).params)[2:4].tolist() == [WIDTH / 2, HEIGHT / 2]


def test_a_repeated_adjustment_gives_the_same_model(
    model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache, tmp_path: Path
) -> None:
    for name in ("one", "two"):
        (tmp_path / name).mkdir()
        adjust(model, cache, OPTIONS, refine_principal_point=True).model.write_binary(tmp_path / name)
    for file in ("images.bin", "points3D.bin", "cameras.bin"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_a_point_at_infinity_is_removed_before_errors_are_averaged(
    model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache
) -> None:
    start = pycolmap.Reconstruction(model)
    lost = min(start.point3D_ids())
    start.point3D(lost).xyz = np.array([1e150, 1e150, 1e150])
    assert adjust(start, cache, OPTIONS, refine_principal_point=False).adjustment.error_after_px < 1.0


def test_a_wrong_principal_point_is_found_again(
    model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache, scene: Scene
) -> None:
    start = adjust(disturbed(model, shift_px=(14.0, -9.0)), cache, OPTIONS, refine_principal_point=False).model
    result = adjust(start, cache, OPTIONS, refine_principal_point=True)
    assert result.adjustment.principal_point.decision == LensDecision.KEPT
    found = np.array(result.model.camera(1).params)[2:4]
    assert found == pytest.approx([WIDTH / 2, HEIGHT / 2], abs=3.0)
    assert result.adjustment.principal_point.sigma_px is not None
    assert max(result.adjustment.principal_point.sigma_px) < 3.0
    assert result.adjustment.error_after_px <= result.adjustment.error_before_px


def test_a_right_principal_point_stays_exactly(model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache) -> None:
    result = adjust(model, cache, OPTIONS, refine_principal_point=True)
    assert result.adjustment.principal_point.decision == LensDecision.INSIGNIFICANT
    assert np.array(result.model.camera(1).params)[2:4].tolist() == [WIDTH / 2, HEIGHT / 2]


def test_few_images_do_not_determine_a_principal_point(graph: Path) -> None:
    few = model_of(Case(graph, 0, MIN_IMAGES - 1, SETTINGS, 0))
    assert judge_principal_point(try_lens(few, adjustment_options(True, 1.0, 1))).decision == LensDecision.FEW_IMAGES


def test_mismatches_move_cameras_less_when_they_count_less(
    model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache, scene: Scene
) -> None:
    start = pycolmap.Reconstruction(model)
    rng = np.random.default_rng(1)
    for image_id in start.reg_image_ids():
        points = start.image(image_id).points2D
        for index in rng.choice(len(points), len(points) // 8, replace=False):
            points[index].xy = points[index].xy + np.array([2.5, 1.0])
    robust, squares = (
        adjust(start, cache, OPTIONS, refine_principal_point=False, loss_scale_px=scale).model for scale in (0.5, 0.0)
    )
    assert np.median(center_errors(robust, scene)) < np.median(center_errors(squares, scene))


def test_a_narrow_motion_does_not_determine_a_principal_point(graph: Path) -> None:
    narrow = model_of(Case(graph, 0, 14, SETTINGS, 0))
    found = judge_principal_point(try_lens(narrow, adjustment_options(True, 0.0, 1)))
    assert (found.refined, found.decision) == (False, LensDecision.UNCERTAIN)
