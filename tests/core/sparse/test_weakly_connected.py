from __future__ import annotations

import pycolmap
import pytest

from core.settings.groups import MapperSettings
from core.sparse.cases import Case
from core.sparse.weakly_connected import drop_weak_ends, drop_weak_images
from tests.core.sparse.scene import make_scene, model_of, view_graph, write_graph

N, CUT = 24, 18


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> pycolmap.Reconstruction:
    scene = make_scene(N)
    graph = write_graph(tmp_path_factory.mktemp("loose") / "graph", scene, view_graph(scene))
    return model_of(Case(graph, 0, N, MapperSettings(), 0))


def joined_by(model: pycolmap.Reconstruction, count: int, cut: int = CUT) -> pycolmap.Reconstruction:
    """A copy in which so many points are seen on both sides of the cut."""
    work = pycolmap.Reconstruction(model)
    sides = {i: {e.image_id - 1 >= cut for e in point.track.elements} for i, point in work.points3D.items()}
    for point_id in [i for i, side in sorted(sides.items()) if len(side) == 2][count:]:
        work.delete_point3D(point_id)
    return work


def frames(model: pycolmap.Reconstruction) -> list[int]:
    return sorted(image_id - 1 for image_id in model.reg_image_ids())


def test_a_whole_model_stays_as_it_is(model: pycolmap.Reconstruction) -> None:
    same, dropped = drop_weak_ends(model, N)
    assert same is model
    assert dropped == []


def test_the_smaller_side_of_a_weak_cut_is_taken_off(model: pycolmap.Reconstruction) -> None:
    work = joined_by(model, 12)
    left, dropped = drop_weak_ends(work, N)
    assert dropped == list(range(CUT, N))
    assert frames(left) == list(range(CUT))
    assert frames(work) == list(range(N))
    assert {e.image_id - 1 for point in left.points3D.values() for e in point.track.elements} == set(range(CUT))
    assert left.num_points3D() > 100


def test_what_is_out_of_order_stays_with_what_it_sees(model: pycolmap.Reconstruction) -> None:
    """The frames from 18 on are out of order and see what the frames before them see."""
    _, dropped = drop_weak_ends(joined_by(model, 0, cut=5), CUT)
    assert set(range(4)) <= set(dropped) <= set(range(10))
    _, dropped = drop_weak_ends(joined_by(model, 0, cut=13), CUT)
    assert set(range(14, N)) <= set(dropped) <= set(range(8, N))


def thinned(model: pycolmap.Reconstruction, frame: int, count: int) -> pycolmap.Reconstruction:
    """A copy in which a frame sees so many points."""
    work = pycolmap.Reconstruction(model)
    points = work.image(frame + 1).points2D
    for k in [k for k, point in enumerate(points) if point.has_point3D()][count:]:
        work.delete_observation(frame + 1, k)
    return work


def test_a_frame_that_sees_next_to_nothing_is_taken_off_though_no_cut_is_weak(model: pycolmap.Reconstruction) -> None:
    work = thinned(model, 10, 25)
    _, cut = drop_weak_ends(work, N)
    assert cut == []
    left, dropped = drop_weak_images(work)
    assert dropped == [10]
    assert frames(left) == [frame for frame in range(N) if frame != 10]
    assert frames(work) == list(range(N))
    assert all(element.image_id != 11 for point in left.points3D.values() for element in point.track.elements)


def test_frames_that_see_what_is_typical_stay(model: pycolmap.Reconstruction) -> None:
    same, dropped = drop_weak_images(model)
    assert same is model
    assert dropped == []
    _, dropped = drop_weak_images(thinned(model, 10, 40))
    assert dropped == []


def test_a_model_with_few_points_everywhere_keeps_its_frames(model: pycolmap.Reconstruction) -> None:
    poor = model
    for frame in range(N):
        poor = thinned(poor, frame, 25)
    assert drop_weak_images(poor)[1] == []
