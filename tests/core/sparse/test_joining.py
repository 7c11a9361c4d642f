"""Two models of one scene joined through images they share; what does not fit stays apart."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from core.settings import make_settings
from core.sparse import joining
from core.sparse.cases import Case
from core.sparse.joining import Poses, fit_similarity, holds, join_rest
from core.sparse.mapper import restrict_model
from core.viewgraph import PairTable
from tests.core.sparse.scene import Scene, center_errors, make_scene, model_of, view_graph, write_graph

pytestmark = pytest.mark.slow

N, CUT = 40, 22
SETTINGS = make_settings().mapper


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, PairTable, Path, Any]:
    """A graph without a break, and a model of its first frames only."""
    scene = make_scene(N, 900)
    table = view_graph(scene)
    graph = write_graph(tmp_path_factory.mktemp("join") / "graph", scene, table)
    model = model_of(Case(graph, 0, CUT, SETTINGS, 0))
    return scene, table, graph, model


def joined(made: tuple[Scene, PairTable, Path, Any], wrong: bool = False) -> tuple[Any, list[dict[str, Any]]]:
    _, table, graph, model = made
    found, attempts = join_rest(graph, model, table, N, SETTINGS, seed=0, is_wrong=lambda _: wrong)
    return found, [attempt.to_dict() for attempt in attempts]


def test_the_rest_is_joined_through_shared_images(made: tuple[Scene, PairTable, Path, Any]) -> None:
    model, attempts = joined(made)
    assert [(one["outcome"], one["first_frame"], one["last_frame"]) for one in attempts] == [("joined", CUT, N - 1)]
    assert attempts[0]["shared"] >= joining.MIN_SHARED
    assert model.num_reg_images() == N
    assert center_errors(model, made[0]).max() < 0.05


def test_nothing_left_over_is_nothing_to_do(made: tuple[Scene, PairTable, Path, Any]) -> None:
    _, table, graph, _ = made
    whole = model_of(Case(graph, 0, N, SETTINGS, 0))
    model, attempts = join_rest(graph, whole, table, N, SETTINGS, seed=0, is_wrong=lambda _: False)
    assert model is whole
    assert attempts == []


def test_a_rejected_join_is_not_used(made: tuple[Scene, PairTable, Path, Any]) -> None:
    model, attempts = joined(made, wrong=True)
    assert model is made[3]
    assert attempts[0]["outcome"] == "vetoed"


def test_submodels_that_share_too_little_stay_apart(
    made: tuple[Scene, PairTable, Path, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(joining, "OVERLAP", 2)
    model, attempts = joined(made)
    assert model is made[3]
    assert attempts[0]["outcome"] == "no_shared_images"


def test_a_jump_between_the_models_is_refused(made: tuple[Scene, PairTable, Path, Any]) -> None:
    """The shared images of a model that was put together wrongly: half of them moved on by a blade."""
    _, table, graph, model = made
    wrong = restrict_model(model, [f"{frame:04d}.jpg" for frame in range(CUT)])
    for image_id in list(wrong.reg_image_ids()):
        if image_id - 1 >= CUT - joining.OVERLAP // 2:
            image = wrong.image(image_id)
            pose = image.cam_from_world()
            pose.translation = pose.translation + np.array([1.0, 0.0, 0.0])
            wrong.frame(image.frame_id).set_cam_from_world(image.camera_id, pose)
    found, attempts = join_rest(graph, wrong, table, N, SETTINGS, seed=0, is_wrong=lambda _: False)
    assert found is wrong
    assert attempts[0].outcome == "disagree"


def poses(n: int = 12) -> Poses:
    rng = np.random.default_rng(2)
    rotations = Rotation.from_rotvec(rng.normal(scale=0.2, size=(n, 3))).as_matrix()
    return Poses(rotations, np.cumsum(rng.normal([0.3, 0.0, 0.0], 0.02, (n, 3)), axis=0))


def changed(first: Poses, scale: float, turn: Rotation, shift: np.ndarray[Any, Any]) -> Poses:
    """The same cameras in a frame of their own."""
    centers = (first.centers - shift) @ turn.as_matrix() / scale
    return Poses(first.rotations @ turn.as_matrix(), centers)


def test_the_similarity_is_found_on_a_straight_path_and_despite_an_outlier() -> None:
    first = poses()
    turn, shift = Rotation.from_rotvec([0.4, -1.0, 2.0]), np.array([3.0, -1.0, 0.5])
    second = changed(first, 2.5, turn, shift)
    second.rotations[3] = Rotation.from_rotvec([0.0, 0.5, 0.0]).as_matrix() @ second.rotations[3]
    found = fit_similarity(first, second)
    assert found.scale == pytest.approx(2.5, rel=1e-6)
    np.testing.assert_allclose(found.rotation, turn.as_matrix(), atol=1e-6)
    np.testing.assert_allclose(found.shift, shift, atol=1e-5)
    assert holds(found, first, second)


@pytest.mark.parametrize("wrong", ["turned", "moved", "scaled"])
def test_what_differs_on_the_images_left_out_does_not_hold(wrong: str) -> None:
    first = poses()
    turn, shift = Rotation.from_rotvec([0.4, -1.0, 2.0]), np.array([3.0, -1.0, 0.5])
    found = fit_similarity(first, changed(first, 2.5, turn, shift))
    if wrong == "turned":
        second = changed(first, 2.5, turn * Rotation.from_euler("x", 3, degrees=True), shift)
    else:
        second = changed(first, 2.5 * (1.1 if wrong == "scaled" else 1.0), turn, shift + (wrong == "moved"))
    assert not holds(found, first, second)
