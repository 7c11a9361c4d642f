from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pycolmap
import pytest

from core.settings import make_settings
from core.settings.groups import MapperSettings
from core.sparse.cases import Case, run_case
from core.sparse.mapper import registered_names
from core.stage import StageTask
from core.stages import coarse, refine
from tests.core.sparse.scene import FOCAL, Scene, center_errors, found_in, make_scene, model_of, view_graph, write_graph

SETTINGS = MapperSettings(search_tracks=150)


@pytest.fixture(scope="module")
def scene() -> Scene:
    return make_scene()


@pytest.fixture(scope="module")
def graph(scene: Scene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_graph(tmp_path_factory.mktemp("case") / "graph", scene, view_graph(scene))


def model_bytes(model: object, folder: Path) -> dict[str, bytes]:
    folder.mkdir()
    model.write_binary(folder)  # type: ignore[attr-defined]
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def test_a_window_maps_only_its_own_frames_and_right(graph: Path, scene: Scene) -> None:
    result = run_case(Case(graph, 4, 20, SETTINGS, 0))
    assert result.model is not None
    assert registered_names(result.model) == [f"{i:04d}.jpg" for i in range(4, 20)]
    assert (result.frames, result.models, result.start_mode, result.reason) == (16, 1, "scratch", None)
    assert center_errors(result.model, scene).max() < 0.02
    assert 0.1 < result.stats.mean_reprojection_error_px < 0.6


def test_thinning_loses_no_image_and_no_points(graph: Path) -> None:
    thin = run_case(Case(graph, 0, 16, SETTINGS, 0))
    whole = run_case(Case(graph, 0, 16, MapperSettings(search_tracks=0), 0))
    assert thin.stats.registered_images == whole.stats.registered_images == 16
    assert thin.stats.points3D >= 0.98 * whole.stats.points3D


def test_a_repeated_case_is_identical_to_the_bit(graph: Path, tmp_path: Path) -> None:
    start = run_case(Case(graph, 0, 14, SETTINGS, 3)).model
    for name, model in (("scratch", None), ("warm", start)):
        case = Case(graph, 4, 16, SETTINGS, 3)
        first = model_bytes(run_case(case, model).model, tmp_path / f"{name}-1")
        again = model_bytes(run_case(case, model).model, tmp_path / f"{name}-2")
        assert first == again


def test_a_warm_case_drops_old_frames_and_registers_new_ones(graph: Path, scene: Scene) -> None:
    start = model_of(Case(graph, 0, 14, SETTINGS, 0))
    result = run_case(Case(graph, 6, 20, SETTINGS, 0), start)
    assert result.start_mode == "warm"
    assert registered_names(found_in(result)) == [f"{i:04d}.jpg" for i in range(6, 20)]
    assert center_errors(found_in(result), scene).max() < 0.02
    assert registered_names(start) == [f"{i:04d}.jpg" for i in range(14)]


def test_a_window_inside_its_start_keeps_all_frames(graph: Path) -> None:
    start = run_case(Case(graph, 0, 20, SETTINGS, 0)).model
    result = run_case(Case(graph, 8, 20, SETTINGS, 0), start)
    assert (result.start_mode, result.stats.registered_images) == ("warm", 12)


def test_a_wrong_start_is_replaced_by_one_from_scratch(graph: Path, scene: Scene) -> None:
    start = model_of(Case(graph, 0, 8, SETTINGS, 0))
    camera = start.camera(1)
    camera.params = list(np.array([FOCAL * 1.6, FOCAL * 1.6, *camera.params[2:4], 0.3, 0.0, 0.0, 0.0]))
    result = run_case(Case(graph, 2, 9, SETTINGS, 0), start)
    assert result.start_mode == "warm_then_scratch"
    assert result.stats.registered_images == 7
    assert center_errors(found_in(result), scene).max() < 0.02


def test_colmap_as_it_is_finds_the_same_window(graph: Path, scene: Scene) -> None:
    thesis = MapperSettings(search_tracks=0, initial_pair="colmap", bundle_adjustment="colmap")
    result = run_case(Case(graph, 0, 10, thesis, 0))
    assert result.stats.registered_images == 10
    assert center_errors(found_in(result), scene).max() < 0.02


def test_a_turning_camera_has_no_parallax(tmp_path: Path) -> None:
    scene = make_scene(8, 500, step=0.0)
    graph = write_graph(tmp_path / "graph", scene, view_graph(scene))
    result = run_case(Case(graph, 0, 8, SETTINGS, 0))
    assert result.model is None
    assert (result.reason, result.models, result.stats.score) == ("no_parallax", 0, (0, 0))


def test_frames_without_pairs_have_too_few_matches(tmp_path: Path) -> None:
    scene = make_scene(6, 300)
    graph = write_graph(tmp_path / "graph", scene, view_graph(scene, window=0))
    assert run_case(Case(graph, 0, 6, SETTINGS, 0)).reason == "too_few_matches"
    assert run_case(Case(graph, 0, 2, SETTINGS, 0)).reason == "too_few_frames"


def test_progress_counts_and_may_stop_the_case(graph: Path) -> None:
    calls: list[tuple[int, int]] = []
    run_case(Case(graph, 0, 10, SETTINGS, 0), progress=lambda done, total: calls.append((done, total)))
    assert calls[-1] == (10, 10)

    def stop(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run_case(Case(graph, 0, 10, SETTINGS, 0), progress=stop)


def case_task(graph: Path, out: Path, start: int, end: int, **more: Any) -> StageTask:
    args = {"name": f"seg_{start}_{end}", "start": start, "end": end, "warm_from": more.pop("warm_from", "")}
    inputs = {"graph": graph, **more}
    out.mkdir()
    settings = make_settings("default", {"mapper.search_tracks": 150})
    return StageTask("coarse/x", args, settings, inputs, {}, (), out)


def test_the_stages_write_a_model_and_a_row(graph: Path, tmp_path: Path) -> None:
    row = coarse.run(case_task(graph, tmp_path / "a", 0, 12)).facts
    assert (row["name"], row["kind"], row["start"], row["end"]) == ("seg_0_12", "coarse", 0, 12)
    assert (row["status"], row["start_mode"]) == ("succeeded", "scratch")
    assert (row["frames"], row["registered_images"]) == (12, 12)
    assert pycolmap.Reconstruction(tmp_path / "a" / "model").num_points3D() == row["points3D"]
    warm = case_task(graph, tmp_path / "b", 4, 16, warm_from="seg_0_12", **{"coarse/seg_0_12": tmp_path / "a"})
    row = refine.run(warm).facts
    assert (row["kind"], row["start_mode"], row["registered_images"]) == ("refine", "warm", 12)


def test_a_failed_start_means_from_scratch(graph: Path, tmp_path: Path) -> None:
    row = coarse.run(case_task(graph, tmp_path / "a", 0, 8, warm_from="seg_that_failed")).facts
    assert (row["status"], row["start_mode"]) == ("succeeded", "scratch")


def test_no_model_is_an_outcome_with_a_row_and_no_folder(graph: Path, tmp_path: Path) -> None:
    row = coarse.run(case_task(graph, tmp_path / "a", 0, 2)).facts
    assert (row["status"], row["reason"], row["models"], row["points3D"]) == ("no_model", "too_few_frames", 0, 0)
    assert list((tmp_path / "a").iterdir()) == []


def test_a_wrong_distortion_is_freed_when_the_model_stands(graph: Path, scene: Scene, tmp_path: Path) -> None:
    wrong = shutil.copytree(graph, tmp_path / "graph")
    with pycolmap.Database.open(wrong / "database.db") as database:
        camera = database.read_camera(1)
        camera.params = list(np.array([*camera.params[:4], 0.06, 0.0, 0.0, 0.0]))
        database.update_camera(camera)
    result = run_case(Case(wrong, 0, 16, SETTINGS, 0))
    assert not SETTINGS.refine_distortion
    assert result.stats.mean_reprojection_error_px < 0.6
    assert center_errors(found_in(result), scene).max() < 0.02
