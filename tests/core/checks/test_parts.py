"""Where a rejected model is cut, and what is left of the view graph."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core.checks.parts import MIN_FRAMES, cut_apart, find_parts, prune
from core.settings import make_settings
from core.sparse.cases import Case
from core.verification import UNCALIBRATED
from core.viewgraph import PairTable
from core.windows import sequential_pairs
from tests.core.sparse.scene import Scene, make_scene, model_of, view_graph, write_graph

N, WELD = 32, 14
PAIRS = np.array(sequential_pairs(N, 5), np.int64)


def misfit(*welds: int) -> np.ndarray:
    """10 for pairs over a weld, else 1."""
    spans = np.zeros(len(PAIRS), bool)
    for weld in welds:
        spans |= (PAIRS[:, 0] <= weld) & (PAIRS[:, 1] > weld)
    return np.asarray(np.where(spans, 10.0, 1.0) - 0.01 * (PAIRS[:, 1] - PAIRS[:, 0]))


@pytest.mark.parametrize("welds", [(), (14,), (9, 20), (9, 11)])
def test_it_is_cut_at_the_welds_and_nowhere_beside_them(welds: tuple[int, ...]) -> None:
    assert cut_apart(PAIRS, misfit(*welds), 4.0, N) == list(welds)


def test_pairs_of_frames_out_of_order_make_no_cut() -> None:
    assert cut_apart(PAIRS, misfit(14), 4.0, 14) == []


@pytest.fixture(scope="module")
def welded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, PairTable, pycolmap.Reconstruction]:
    """A right view graph, and a model of it whose second half is turned by 30 degrees."""
    scene = make_scene(N, 900)
    table = view_graph(scene)
    graph = write_graph(tmp_path_factory.mktemp("welded") / "graph", scene, table)
    model = model_of(Case(graph, 0, N, make_settings().mapper, 0))
    turn = pycolmap.Rigid3d(pycolmap.Rotation3d(np.array([0.0, 0.0, np.radians(30.0)])), np.zeros(3))
    for image_id in range(WELD + 2, N + 1):
        image = model.image(image_id)
        pose = image.cam_from_world() * turn
        model.frame(image.frame_id).set_cam_from_world(image.camera_id, pose)
    return scene, table, model


def test_a_welded_model_is_cut_into_its_sides(welded: tuple[Scene, PairTable, pycolmap.Reconstruction]) -> None:
    _, table, model = welded
    found = prune(table, model, np.arange(N, dtype=np.float64), N)
    assert (found.n_rejected, found.cuts) == (0, [WELD])
    assert found.parts == [(0, WELD + 1), (WELD + 1, N)]
    across = (table.pairs[:, 0] <= WELD) & (table.pairs[:, 1] > WELD)
    assert not found.table.n_inliers[across].any()
    assert (found.table.n_inliers[~across] == table.n_inliers[~across]).all()


def test_a_model_that_fits_everywhere_leaves_no_parts(
    welded: tuple[Scene, PairTable, pycolmap.Reconstruction], tmp_path: Path
) -> None:
    scene, table, _ = welded
    graph = write_graph(tmp_path / "graph", scene, table)
    right = model_of(Case(graph, 0, N, make_settings().mapper, 0))
    found = prune(table, right, np.arange(N, dtype=np.float64), N)
    assert (found.n_rejected, found.cuts, found.parts) == (0, [], [])


def test_where_most_pairs_are_uncalibrated_it_is_cut_whatever_the_model_says(
    welded: tuple[Scene, PairTable, pycolmap.Reconstruction],
) -> None:
    _, table, _ = welded
    across = np.flatnonzero((table.pairs[:, 0] <= 18) & (table.pairs[:, 1] > 18))
    config = table.config.copy()
    config[across[2:]] = UNCALIBRATED
    nothing = pycolmap.Reconstruction()
    found = prune(replace(table, config=config), nothing, np.arange(N, dtype=np.float64), N)
    assert (found.n_rejected, found.cuts, found.parts) == (len(across) - 2, [18], [(0, 19), (19, N)])
    single = table.config.copy()
    single[across[0]] = UNCALIBRATED
    found = prune(replace(table, config=single), nothing, np.arange(N, dtype=np.float64), N)
    assert (found.n_rejected, found.cuts, found.parts) == (1, [], [(0, N)])
    assert found.table.n_inliers[across[0]] == 0


def test_a_frame_out_of_order_does_not_join_what_was_cut(
    welded: tuple[Scene, PairTable, pycolmap.Reconstruction],
) -> None:
    """The last frame of the list lies in time between the sides."""
    _, table, model = welded
    position = np.arange(N, dtype=np.float64)
    position[N - 1] = WELD + 0.5
    found = prune(table, model, position, N - 1)
    beside = (table.pairs[:, 1] == N - 1) & (table.pairs[:, 0] > WELD)
    assert (found.table.n_inliers[beside] == table.n_inliers[beside]).all()
    assert found.parts == [(0, WELD + 1), (WELD + 1, N - 1)]


def test_small_parts_are_none(welded: tuple[Scene, PairTable, pycolmap.Reconstruction]) -> None:
    _, table, _ = welded
    short = (table.pairs < MIN_FRAMES - 1).all(axis=1)
    offsets = np.cumsum([0, *np.where(short, 200, 0)]).astype(np.int64)
    assert find_parts(replace(table, offsets=offsets, inliers=np.zeros((offsets[-1], 2), np.uint32)), N) == []
