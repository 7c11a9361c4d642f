from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pycolmap
import pytest

from core.checks.lens import MAX_LEFT
from core.checks.stats import ModelStats, model_stats
from core.products.contract import Facts
from core.products.front import CameraProduct, FramesProduct
from core.products.search import RefinedProduct
from core.settings import make_settings
from core.settings.groups import MapperSettings
from core.sparse.cases import Case, choose, confirmed_or_searched
from core.sparse.extend import register_rest
from core.sparse.focal import SpanFocal, joined
from core.stage import StageTask
from core.stages import confirm as confirm_stage
from core.stages import extend as extend_stage
from tests.core.making_products import facts_of
from tests.core.sparse.scene import FOCAL, Scene, center_errors, make_scene, model_of, view_graph, write_graph

pytestmark = pytest.mark.slow

SETTINGS = MapperSettings(search_tracks=150)
N_FRAMES = 20


@pytest.fixture(scope="module")
def scene() -> Scene:
    return make_scene(N_FRAMES)


@pytest.fixture(scope="module")
def graph(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_graph(tmp_path_factory.mktemp("extend") / "graph", scene, view_graph(scene))


@pytest.fixture(scope="module")
def winner(graph: Path) -> pycolmap.Reconstruction:
    return model_of(Case(graph, 4, 14, SETTINGS, 0))


def stats(images: int, points: int) -> ModelStats:
    return ModelStats(images, points, 1.0, 1.0, 5.0)


@pytest.mark.parametrize(
    ("confirmed", "kept"),
    [
        (stats(220, 65000), "confirmed"),
        (stats(220, 64000), "confirmed"),
        (stats(219, 70000), "confirmed"),
        (stats(220, 60000), "searched"),
        (stats(180, 90000), "searched"),
        (None, "searched"),
    ],
)
def test_the_confirmed_model_is_kept_unless_clearly_weaker(confirmed: ModelStats | None, kept: str) -> None:
    assert choose(stats(220, 65087), confirmed) == kept


def test_a_model_that_is_too_good_for_its_window_is_not_replaced(graph: Path) -> None:
    whole = model_of(Case(graph, 0, N_FRAMES, SETTINGS, 0))
    model, kept = confirmed_or_searched(Case(graph, 4, 14, SETTINGS, 0), whole)
    assert kept == "searched"
    assert model is whole


def test_a_confirmed_model_that_is_called_wrong_is_not_gone_on_with(
    graph: Path, winner: pycolmap.Reconstruction
) -> None:
    case = Case(graph, 4, 14, SETTINGS, 0)
    assert confirmed_or_searched(case, winner)[1] == "confirmed"
    model, kept = confirmed_or_searched(case, winner, is_wrong=lambda _: True)
    assert kept == "searched"
    assert model is winner


def test_the_rest_of_the_frames_is_registered_on_both_sides(
    graph: Path, winner: pycolmap.Reconstruction, scene: Scene
) -> None:
    model = register_rest(graph, winner, N_FRAMES, SETTINGS, seed=0)
    assert sorted(model.reg_image_ids()) == list(range(1, N_FRAMES + 1))
    assert center_errors(model, scene).max() < 0.03
    assert winner.num_reg_images() == 10


def run_stages(
    graph: Path,
    winner: pycolmap.Reconstruction,
    out: Path,
    start_mode: str = "warm",
    options: Mapping[str, object] | None = None,
    said_px: float = FOCAL,
) -> tuple[Facts, Facts]:
    settings = make_settings(
        "default", {"mapper.search_tracks": 150, "model.align_keypoints": False, **(options or {})}
    )
    for name in ("reduce_refine/model", "confirm", "extend"):
        (out / name).mkdir(parents=True)
    winner.write_binary(out / "reduce_refine/model")
    reduced = facts_of(RefinedProduct, best="seg_000_0004_0014", start=4, end=14, start_mode=start_mode)

    def task(key: str, inputs: Mapping[str, Path], facts: Mapping[str, Facts]) -> StageTask:
        return StageTask(key, {}, settings, inputs, facts, (), out / key)

    confirmed = confirm_stage.run(
        task("confirm", {"graph": graph, "reduce_refine": out / "reduce_refine"}, {"reduce_refine": reduced})
    ).facts
    span = SpanFocal(0, 14, 14, said_px, 0.0, 14, 900, 0.5)
    camera = facts_of(CameraProduct, chosen_start_deg=85.0, starts=[joined(85.0, "OPENCV_FISHEYE", [span])])
    facts: dict[str, Facts] = {
        "frames": facts_of(FramesProduct, n_frames=N_FRAMES, n_search=N_FRAMES),
        "camera": camera,
        "confirm": confirmed,
    }
    return confirmed, extend_stage.run(task("extend", {"graph": graph, "confirm": out / "confirm"}, facts)).facts


def test_the_stages_write_what_they_promise(
    graph: Path, winner: pycolmap.Reconstruction, tmp_path: Path, scene: Scene
) -> None:
    confirmed, extended = run_stages(graph, winner, tmp_path)
    assert (confirmed["kept"], confirmed["start_mode"], confirmed["registered_images"]) == ("confirmed", "scratch", 10)
    assert extended["registered_images"] == N_FRAMES
    assert extended["checks"] == []
    assert extended["adjustment"]["error_after_px"] <= extended["adjustment"]["error_before_px"]
    assert json.loads((tmp_path / "extend/registered.json").read_text()) == list(range(N_FRAMES))
    model = pycolmap.Reconstruction(tmp_path / "extend/model")
    assert [model.image(i + 1).name for i in range(N_FRAMES)] == [f"{i:04d}.jpg" for i in range(N_FRAMES)]
    assert model_stats(model).points3D == extended["points3D"]
    assert center_errors(model, scene).max() < 0.02


def test_what_is_switched_off_is_not_done(graph: Path, winner: pycolmap.Reconstruction, tmp_path: Path) -> None:
    off = {"model.confirm": False, "model.register_rest": False, "model.final_adjustment": False}
    confirmed, extended = run_stages(graph, winner, tmp_path, "warm", off)
    assert (confirmed["kept"], confirmed["start_mode"]) == ("searched", "warm")
    assert extended["registered_images"] == 10
    assert extended["adjustment"] is None
    assert extended["principal_point_refined"] is False
    assert {flag["code"] for flag in extended["checks"]} <= {"coverage_low"}
    same = [pycolmap.Reconstruction(tmp_path / name / "model") for name in ("reduce_refine", "extend")]
    assert model_stats(same[0]) == model_stats(same[1])


def test_a_winner_from_scratch_has_nothing_to_confirm(
    graph: Path, winner: pycolmap.Reconstruction, tmp_path: Path
) -> None:
    off = {"model.final_adjustment": False}
    confirmed, extended = run_stages(graph, winner, tmp_path, "scratch", off, said_px=1.5 * FOCAL)
    assert [flag["code"] for flag in extended["checks"]] == ["lens_unsettled"]
    assert (confirmed["kept"], confirmed["start_mode"]) == ("searched", "scratch")
    same = [pycolmap.Reconstruction(tmp_path / name / "model") for name in ("reduce_refine", "confirm")]
    assert model_stats(same[0]) == model_stats(same[1])


def test_a_lens_that_only_the_last_adjustment_leaves_is_held_and_flagged(
    graph: Path, winner: pycolmap.Reconstruction, tmp_path: Path
) -> None:
    searched = pycolmap.Reconstruction(winner)
    camera = searched.cameras[1]
    camera.params = [1.45 * FOCAL, 1.45 * FOCAL, *camera.params[2:]]
    alone = {"model.confirm": False, "model.register_rest": False, "model.drop_loose": False}
    _, extended = run_stages(graph, searched, tmp_path, "scratch", alone, said_px=1.45 * FOCAL)
    assert extended["focal_px"] == pytest.approx(1.45 * FOCAL)
    left = [flag for flag in extended["checks"] if flag["where"] == "focal length against what spans of the clip said"]
    assert [flag["code"] for flag in left] == ["lens_unsettled"]
    assert left[0]["value"] > MAX_LEFT
