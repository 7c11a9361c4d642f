from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core.products.adjustment import LensDecision
from core.settings.groups import MapperSettings
from core.sparse.adjust import Adjusted, adjust
from core.sparse.cases import Case
from core.sparse.mapper import mapper_options, open_cache
from core.sparse.trimming import MIN_LENGTH, MIN_PER_IMAGE, keep_agreeing, set_lens
from tests.core.sparse.scene import (
    FOCAL,
    HEIGHT,
    WIDTH,
    Scene,
    center_errors,
    make_scene,
    model_of,
    view_graph,
    write_graph,
)

pytestmark = pytest.mark.slow

Tried = tuple[float, Scene, pycolmap.Reconstruction, pycolmap.DatabaseCache, dict[bool, Adjusted]]

SETTINGS = MapperSettings(search_tracks=0)
OPTIONS = mapper_options(SETTINGS, threads=1, seed=0, tuned=False)
HIGHLIGHTS, NONE = 0.04, 0.0
N = 24


@pytest.fixture(scope="module", params=[HIGHLIGHTS, NONE], ids=["highlights", "metal"])
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Tried:
    """The scene, its model before and the adjustments without and with the choice of tracks."""
    scene = make_scene(N, drift=request.param)
    graph = write_graph(tmp_path_factory.mktemp("trimming") / "graph", scene, view_graph(scene))
    model = model_of(Case(graph, 0, N, SETTINGS, 0))
    cache = open_cache(graph / "database.db")
    done = {on: adjust(model, cache, OPTIONS, refine_principal_point=False, trim_tracks=on) for on in (False, True)}
    return request.param, scene, model, cache, done


def focal(model: pycolmap.Reconstruction) -> float:
    return model.camera(1).mean_focal_length()


def test_highlights_bend_all_tracks_but_not_those_that_agree(case: Tried) -> None:
    drift, scene, _, _, done = case
    whole, part = done[False], done[True]
    assert whole.adjustment.trimming is None
    bent, straight = (float(np.median(center_errors(found.model, scene))) for found in (whole, part))
    if drift:
        assert abs(whole.model.camera(1).params[4]) > 0.01
        assert straight < 0.7 * bent
    assert straight < 0.0015  # without highlights this is what fewer tracks cost: all of them reach 0.0005
    assert abs(part.model.camera(1).params[4]) < 0.003
    assert focal(part.model) == pytest.approx(FOCAL, rel=0.005)
    assert part.adjustment.trimming is not None
    assert focal(part.model) == pytest.approx(part.adjustment.trimming.focal_after_px)
    assert part.model.num_reg_images() == whole.model.num_reg_images()
    assert part.model.num_points3D() > 0.9 * whole.model.num_points3D()


def test_the_kept_tracks_are_those_of_what_does_not_move(case: Tried) -> None:
    drift, scene, _, _, done = case
    model = pycolmap.Reconstruction(done[True].model)
    before = {point_id: still(model.point3D(point_id), scene) for point_id in model.point3D_ids()}
    keep_agreeing(model)
    assert 0 < model.num_points3D() < len(before)
    after = [before[point_id] for point_id in model.point3D_ids()]
    if drift:
        assert np.mean(after) > 0.9 > 2 * np.mean(list(before.values()))
    trimming = done[True].adjustment.trimming
    assert trimming is not None
    assert 0.1 < trimming.median_error_px < 0.6  # the keypoints' noise is 0.3 px on each axis
    counts = Counter(e.image_id for point in model.points3D.values() for e in point.track.elements)
    assert min(counts[image_id] for image_id in model.reg_image_ids()) >= MIN_PER_IMAGE


def test_an_image_that_only_short_tracks_see_keeps_those(case: Tried) -> None:
    model = pycolmap.Reconstruction(case[2])
    image_id = max(model.reg_image_ids())
    tracks = [[(e.image_id, e.point2D_idx) for e in point.track.elements] for point in model.points3D.values()]
    for track in tracks:
        if image_id in dict(track):
            others = [observation for observation in track if observation[0] != image_id]
            for observation in others[MIN_LENGTH - 2 :]:
                model.delete_observation(*observation)
    keep_agreeing(model)
    held = [p for p in model.points3D.values() if any(e.image_id == image_id for e in p.track.elements)]
    assert len(held) >= MIN_PER_IMAGE
    assert all(point.track.length() < MIN_LENGTH for point in held)


def still(point: pycolmap.Point3D, scene: Scene) -> bool:
    element = point.track.elements[0]
    return int(scene.point[element.image_id - 1][element.point2D_idx]) % 2 == 0


def test_the_choice_of_tracks_repeats_to_the_last_bit(case: Tried, tmp_path: Path) -> None:
    _, _, model, cache, done = case
    again = adjust(model, cache, OPTIONS, refine_principal_point=False, trim_tracks=True)
    for name, found in (("one", done[True]), ("two", again)):
        (tmp_path / name).mkdir()
        found.model.write_binary(tmp_path / name)
    for file in ("images.bin", "points3D.bin", "cameras.bin"):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_a_principal_point_that_is_off_is_found_through_the_kept_tracks(tmp_path: Path) -> None:
    scene = make_scene(N, 1200)
    graph = write_graph(tmp_path / "graph", scene, view_graph(scene))
    start = model_of(Case(graph, 0, N, SETTINGS, 0))
    params = np.array(start.camera(1).params)
    params[2:4] += (14.0, -9.0)
    start.camera(1).params = list(params)
    cache = open_cache(graph / "database.db")
    found = adjust(start, cache, OPTIONS, refine_principal_point=True, trim_tracks=True)
    assert found.adjustment.principal_point.decision == LensDecision.KEPT
    assert np.array(found.model.camera(1).params)[2:4] == pytest.approx([WIDTH / 2, HEIGHT / 2], abs=3.0)


def test_the_lens_has_as_many_terms_as_it_is_given(case: Tried) -> None:
    model = pycolmap.Reconstruction(case[2])
    model.camera(1).params = list(np.array([300.0, 310.0, 320.0, 240.0, 0.1, 0.02, 0.003, 0.0004]))
    set_lens(model, "RADIAL_FISHEYE")
    assert (model.camera(1).model.name, list(model.camera(1).params)) == (
        "RADIAL_FISHEYE",
        [305.0, 320.0, 240.0, 0.1, 0.02],
    )
    set_lens(model, "SIMPLE_RADIAL_FISHEYE")
    assert model.camera(1).model.name == "SIMPLE_RADIAL_FISHEYE"
    set_lens(model, "OPENCV_FISHEYE")
    assert list(model.camera(1).params) == [305.0, 305.0, 320.0, 240.0, 0.1, 0.0, 0.0, 0.0]
    assert model.camera(1).model.name == "OPENCV_FISHEYE"
