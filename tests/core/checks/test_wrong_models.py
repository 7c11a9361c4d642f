"""Checks of a whole model: a right one passes, and each deliberate mistake is found by the check that it is for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pycolmap
import pytest
from numpy.typing import NDArray

from core.checks.joins import BROKEN_POINTS, WEAK_POINTS, check_joins, points_across, tracks_of
from core.checks.matches import match_agreement
from core.checks.model import check_model
from core.checks.stats import model_stats
from core.settings import make_settings
from core.sparse.cases import Case
from core.viewgraph import PairTable, read_table
from tests.core.sparse.scene import make_scene, model_of, view_graph, write_graph

N, CUT = 20, 10

Made = tuple[pycolmap.Reconstruction, PairTable]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Made:
    scene = make_scene(N, 600)
    graph = write_graph(tmp_path_factory.mktemp("wrong") / "graph", scene, view_graph(scene))
    model = model_of(Case(graph, 0, N, make_settings().mapper, 0))
    assert model is not None
    return model, read_table(graph / "graph.npz")


def codes(model: pycolmap.Reconstruction, graph: PairTable) -> dict[str, str]:
    return {flag.code: flag.severity for flag in check_model(model, model_stats(model), graph, N)}


def moved(model: pycolmap.Reconstruction, shift: Callable[[int], NDArray[np.float64]]) -> pycolmap.Reconstruction:
    """Copy with the camera centres moved and their rotations left as they are."""
    copy = pycolmap.Reconstruction(model)
    for image_id in copy.reg_image_ids():
        image = copy.image(image_id)
        pose = image.cam_from_world()
        rotation = pose.rotation.matrix()
        pose.translation = pose.translation - rotation @ shift(image_id - 1)
        copy.frame(image.frame_id).set_cam_from_world(image.camera_id, pose)
    return copy


def test_the_right_model_passes(made: Made) -> None:
    model, graph = made
    assert codes(model, graph) == {}
    agreement = match_agreement(model, graph)
    assert np.median(agreement.shares) > 0.95
    assert len(agreement.pairs) == len(graph.pairs)


def test_a_half_put_into_the_wrong_place_is_found_although_no_rotation_is_wrong(made: Made) -> None:
    model, graph = made
    found = codes(moved(model, lambda frame: np.array([0.0, 1.5 * (frame >= CUT), 0.0])), graph)
    assert found["two_motions"] == "error"
    assert "bent_model" not in found


def test_a_scene_that_no_rigid_motion_explains_is_found(made: Made) -> None:
    model, graph = made
    rng = np.random.default_rng(1)
    stray = rng.normal(scale=0.4, size=(N, 3))
    assert codes(moved(model, lambda frame: stray[frame]), graph)["not_static"] == "error"


@pytest.mark.parametrize(("left", "severity"), [(BROKEN_POINTS - 1, "error"), (WEAK_POINTS - 1, "warning")])
def test_a_join_that_hangs_on_few_points_is_found(made: Made, left: int, severity: str) -> None:
    model, graph = made
    copy = pycolmap.Reconstruction(model)
    across = [
        point_id
        for point_id, point in copy.points3D.items()
        if len({element.image_id - 1 >= CUT for element in point.track.elements}) == 2
    ]
    for point_id in sorted(across)[left:]:
        copy.delete_point3D(point_id)
    assert codes(copy, graph)["weak_join"] == severity


def test_points_that_never_move_hold_nothing_together(made: Made) -> None:
    model, _ = made
    tracks = tracks_of(model)
    frames = np.arange(N)
    assert points_across(tracks, frames).min() > WEAK_POINTS
    still = type(tracks)(tracks.first, tracks.last, np.zeros(len(tracks.first)))
    flag = check_joins(still, frames, N)
    assert flag is not None
    assert (flag.code, flag.severity, flag.value) == ("weak_join", "warning", 0.0)
    assert check_joins(tracks, frames, N) is None


def test_pairs_that_show_one_plane_are_said(made: Made) -> None:
    model, graph = made
    assert "planar_start" in codes(model, replace(graph, config=np.full_like(graph.config, 6)))
    half = np.where(np.arange(len(graph.config)) % 2, 4, graph.config).astype(np.uint8)
    assert "planar_start" not in codes(model, replace(graph, config=half))


def test_frames_out_of_order_make_no_cut(made: Made, tmp_path: Path) -> None:
    tracks = tracks_of(made[0])
    assert check_joins(tracks, np.array([0, 1, 2, 30, 31]), 3) is None
