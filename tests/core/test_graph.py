"""The plan: every dependency is in it, further models come with their own chain, and nothing waits for the unknown."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from core.errors import StageFailed
from core.graph import expand
from core.products.contract import Facts
from core.products.front import CameraProduct, FramesProduct
from core.products.search import (
    ChoiceProduct,
    NoPartProduct,
    PassedProduct,
    PruneProduct,
    RefinedProduct,
    SubmodelsProduct,
)
from core.products.surface import UndistortProduct
from core.settings import make_settings
from core.stage import StageTask
from core.stage_specs import STAGES
from core.task_key import stage_of, submodel_of
from tests.core.making_products import facts_of

FRAMES: dict[str, Facts] = {"frames": facts_of(FramesProduct, n_frames=200, n_search=200)}
CAMERA: dict[str, Facts] = {"camera": facts_of(CameraProduct, model="OPENCV_FISHEYE")}
COARSE = facts_of(ChoiceProduct, best="seg_000_0000_0180", end=180)
SEARCHED: dict[str, Facts] = {**FRAMES, **CAMERA, "reduce_coarse": COARSE}
CHOSEN: dict[str, Facts] = {**SEARCHED, "reduce_refine": facts_of(RefinedProduct)}
WRONG = facts_of(RefinedProduct, vetoed=True, codes="bent_model, weak_join", start=20, end=200)
REJECTED: dict[str, Facts] = {**SEARCHED, "reduce_refine": WRONG}
PRUNED: dict[str, Facts] = {**REJECTED, "prune": facts_of(PruneProduct, parts=[[0, 61], [61, 200]])}
PARTED: dict[str, Facts] = {**PRUNED, "reduce_parts": facts_of(PassedProduct, best="section_001_0061_0200")}
NO_PART: dict[str, Facts] = {**PRUNED, "reduce_parts": facts_of(NoPartProduct, why="every model was vetoed")}
VIEWS: dict[str, Facts] = {"undistort": facts_of(UndistortProduct, n_views=90)}
DENSE: dict[str, Facts] = {**CHOSEN, **VIEWS}
MODELS: dict[str, Facts] = {**VIEWS, "pieces": facts_of(SubmodelsProduct, n_pieces=1)}
AFTER_REJECTION: dict[str, Facts] = {**PARTED, **MODELS}
OTHER_LENS: dict[str, Facts] = {**NO_PART, **MODELS}


def keys(facts: Mapping[str, Any], preset: str = "default", options: dict[str, Any] | None = None) -> list[str]:
    tasks = expand(make_settings(preset, options), facts)
    names = [task.key for task in tasks]
    assert len(set(names)) == len(names)
    for number, task in enumerate(tasks):
        assert task.stage in STAGES
        assert set(task.depends) <= set(names[:number]), task.key
    return names


@pytest.mark.parametrize(
    "facts",
    [{}, FRAMES, SEARCHED, CHOSEN, REJECTED, PRUNED, NO_PART, AFTER_REJECTION, OTHER_LENS, DENSE, {**DENSE, **MODELS}],
)
@pytest.mark.parametrize("preset", ["default", "draft", "thesis"])
def test_every_dependency_comes_before_its_task(facts: dict[str, Any], preset: str) -> None:
    if "reduce_coarse" in facts and preset == "draft":  # its one window is the whole clip
        facts = {**facts, "reduce_coarse": facts_of(ChoiceProduct, best="seg_000_0000_0200", end=200)}
    assert keys(facts, preset) == keys(facts, preset)


def test_chunks_cover_every_frame_and_view_once() -> None:
    tasks = {task.key: task for task in expand(make_settings(options={"compute.chunk_views": 40}), DENSE)}
    assert [dict(tasks[f"depth/{i:03d}"].args) for i in range(3)] == [
        {"start": 0, "end": 40},
        {"start": 40, "end": 80},
        {"start": 80, "end": 90},
    ]
    assert "depth/003" not in tasks
    frames = [dict(task.args) for key, task in tasks.items() if key.startswith("features/")]
    assert [frames[0]["start"], frames[-1]["end"]] == [0, 200]
    assert all(one["end"] == after["start"] for one, after in pairwise(frames))
    assert [dict(task.args) for key, task in tasks.items() if key.startswith("matches/")] == frames
    assert [dict(tasks[f"geometric/{i:03d}"].args) for i in range(3)] == [
        dict(tasks[f"depth/{i:03d}"].args) for i in range(3)
    ]


def test_a_stage_waits_for_everything_that_it_joins() -> None:
    tasks = {task.key: task for task in expand(make_settings(options={"compute.chunk_views": 40}), DENSE)}

    def of(stage: str) -> set[str]:
        return {key for key, task in tasks.items() if task.stage == stage}

    assert set(tasks["fuse"].depends) == {"undistort", *of("geometric")}
    assert set(tasks["camera"].depends) == {"frames", *of("focal")}
    assert set(tasks["graph"].depends) >= {*of("features"), *of("matches"), "bridge", "camera"}
    for key in of("geometric"):
        assert set(tasks[key].depends) == {"undistort", *of("depth")}


def test_a_start_that_finds_no_lens_stops_nothing() -> None:
    tasks = {task.key: task for task in expand(make_settings(), DENSE)}
    starts = [task for task in tasks.values() if task.stage == "focal"]
    assert {task.key for task in starts} == {
        *(f"focal/{fov:05.1f}" for fov in make_settings().camera.fov_starts_deg),
        "focal/PINHOLE-055.0",
        "focal/PINHOLE-085.0",
    }
    assert all(task.optional for task in starts)
    assert dict(next(task.args for task in starts if task.key == "focal/PINHOLE-055.0")) == {
        "fov_deg": 55.0,
        "model": "PINHOLE",
    }
    assert all({"frames", "motion"} < set(task.depends) for task in starts)
    for stage in ("camera", "features", "matches", "graph", "depth", "fuse", "mesh"):
        assert not any(task.optional for task in tasks.values() if task.stage == stage), stage


@pytest.mark.parametrize("model", ["OPENCV_FISHEYE", "SIMPLE_RADIAL"])
def test_where_the_model_of_the_lens_was_told_no_pinhole_is_tried(model: str) -> None:
    tasks = expand(make_settings(options={"camera.model": model}), FRAMES)
    assert {task.key for task in tasks if task.stage == "focal"} == {
        f"focal/{fov:05.1f}" for fov in make_settings().camera.fov_starts_deg
    }


def test_the_plan_only_grows() -> None:
    good: list[dict[str, Facts]] = [
        {},
        FRAMES,
        SEARCHED,
        CHOSEN,
        DENSE,
        {**DENSE, "pieces": facts_of(SubmodelsProduct, n_pieces=1)},
    ]
    for known in (good, [SEARCHED, REJECTED, PRUNED, PARTED, AFTER_REJECTION], [PRUNED, NO_PART, OTHER_LENS]):
        for before, after in pairwise(known):
            assert set(keys(before)) <= set(keys(after))
            earlier, later = (
                {task.key: task.depends for task in expand(make_settings(), facts)} for facts in (before, after)
            )
            assert all(later[key] == depends for key, depends in earlier.items())


def test_after_a_rejection_every_part_is_a_case_and_all_that_follows_reads_the_pruned_graph() -> None:
    assert "prune" not in keys(DENSE)
    assert keys(REJECTED)[-1] == "prune"
    tasks = {task.key: task for task in expand(make_settings(), AFTER_REJECTION)}
    names = ["section_000_0000_0061", "section_001_0061_0200"]
    assert dict(tasks[f"section/{names[1]}"].args) == {"name": names[1], "start": 61, "end": 200, "warm_from": ""}
    assert {f"section/{name}" for name in names} <= set(tasks["reduce_parts"].depends)
    assert tasks["confirm"].depends == ("frames", "prune", "reduce_parts")
    readers = ("extend", "pieces", "map_defects", "extend@1", "map_defects@1")
    assert all("prune" in tasks[key].depends and "graph" not in tasks[key].depends for key in readers)
    nothing = {**REJECTED, "prune": facts_of(PruneProduct)}
    assert "reduce_parts" in keys(nothing)  # which then says that there is none


def test_where_no_part_passes_a_perspective_lens_is_sought_and_all_that_follows_reads_its_graph() -> None:
    assert keys(PRUNED)[-1] == "reduce_parts"  # whether its cost is needed is not known yet
    assert not {"reverify", "reduce_perspective"} & set(keys(AFTER_REJECTION))
    tasks = {task.key: task for task in expand(make_settings(), OTHER_LENS)}
    assert tasks["reduce_parts"].args == {"another_lens": True}
    starts = [key for key in tasks if key.startswith("focal/SIMPLE_RADIAL-")]
    assert len(starts) == len(make_settings().camera.fov_starts_deg)
    assert dict(tasks["focal/SIMPLE_RADIAL-070.0"].args) == {"fov_deg": 70.0, "model": "SIMPLE_RADIAL"}
    assert all(tasks[key].optional and tasks[key].depends == tasks["focal/070.0"].depends for key in starts)
    assert set(starts) < set(tasks["reverify"].depends)
    assert not set(starts) & set(tasks["camera"].depends)
    case = "perspective/perspective_000_0020_0200"
    assert tasks[case].depends == ("reverify",)
    assert case in tasks["reduce_perspective"].depends
    assert tasks["confirm"].depends == ("frames", "reverify", "reduce_perspective")
    readers = ("extend", "pieces", "map_defects", "extend@1", "map_defects@1")
    assert all("reverify" in tasks[key].depends and "prune" not in tasks[key].depends for key in readers)


@pytest.mark.parametrize(
    ("options", "codes"),
    [
        ({"camera.model": "OPENCV"}, "bent_model"),
        ({"camera.model": "OPENCV_FISHEYE"}, "bent_model"),
        ({"camera.fov_deg": 90}, "bent_model"),
        ({"camera.focal": "colmap"}, "bent_model"),
        ({}, "no_parallax, weak_join"),
        ({}, "perspective from the start"),
    ],
)
def test_a_lens_that_was_told_or_is_not_to_blame_is_not_sought_anew(options: dict[str, Any], codes: str) -> None:
    facts = {**PRUNED, "reduce_refine": {**WRONG, "codes": codes}}
    if codes == "perspective from the start":
        facts = {**PRUNED, "camera": facts_of(CameraProduct, model="SIMPLE_RADIAL")}
    tasks = {task.key: task for task in expand(make_settings(options=options), facts)}
    assert tasks["reduce_parts"].args == {"another_lens": False}  # it then ends the search
    assert tasks["confirm"].depends == ("frames", "prune", "reduce_parts")
    assert not any(key.startswith(("focal/SIMPLE_RADIAL", "reverify", "perspective")) for key in tasks)


def test_the_gallery_waits_until_the_further_models_are_known() -> None:
    assert "gallery" not in keys(DENSE)
    assert "gallery" in keys(DENSE, "default", {"model.further": 0})
    assert "gallery" in keys({**DENSE, "pieces": facts_of(SubmodelsProduct, n_pieces=0)})
    tasks = {
        task.key: task for task in expand(make_settings(), {**DENSE, "pieces": facts_of(SubmodelsProduct, n_pieces=2)})
    }
    assert {"timeline", "timeline@1", "timeline@2"} <= set(tasks["gallery"].depends)
    assert tasks["timeline@2"].args == {"piece": 2}
    assert {"timeline", "timeline@1"} <= set(tasks["timeline@2"].depends)
    further = [task for task in tasks.values() if submodel_of(task.key)]
    assert {submodel_of(task.key) for task in further} == {1, 2}
    assert all(task.optional and task.args["piece"] == submodel_of(task.key) for task in further)
    assert "timeline@1" not in keys({**DENSE, "pieces": facts_of(SubmodelsProduct, n_pieces=0)})


def test_a_task_of_a_further_model_reads_its_own_models_results_first(tmp_path: Path) -> None:
    inputs = {name: tmp_path / name for name in ("frames", "extend", "extend@1", "depth@1/000", "depth/000")}

    def task(key: str, args: dict[str, Any]) -> StageTask:
        return StageTask(key, args, make_settings(), inputs, {}, (), tmp_path)

    first, own = task("mesh", {}), task("mesh@1", {"piece": 1})
    assert (first.input("extend").name, own.input("extend").name, own.input("frames").name) == (
        "extend",
        "extend@1",
        "frames",
    )
    assert [key for key, _ in first.fan_in("depth")] == ["depth/000"]
    assert [key for key, _ in own.fan_in("depth")] == ["depth@1/000"]
    assert own.has("extend")
    assert not own.has("frames")
    with pytest.raises(StageFailed, match="mesh@1 needs the result of fuse"):
        own.input("fuse")
    assert [stage_of(key) for key in ("mesh", "mesh@1", "depth@2/000", "coarse/seg_000_0000_0180")] == [
        "mesh",
        "mesh",
        "depth",
        "coarse",
    ]
