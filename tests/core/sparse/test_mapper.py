from __future__ import annotations

from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core.checks.stats import model_stats
from core.settings import make_settings
from core.sparse.mapper import best_model, map_images, mapper_options, open_cache, registered_names, restrict_model
from tests.core.sparse.scene import make_scene, view_graph, write_graph

THESIS = make_settings("thesis").mapper


@pytest.fixture(scope="module")
def database(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scene = make_scene(12, 500)
    return write_graph(tmp_path_factory.mktemp("mapper") / "graph", scene, view_graph(scene)) / "database.db"


@pytest.fixture(scope="module")
def model(database: Path) -> pycolmap.Reconstruction:
    options = mapper_options(THESIS, threads=1, seed=0, tuned=True)
    return map_images(open_cache(database), options, pairs=[(4, 9)])[0]


def test_the_thesiss_thresholds_reach_colmap() -> None:
    options = mapper_options(THESIS, threads=2, seed=7, tuned=False)
    assert (options.min_model_size, options.num_threads, options.random_seed) == (3, 2, 7)
    assert options.mapper.init_min_num_inliers == 40
    assert options.mapper.abs_pose_min_num_inliers == 20
    assert options.mapper.abs_pose_min_inlier_ratio == pytest.approx(0.10)
    plain = pycolmap.IncrementalPipelineOptions()
    assert options.ba_global_frames_ratio == plain.ba_global_frames_ratio
    assert options.multiple_models == plain.multiple_models


def test_the_cache_holds_the_named_images_only(database: Path) -> None:
    cache = open_cache(database, ["0003.jpg", "0004.jpg", "0005.jpg"])
    assert sorted(image.name for image in cache.images.values()) == ["0003.jpg", "0004.jpg", "0005.jpg"]


def test_a_bad_initial_pair_is_passed_over(database: Path) -> None:
    cache = open_cache(database, [f"{i:04d}.jpg" for i in range(8)])
    options = mapper_options(THESIS, threads=1, seed=0, tuned=True)
    models = map_images(cache, options, pairs=[(1, 8), (2, 6)])  # images 1 and 8 have no matches
    assert [model.num_reg_images() for model in models] == [8]
    assert options.init_image_id1 == -1


def test_the_best_model_is_chosen_by_score_not_by_place(model: pycolmap.Reconstruction) -> None:
    smaller = restrict_model(model, ["0000.jpg", "0001.jpg", "0002.jpg"])
    fewer_points = pycolmap.Reconstruction(model)
    fewer_points.delete_point3D(next(iter(fewer_points.point3D_ids())))
    assert best_model([smaller, fewer_points, model]) is model
    assert best_model([]) is None


def test_restricting_leaves_the_source_alone(model: pycolmap.Reconstruction) -> None:
    names = ["0002.jpg", "0003.jpg", "0004.jpg"]
    part = restrict_model(model, names)
    assert registered_names(part) == names
    assert registered_names(model) == [f"{i:04d}.jpg" for i in range(12)]
    assert all(point.track.length() <= 3 for point in part.points3D.values())


def test_points_at_infinity_do_not_count(model: pycolmap.Reconstruction) -> None:
    before = model_stats(model)
    broken = pycolmap.Reconstruction(model)
    lost = sorted(broken.point3D_ids())[:2]
    broken.point3D(lost[0]).xyz = np.array([0.0, 0.0, -1e200])
    broken.point3D(lost[1]).xyz = np.array([np.nan, 0.0, 1.0])
    after = model_stats(broken)
    assert after.points3D == before.points3D - 2
    assert after.mean_reprojection_error_px == pytest.approx(before.mean_reprojection_error_px, rel=0.1)
    assert model_stats(pycolmap.Reconstruction()).score == (0, 0)


def test_mapping_goes_on_with_held_poses(database: Path, model: pycolmap.Reconstruction) -> None:
    start = restrict_model(model, [f"{i:04d}.jpg" for i in range(3, 9)])
    options = mapper_options(THESIS, threads=1, seed=0, tuned=True)
    options.fix_existing_frames = True
    grown = map_images(open_cache(database), options, start_model=start)[0]
    assert grown.num_reg_images() == 12
    for image_id in start.reg_image_ids():
        before, after = (m.image(image_id).cam_from_world().matrix() for m in (start, grown))
        np.testing.assert_allclose(after, before, atol=1e-4)  # the gauge may slip by what a scale is rounded to
