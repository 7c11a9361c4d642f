"""Rows scored against the truth: what was found, on which blade, which side and how far out, and how much was seen."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.accuracy import true_coverage as true_coverage_module
from bench.accuracy.result import load_result
from bench.accuracy.score import score_result, score_row_of
from bench.accuracy.table import _row_rows
from bench.accuracy.true_coverage import true_coverage
from bench.accuracy.true_row import TrueRow
from bench.accuracy.truth import Truth, load_truth
from bench.main import main
from bench.row.cases import Case, Expected, Weld
from bench.row.measure import Bench
from bench.row.table import markdown, totals
from bench.row.true_result import MM_PER_UNIT, SHIFT, TURNED, make_true_result
from bench.scenes.blades import _blade, pitch_rad
from bench.scenes.spec import Lens, Scene
from core.surface.ply import Mesh, read_mesh, write_mesh

Document = dict[str, Any]

SCENE = Scene(
    "tiny-row", 204, Lens(240, 180, 92.0), n_frames=6, turn_deg=17.0, blades_present=3, n_defects=6, distance_mm=34.0
)
PITCH_DEG = 5.625


@pytest.fixture(scope="module", autouse=True)
def fewer_points() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(true_coverage_module, "POINTS", 3000)
        yield


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    folder = tmp_path_factory.mktemp("row")
    make_true_result(Case(SCENE), folder / "truth", folder / "result")
    return folder / "truth", folder / "result"


@pytest.fixture(scope="module")
def truth(made: tuple[Path, Path]) -> Truth:
    return load_truth(made[0])


@pytest.fixture
def scored(made: tuple[Path, Path], truth: Truth) -> Callable[[Document], Document]:
    """The score of the result with a row: a right one, changed."""
    truth_folder, folder = made
    assert truth.row is not None
    shown = true_coverage(truth, truth.row, [0, 2, 4])
    coverage = [
        {"blade": 3 - blade, "share": one.share, **{f"views_{k}": part for k, part in one.by_views.items()}}
        for blade, one in shown.items()
    ]
    right = {
        "status": "estimated",
        "reason": None,
        "axis": (-TURNED.apply([0.0, 0.0, 1.0])).tolist(),
        "point": SHIFT.tolist(),
        "pitch_deg": PITCH_DEG,
        "direction": None,
        "zero_blade": None,
        # About the axis turned round angles fall as the true ones grow: number 3 is the true blade 0.
        "blades": [{"number": n, "seen": n, "angle_deg": PITCH_DEG * n} for n in (1, 2, 3)],
        "coverage": coverage,
    }
    findings = truth.row.findings
    rows = json.loads((folder / "mapping/detections.json").read_text())

    def score(changes: Document) -> Document:
        for line in rows:
            place = (np.array([line[axis] for axis in "xyz"]) - SHIFT)[None] * MM_PER_UNIT
            nearest = min(
                truth.defects.values(), key=lambda one: np.linalg.norm(TURNED.inv().apply(place) - one.center)
            )
            one = findings[nearest.number]
            side = "edge" if one.chord == 0.0 else "convex"
            span = float(truth.row.span(nearest.center[None])[0]) if truth.row else 0.0
            line.update({"blade": str(3 - one.blade), "side": side, "span": span, **changes.get("columns", {})})
        (folder / "mapping/detections.json").write_text(json.dumps(rows))
        (folder / "row.json").write_text(json.dumps({**right, **changes.get("row", {})}))
        found = score_row_of(folder, truth_folder)
        assert found is not None
        return found

    return score


@pytest.mark.parametrize("stagger", [(28.0, 50.0), (12.0, 30.0), (45.0, 60.0)])
@pytest.mark.parametrize("way", [1, -1])
def test_every_point_of_a_true_blade_lies_on_it(stagger: tuple[float, float], way: int) -> None:
    scene = replace(SCENE, stagger_deg=stagger)
    row = TrueRow(pitch_rad(scene), 150.0, 198.0, scene.chord_mm, stagger, {}, way)
    for blade in (0, 7):
        points = _blade(scene, blade, [])[0]
        if way < 0:  # the whole row turned half round about the x axis: angles fall then
            points = points * np.array([1.0, -1.0, -1.0])
        assert set(row.blade(points).tolist()) == {way * blade}
        assert row.span(points).max() == pytest.approx(1.0)


def test_the_true_result_is_the_truth_in_another_frame(made: tuple[Path, Path], truth: Truth) -> None:
    model = load_result(made[1]).models[0]
    centers = TURNED.inv().apply(model.centers - SHIFT) * MM_PER_UNIT
    assert centers == pytest.approx(truth.centers[model.source_indices], abs=1e-6)
    assert model.source_indices == [0, 2, 4]
    assert model.mesh is not None
    vertices = {tuple(one) for one in truth.vertices.round(2)}
    seen = (TURNED.inv().apply(model.mesh.vertices - SHIFT) * MM_PER_UNIT).round(2)
    assert np.mean([tuple(one) in vertices for one in seen]) > 0.95
    assert 1000 < len(model.mesh.faces) < len(truth.faces) / 2


def test_truth_tells_what_all_frames_show_of_every_blade(made: tuple[Path, Path]) -> None:
    rows = json.loads((made[0] / "defects.json").read_text())["coverage"]
    assert [one["blade"] for one in rows] == [0, 1, 2]
    assert max(one["share"] for one in rows) == 1.0
    for one in rows:
        assert 1.0 >= one["views_2"] >= one["views_3"] >= one["views_5"] >= 0.0
    assert max(one["views_2"] for one in rows) > 0.2


def test_a_right_row_is_right_in_everything(scored: Callable[[Document], Document]) -> None:
    found = scored({})
    assert (found["right"], found["blades_in_view"], found["row_expected"]) == (True, 3, True)
    assert found["pitch_error"] == pytest.approx(0.0, abs=1e-9)
    assert found["axis_error_deg"] < 1e-3
    assert found["axis_off_mm"] < 1e-3
    one = found["detections"]
    assert one["count"] > 5
    assert one["blade_right"] == one["side_right"] == one["span_within"] == one["count"]
    assert one["end_right"] == one["end_told"] > 0
    assert found["coverage"]["seen_of_in_view"] == [3, 3]
    assert found["coverage"]["views_within"] == 1.0
    assert dict(_row_rows("0", found))["root or tip right"] == f"{one['end_right']} of {one['end_told']}"


def test_what_is_wrong_is_counted(scored: Callable[[Document], Document]) -> None:
    assert scored({"row": {"pitch_deg": 1.03 * PITCH_DEG}})["right"] is False
    tilted = TURNED.apply([0.0, np.sin(0.05), np.cos(0.05)])
    found = scored({"row": {"axis": tilted.tolist()}})
    assert found["axis_error_deg"] == pytest.approx(np.degrees(0.05), abs=1e-3)
    assert found["right"] is False
    # Numbers that run the other way are no offset.
    ordered = [{"number": n, "seen": n, "angle_deg": -PITCH_DEG * n} for n in (1, 2, 3)]
    one = scored({"row": {"blades": ordered}})["detections"]
    assert 0 < one["blade_right"] < one["count"]
    found = scored({"columns": {"blade": None, "side": "concave", "span": 1.0}})
    one = found["detections"]
    assert "coverage" not in found, "nothing says which number is which blade"
    assert (one["blade_unknown"], one["side_wrong"], one["span_within"]) == (one["count"], one["count"], 0)
    assert scored({"columns": {"side": "unknown"}})["detections"]["side_unknown"] == one["count"]


def test_sizes_are_scored_with_the_row(
    made: tuple[Path, Path], truth: Truth, scored: Callable[[Document], Document]
) -> None:
    path = made[1] / "mapping/defects.json"
    before = path.read_text()
    records = json.loads(before)
    for record in records:
        place = TURNED.inv().apply((np.array(record["centroid"]) - SHIFT)[None] * MM_PER_UNIT)
        near = min(truth.defects.values(), key=lambda one: np.linalg.norm(place - one.center))
        length = near.sizes["length"]
        record |= {"length": 1.1 * length, "length_sigma": 0.06 * length, "length_unit": "mm", "size_from": "box"}
    path.write_text(json.dumps(records))
    found = scored({})
    path.write_text(before)
    errors = found["sizes"]["box"]["length"]
    assert [error for error, _ in errors] == pytest.approx([0.1] * len(records))
    assert all(inside for _, inside in errors)
    lines = dict(_row_rows("0", found))
    assert lines["length by box: error median / 95 %, within 2 sigma, count"] == f"0.1 / 0.1 / 1 / {len(records)}"
    row = result("sizes", "estimated", Expected.ROW, found)
    assert markdown([row]).splitlines()[2].split("|")[-4].strip() == f"box 10 / 10 / 100 % of {len(records)}"
    assert f"length by box: median / 95 % off, inside 2 sigma: 10 / 10 / 100 % of {2 * len(records)}" in totals(
        [row] * 2
    )


def test_a_further_model_is_held_against_the_numbers_of_the_first(
    made: tuple[Path, Path], scored: Callable[[Document], Document], tmp_path: Path
) -> None:
    scored({})
    folder = tmp_path / "result"
    shutil.copytree(made[1], folder)
    further = folder / "models/1"
    further.mkdir(parents=True)
    for name in ("sparse", "dense"):
        shutil.copytree(folder / name, further / name)
    row = json.loads((folder / "row.json").read_text())
    # The same blades, counted from the other end: 1, 2, 3 are 3, 2, 1 of the first model.
    blades = [{"number": n, "seen": n, "angle_deg": -PITCH_DEG * n} for n in (1, 2, 3)]
    laid = {"same_row": True, "reason": None, "offset_from": "turning"}
    rows = json.loads((folder / "mapping/detections.json").read_text())
    for more in (0, 1):
        named = [{**one, "model": 1, "blade": str(int(one["blade"]) + more)} for one in rows]
        (folder / "mapping/detections.json").write_text(json.dumps([*rows, *named]))
        right = more == 0
        on_first = {**laid, "names": {str(n): str(4 - n + more) for n in (1, 2, 3)}}
        (further / "row.json").write_text(json.dumps({**row, "blades": blades, "on_first": on_first}))
        found = score_result(folder, made[0])["rows"]
        assert found["1"]["on_first"] == {**laid, "right": right}
        assert found["0"]["detections"]["blade_right"] == len(rows)
        assert "on_first" not in found["0"]
        line = dict(_row_rows("1", found["1"]))["on the row of the first model; its blades' numbers right"]
        assert line == f"yes; {'yes' if right else 'no'} (by turning)"
        assert found["1"]["detections"]["blade_right"] == len(rows), "up to one offset"


def test_numbers_that_go_round_are_one_offset(scored: Callable[[Document], Document]) -> None:
    round_again = {3: "1", 2: "64", 1: "63"}
    blades = [{"number": int(round_again[n]), "seen": n, "angle_deg": PITCH_DEG * n} for n in (1, 2, 3)]
    row = {"status": "user", "count": [64, 64], "zero_blade": 3, "direction": "as_seen", "blades": blades}
    assert scored({"row": row})["coverage"]["seen_of_in_view"] == [3, 3]


def test_an_unknown_row_has_a_reason_and_no_figures(scored: Callable[[Document], Document]) -> None:
    found = scored({"row": {"status": "unknown", "reason": "no_repetition"}})
    assert (found["status"], found["reason"], found["right"]) == ("unknown", "no_repetition", None)
    assert found["row_expected"] is True
    assert "pitch_error" not in found
    assert dict(_row_rows("0", found))["row of blades, model 0"] == "unknown (no_repetition)"


def test_a_weld_moves_what_the_second_half_of_the_frames_saw(tmp_path: Path) -> None:
    case = Case(replace(SCENE, n_frames=4, n_defects=0), Expected.UNKNOWN, Weld(turn_pitches=0.4, shift_mm=3.0))
    make_true_result(case, tmp_path / "truth", tmp_path / "result")
    welded, true = load_result(tmp_path / "result").models[0], load_truth(tmp_path / "truth").centers
    centers = TURNED.inv().apply(welded.centers - SHIFT) * MM_PER_UNIT
    assert welded.source_indices == [0, 2]
    angle = np.radians(0.4 * PITCH_DEG)
    turn = np.array([[np.cos(angle), -np.sin(angle), 0.0], [np.sin(angle), np.cos(angle), 0.0], [0.0, 0.0, 1.0]])
    assert centers[0] == pytest.approx(true[0], abs=1e-6)
    assert centers[1] == pytest.approx(turn @ true[2] + [0.0, 0.0, 3.0], abs=1e-6)


def result(name: str, status: str, expected: Expected, score: Document | None) -> Document:
    reason = "no_repetition" if status == "unknown" else None
    return {
        "name": name,
        "of": "true surface",
        "status": status,
        "reason": reason,
        "expected": str(expected),
        "seconds": 9.0,
        "score": score,
    }


def test_the_table_shows_in_bold_what_should_have_been_otherwise(scored: Callable[[Document], Document]) -> None:
    right = scored({})
    rows = [
        result("good", "estimated", Expected.ROW, right),
        result("missed", "unknown", Expected.ROW, {"blades_in_view": 4, "right": None}),
        result("off", "estimated", Expected.ROW, {**right, "right": False, "pitch_error": 0.5}),
        result("hub", "unknown", Expected.UNKNOWN, None),
        result("invented", "estimated", Expected.UNKNOWN, None),
    ]
    cells = [line.split("|")[4].strip() for line in markdown(rows).splitlines()[2:]]
    assert cells == [
        "found",
        "**unknown (no_repetition)**",
        "**wrong**",
        "unknown (no_repetition)",
        "**found, should be unknown**",
    ]
    lines = totals(rows)
    assert lines[0] == "row found: 1 of 3 that show one, 1 wrong, 1 unknown"
    assert lines[1] == "unknown where nothing can be known: 1 of 2"


def test_a_result_that_is_no_row_stays_unknown_and_as_it_was(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "indoor"
    (folder / "dense").mkdir(parents=True)
    (folder / "summary.json").write_text("{}")
    write_mesh(folder / "dense/mesh_poisson.ply", Mesh(np.eye(3), np.array([[0, 1, 2]], np.int32)))
    before = sorted(path.name for path in folder.rglob("*"))
    arguments = ["row", str(tmp_path / "out"), "--family", "none", "--unknown", str(folder)]
    assert main(arguments) == 0
    assert "unknown where nothing can be known: 1 of 1" in capsys.readouterr().out
    assert sorted(path.name for path in folder.rglob("*")) == before
    assert len(read_mesh(tmp_path / "out/runs/result-indoor/dense/mesh_poisson.ply").faces) == 1
    kept = Bench(tmp_path / "out").of_result(folder, None)
    assert (kept["reason"], kept["expected"]) == ("no_surface", "unknown")
    assert main(["row", str(tmp_path), "--family", "none", "--unknown", str(tmp_path)]) == 2
    assert main(["row", str(tmp_path), "--only", "nothing"]) == 2
