"""What the final model leaves over becomes a model of its own, if it is strong and not rejected."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pycolmap
import pytest

from core.products.front import FramesProduct
from core.settings import make_settings
from core.sparse.cases import Case
from core.sparse.submodels import MIN_FRAMES, find_submodels, groups_of
from core.stage import StageTask
from core.stages import pieces as stage
from core.viewgraph import PairTable
from tests.core.making_products import facts_of
from tests.core.sparse.scene import Scene, center_errors, make_scene, model_of, view_graph, write_graph

pytestmark = pytest.mark.slow

N, CUT = 36, 20


@pytest.fixture(scope="module")
def broken(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scene, PairTable, Path]:
    """No pair across the cut."""
    scene = make_scene(N, 900)
    table = view_graph(scene)
    across = (table.pairs[:, 0] < CUT) & (table.pairs[:, 1] >= CUT)
    keep = np.flatnonzero(~across)
    rows = np.concatenate([np.arange(table.offsets[i], table.offsets[i + 1]) for i in keep])
    table = PairTable(
        offsets=np.cumsum([0, *table.n_inliers[keep]]).astype(np.int64),
        inliers=table.inliers[rows],
        **{
            name: getattr(table, name)[keep]
            for name in (
                "pairs",
                "method",
                "n_matches",
                "config",
                "rotation_xyzw",
                "translation",
                "triangulation_angle_deg",
            )
        },
    )
    return scene, table, write_graph(tmp_path_factory.mktemp("pieces") / "graph", scene, table)


def pieces(
    graph: Path, table: PairTable, taken: range, *, limit: int = 2, wrong: bool = False
) -> list[pycolmap.Reconstruction]:
    return find_submodels(
        graph,
        table,
        set(taken),
        N,
        make_settings().mapper,
        seed=0,
        limit=limit,
        is_wrong=lambda _: wrong,
        progress=lambda done, total: None,
    )


def test_the_other_side_of_a_break_is_a_model_of_its_own(broken: tuple[Scene, PairTable, Path]) -> None:
    scene, table, graph = broken
    found = pieces(graph, table, range(CUT))
    assert len(found) == 1
    ids = sorted(found[0].reg_image_ids())
    assert ids == list(range(CUT + 1, N + 1))
    assert center_errors(found[0], scene).max() < 0.05


def test_frames_of_an_earlier_model_stay_with_it(broken: tuple[Scene, PairTable, Path]) -> None:
    _, table, graph = broken
    found = pieces(graph, table, range(N - 2, N))
    assert [len(list(model.reg_image_ids())) for model in found] == [CUT, N - 2 - CUT]
    assert len(pieces(graph, table, range(N - 2, N), limit=1)) == 1


def test_weak_and_rejected_submodels_are_none(broken: tuple[Scene, PairTable, Path]) -> None:
    _, table, graph = broken
    assert pieces(graph, table, range(N - MIN_FRAMES + 1)) == []
    assert pieces(graph, table, range(CUT), wrong=True) == []
    assert pieces(graph, table, range(N)) == []
    left = np.ones(N, bool)
    assert [len(group) for group in groups_of(table, left)] == [CUT, N - CUT]
    weak = replace(table, offsets=np.zeros_like(table.offsets))
    assert groups_of(weak, left) == []


def test_the_stage_writes_what_the_final_model_lacks(broken: tuple[Scene, PairTable, Path], tmp_path: Path) -> None:
    _, _, graph = broken
    first = model_of(Case(graph, 0, CUT, make_settings().mapper, 0))
    (tmp_path / "extend/model").mkdir(parents=True)
    first.write_binary(tmp_path / "extend/model")
    out = tmp_path / "out"
    out.mkdir()
    inputs = {"graph": graph, "extend": tmp_path / "extend"}
    facts = {"frames": facts_of(FramesProduct, n_frames=N, n_search=N)}
    result = stage.run(StageTask("pieces", {}, make_settings(), inputs, facts, (), out))
    assert result.facts == {"n_pieces": 1, "registered_images": [N - CUT], "registered_first": CUT}
    assert pycolmap.Reconstruction(out / "1/model").num_reg_images() == N - CUT
