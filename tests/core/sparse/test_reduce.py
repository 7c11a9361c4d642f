from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.errors import NoReconstruction, StageFailed
from core.io.annotations import write_annotations
from core.io.frames import write_frames
from core.products.contract import Products
from core.scene.case import CaseKind
from core.scene.frame import Crop, SourceFrame
from core.settings import make_settings
from core.settings.groups import MapperSettings
from core.sparse.cases import Case
from core.sparse.reduce import Candidate, candidates_of, reduce_cases, reduce_parts, reduce_perspective, reduce_refined
from core.stage import StageTask
from core.stages import reduce_coarse, reduce_refine
from tests.core.making_rows import detection, run_frames
from tests.core.sparse.scene import HEIGHT, WIDTH, make_scene, model_of, view_graph, write_graph


def row(name: str, registered: int, points: int, **more: Any) -> dict[str, Any]:
    kind = "refine" if name.startswith("refine") else "coarse"
    status, reason = ("succeeded", "") if registered else ("no_model", "no_parallax")
    return {
        "name": name,
        "kind": kind,
        "start": 0,
        "end": 180,
        "status": status,
        "reason": reason,
        "registered_images": registered,
        "points3D": points,
        "frames": 180,
        "models": int(registered > 0),
        "mean_reprojection_error_px": 0.0,
        "median_reprojection_error_px": 0.0,
        "start_mode": "scratch",
        **more,
    }


def case(name: str, registered: int, points: int, verified: int | None = None, **more: Any) -> Candidate:
    (found,) = candidates_of(Products({"coarse/x": row(name, registered, points, **more)}), CaseKind.COARSE)
    return replace(found, verified=verified)


def task(facts: dict[str, Any], out: Path = Path()) -> StageTask:
    """A reducer's task; every case's model is a file with the case's name."""
    inputs = {key: out / key for key in facts if "/" in key}
    for key, folder in inputs.items():
        (folder / "model").mkdir(parents=True, exist_ok=True)
        (folder / "model" / "points3D.bin").write_text(key)
    settings = make_settings("default", {"model.prefer_verified": False})
    return StageTask("reduce", {}, settings, inputs, facts, (), out)


def test_images_count_before_points() -> None:
    choice = reduce_cases([case("seg_000", 179, 90_000), case("seg_001", 180, 10), case("seg_002", 180, 11)])
    assert (choice.best, choice.registered_images, choice.points3D, choice.kind) == (
        "seg_002",
        180,
        11,
        "coarse",
    )
    assert [item.name for item in choice.ranking] == ["seg_002", "seg_001", "seg_000"]


def test_of_equal_cases_the_first_name_wins() -> None:
    assert reduce_cases([case("seg_004", 9, 9), case("seg_001", 9, 9)]).best == "seg_001"


def test_cases_without_model_are_left_out() -> None:
    choice = reduce_cases([case("seg_000", 0, 0), case("seg_001", 3, 5)])
    assert [item.name for item in choice.ranking] == ["seg_001"]


def test_no_model_at_all_says_why() -> None:
    rows = [case("seg_000", 0, 0), case("seg_001", 0, 0), case("seg_002", 0, 0, reason="too_few_matches")]
    with pytest.raises(NoReconstruction) as raised:
        reduce_cases(rows)
    assert raised.value.code == "no_reconstruction"
    assert "no_parallax in 2 of 3 cases" in raised.value.message
    assert "too_few_matches in 1 of 3 cases" in raised.value.message


def test_a_refined_case_must_be_strictly_better() -> None:
    best = case("seg_006", 180, 500)
    assert reduce_refined(best, [case("refine_000", 180, 500), case("refine_001", 0, 0)]).best == "seg_006"
    choice = reduce_refined(best, [case("refine_000", 180, 501), case("refine_001", 170, 900)])
    assert (choice.best, choice.kind) == ("refine_000", "refine")
    assert [item.name for item in choice.ranking] == ["refine_000", "seg_006", "refine_001"]


def test_the_stages_take_the_rows_from_the_facts(tmp_path: Path) -> None:
    facts = {
        "coarse/seg_000": row("seg_000", 20, 7),
        "coarse/seg_001": row("seg_001", 30, 7),
        "refine/refine_000": row("refine_000", 31, 1),
    }
    coarse = reduce_coarse.run(task({k: v for k, v in facts.items() if k.startswith("coarse")}, tmp_path))
    assert coarse.best == "seg_001"
    refined = {k: v for k, v in facts.items() if k != "coarse/seg_000"} | {"reduce_coarse": coarse.facts}
    assert reduce_refine.run(task(refined, tmp_path)).best == "refine_000"
    assert (tmp_path / "model" / "points3D.bin").read_text() == "refine/refine_000"


def test_a_winner_without_its_row_is_a_broken_plan() -> None:
    with pytest.raises(StageFailed):
        reduce_refine.run(task({"reduce_coarse": {"best": "seg_001"}}))


BENT: dict[str, Any] = {"vetoed": 1, "checks": [{"code": "bent_model", "severity": "error"}]}


def test_a_rejected_case_loses_against_any_other() -> None:
    rows = [case("seg_000", 180, 90_000, **BENT), case("seg_001", 30, 5)]
    choice = reduce_cases(rows)
    assert [item.name for item in choice.ranking] == ["seg_001", "seg_000"]
    assert reduce_refined(rows[0], [case("refine_000", 20, 4)]).best == "refine_000"
    assert reduce_refined(rows[1], [case("refine_000", 220, 9, **BENT)]).best == "seg_001"


def test_when_every_case_is_rejected_the_parts_have_their_turn() -> None:
    best = case("seg_000", 180, 9, **BENT)
    assert reduce_cases([best]).best == "seg_000"  # refinement still gets its chance
    refined = reduce_refined(best, [case("refine_000", 170, 9, **BENT)])
    assert (refined.best, refined.vetoed, refined.codes) == ("seg_000", True, "bent_model")
    assert not reduce_refined(case("seg_000", 180, 9), []).vetoed
    parts = [
        case("section_000", 60, 9, verified=1),
        case("section_001", 20, 9, verified=3),
        case("section_002", 90, 9, **BENT),
    ]
    choice = reduce_parts(refined, parts)
    assert [item.name for item in choice.ranking] == ["section_001", "section_000", "section_002"]
    (flag,) = choice.flags
    assert (flag.code, flag.severity) == ("parts_after_veto", "warning")
    assert "seg_000, vetoed for bent_model" in flag.where
    assert reduce_parts(refined, [replace(part, verified=2) for part in parts]).best == "section_000"


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ([], "seg_000: bent_model$"),
        ([case("section_000", 20, 9, **BENT), case("section_001", 0, 0)], "none of its 2 parts"),
    ],
)
def test_without_a_part_that_passes_there_is_no_reconstruction(parts: list[Candidate], says: str) -> None:
    with pytest.raises(NoReconstruction, match=says):
        reduce_parts(reduce_refined(case("seg_000", 180, 9, **BENT), []), parts)


@pytest.mark.parametrize("cases", [[], [case("perspective_000", 170, 9, **BENT)], [case("perspective_000", 0, 0)]])
def test_a_perspective_case_that_does_not_pass_leaves_the_run_refused(cases: list[Candidate]) -> None:
    rejected = reduce_refined(case("seg_000", 180, 9, **BENT), [])
    with pytest.raises(NoReconstruction, match="every model was vetoed; nor does a model of a perspective lens"):
        reduce_perspective(rejected, "every model was vetoed", cases)
    passed = reduce_perspective(rejected, "every model was vetoed", [*cases, case("perspective_001", 160, 9)])
    assert passed.best == "perspective_001"
    assert [(flag.code, flag.severity) for flag in passed.flags] == [("perspective_after_veto", "warning")]


def test_without_rejection_the_score_alone_counts() -> None:
    rows = [case("seg_000", 180, 9, **BENT), case("seg_001", 30, 5)]
    assert reduce_cases(rows, reject=False).best == "seg_000"
    assert reduce_refined(rows[0], [], reject=False).best == "seg_000"


def test_verified_detections_count_between_trust_and_size() -> None:
    best = case("seg_000", 180, 9, verified=40)
    choice = reduce_refined(best, [case("refine_000", 220, 90, verified=39)])
    assert [item.name for item in choice.ranking] == ["seg_000", "refine_000"]
    assert choice.ranking[0].verified_detections == 40
    assert reduce_refined(best, [case("refine_000", 170, 8, verified=41)]).best == "refine_000"
    assert reduce_refined(best, [case("refine_000", 180, 10, verified=40)]).best == "refine_000"
    bent = case("refine_000", 220, 90, verified=90, **BENT)
    assert reduce_refined(best, [bent]).best == "seg_000"


def test_the_stage_counts_the_detections_of_every_model(tmp_path: Path) -> None:
    """The smaller model shows the frame of the only detection."""
    scene = make_scene(20)
    graph = write_graph(tmp_path / "graph", scene, view_graph(scene))
    facts, inputs = {}, {}
    for key, start, end in (("coarse/seg_000", 0, 13), ("refine/refine_000", 12, 20)):
        model = model_of(Case(graph, start, end, MapperSettings(), 0))
        inputs[key] = tmp_path / key
        (inputs[key] / "model").mkdir(parents=True)
        model.write_binary(inputs[key] / "model")
        facts[key] = row(key.split("/")[1], model.num_reg_images(), model.num_points3D())
    crop = Crop(0, 0, WIDTH, HEIGHT, WIDTH, HEIGHT)
    for name in ("frames", "annotations"):
        inputs[name] = tmp_path / name
        inputs[name].mkdir()
    write_frames(inputs["frames"], run_frames(20, 0.05, every=2), crop)
    write_annotations(inputs["annotations"], [detection(0, 1.7, (0.2, 0.2, 0.8, 0.8), 34)], {}, [SourceFrame(0, 34)])
    for prefer, winner in ((True, "refine_000"), (False, "seg_000")):
        out = tmp_path / str(prefer)
        settings = make_settings("default", {"model.prefer_verified": prefer})
        all_facts = {**facts, "reduce_coarse": {"best": "seg_000"}}
        found = reduce_refine.run(StageTask("reduce_refine", {}, settings, inputs, all_facts, (), out))
        assert found.best == winner
        counts = [item.verified_detections for item in found.ranking]
        assert counts == ([1, 0] if prefer else [None, None])
