"""The row of a further model on that of the first: one row or not, and which blade is which, or honestly unknown."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from bench.scenes.blades import surface_point
from cli.main import main
from core.geometry.similarity import Similarity
from core.io.frames import write_frames
from core.io.sparse import write_model
from core.io.surface import supported_mesh
from core.json_files import read_json, write_json
from core.outputs import DEFECTS, DETECTIONS, FRAMES, SUMMARY, SURFACE, model_folder
from core.report.tables import write_csv
from core.row import estimate, on_first
from core.row.estimate import describe_row
from core.row.files import read_blades, read_on_first, write_found
from core.row.model import BladeRow, EdgeName, NoRow, UnknownRow
from core.row.on_first import ModelOfRow, NotOnFirst, OnFirst, of_further, put_on_first
from core.row.overlap import Hypothesis
from core.row.passing import NoOffset, Offset, OffsetFrom, offset_between
from core.row.turn import Axis
from core.scene.frame import Crop
from core.scene.views import Views
from core.settings import make_settings, only_declared
from core.settings.row import RowSettings
from core.stage import StageTask
from core.stage_specs import STAGES
from core.stages import blades as blades_stage
from core.surface.ply import Mesh, write_mesh
from core.task_key import key_of
from core.videos import APART_S
from tests.core.making_blades import PITCH_RAD, SCENE, blades, sparse_of, walk
from tests.core.making_results import opened
from tests.core.making_rows import defect, mapped, run_frames

pytestmark = pytest.mark.slow

F64 = NDArray[np.float64]

TRUE = Hypothesis(Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3)), PITCH_RAD)
ELSEWHERE = Similarity(1 / 37.0, Rotation.from_rotvec([0.7, -1.1, 0.4]).as_matrix(), np.array([0.3, -2.0, 1.1]))
N_FRAMES = 30
WALK = walk(N_FRAMES, 6.0)
"""The camera passes 6 pitches: 0.2 a frame."""
MOMENTS_S = {frame: 0.1 * frame for frame in range(N_FRAMES)}
EARLY, LATE = (0, 1, 2, 3), (3, 4, 5, 6)
"""Blades of the two halves."""


@pytest.fixture(scope="module", autouse=True)
def few_points() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(estimate, "FIT_POINTS", 2500)
        patch.setattr(on_first, "POINTS", 2500)
        yield


def surface(of: tuple[int, ...]) -> Mesh:
    return blades(7, skipped=tuple(set(range(7)) - set(of)))


def part(of: tuple[int, ...], frames: range, told: RowSettings | None = None, pitch: float = 1.0) -> ModelOfRow:
    """A model of some of the blades by some of the frames, mm in the frame of the row."""
    mesh, views = surface(of), seen(frames)
    row = describe_row(mesh, views, 0, Hypothesis(TRUE.axis, TRUE.pitch_rad), told or RowSettings())
    assert isinstance(row, BladeRow)
    if pitch != 1.0:
        row = replace(row, sheet=replace(row.sheet, pitch_rad=pitch * PITCH_RAD))
    return ModelOfRow(row, mesh, views, 0)


def seen(frames: range) -> Views:
    rows = np.array(frames)
    return Views(rows, WALK.R[rows], WALK.t[rows], WALK.camera)


def elsewhere(of: tuple[int, ...], frames: range, turned: bool = False) -> ModelOfRow:
    """The same in a frame and unit of its own, its axis in the other direction where it is turned."""
    mesh, views, found = moved(surface(of), seen(frames), turned)
    row = describe_row(mesh, views, 1, found, RowSettings())
    assert isinstance(row, BladeRow)
    return ModelOfRow(row, mesh, views, 1)


def moved(mesh: Mesh, views: Views, turned: bool = False) -> tuple[Mesh, Views, Hypothesis]:
    R, centers = views.R @ ELSEWHERE.rotation.T, ELSEWHERE.apply(views.centers)
    there = Views(views.frame_index, R, -np.einsum("fij,fj->fi", R, centers), views.camera)
    direction = (-1.0 if turned else 1.0) * ELSEWHERE.rotation @ TRUE.axis.direction
    axis = Axis(direction, ELSEWHERE.apply(TRUE.axis.foot[None])[0])
    return Mesh(ELSEWHERE.apply(mesh.vertices), mesh.faces), there, Hypothesis(axis, PITCH_RAD)


@pytest.fixture(scope="module")
def first() -> ModelOfRow:
    return part(EARLY, range(12))


@pytest.fixture(scope="module")
def second() -> ModelOfRow:
    return elsewhere(LATE, range(14, 30))


def put(first: ModelOfRow, second: ModelOfRow, told: RowSettings | None = None) -> OnFirst:
    return put_on_first(first, second, 1, MOMENTS_S, told or RowSettings())[1]


def test_blades_after_a_gap_go_on_in_the_numbers_of_the_first_model(first: ModelOfRow, second: ModelOfRow) -> None:
    found = put(first, second)
    assert found.names == {1: 4, 2: 5, 3: 6, 4: 7}, "the last blade of the one is the first of the other"
    assert found.laid is not None
    assert found.laid.motion.scale == pytest.approx(37.0, rel=0.02)
    assert found.offset is not None
    assert found.offset.source == OffsetFrom.TURNING
    assert abs(found.offset.off) < 0.15
    document = found.to_dict()
    assert (document["same_row"], document["reason"], document["names"]["4"]) == (True, None, "7")


def test_an_axis_in_the_other_direction_turns_the_indices_and_the_edges(first: ModelOfRow) -> None:
    assert isinstance(first.row, BladeRow)
    known = replace(first.row, edge_a=EdgeName.LEADING)
    row, found = put_on_first(
        replace(first, row=known), elsewhere(LATE, range(14, 30), turned=True), 1, MOMENTS_S, RowSettings()
    )
    assert found.names == {1: 4, 2: 5, 3: 6, 4: 7}
    assert isinstance(row, BladeRow)
    assert row.edge_a == EdgeName.TRAILING, "edge a is the lower one along an axis that points the other way"


def test_frames_of_both_models_tell_without_their_times(first: ModelOfRow) -> None:
    _, found = put_on_first(first, elsewhere(LATE, range(10, 30)), 1, {}, RowSettings())
    assert found.names == {1: 4, 2: 5, 3: 6, 4: 7}
    assert found.offset is not None
    assert found.offset.source == OffsetFrom.SHARED_FRAMES


def test_after_a_long_gap_it_is_one_row_and_no_blade_has_a_number_unless_a_person_tells(first: ModelOfRow) -> None:
    far = elsewhere(LATE, range(19, 30))
    found = put(first, far)
    assert (found.names, found.reason, found.no_offset) == ({}, NotOnFirst.OFFSET_UNKNOWN, NoOffset.TOO_FAR)
    assert found.to_dict()["same_row"] is True
    assert "how many blades lie between is not known" in found.to_dict()["reason_text"]
    told = put(first, far, RowSettings(same_blade="2-B1=1, 1-B2=5"))
    assert told.names == {1: 4, 2: 5, 3: 6, 4: 7}
    assert told.offset is not None
    assert told.offset.source == OffsetFrom.USER
    assert put(first, far, RowSettings(same_blade="1-B9=5")).no_offset == NoOffset.NO_SUCH_BLADE
    assert put(first, far, RowSettings(same_blade="2-B1=1")).no_offset == NoOffset.TOO_FAR


def test_blades_before_number_one_have_a_number_only_where_the_row_is_counted(
    first: ModelOfRow, second: ModelOfRow
) -> None:
    assert put(second, first).names == {4: 1}, "three lie before the first that the late model saw"
    assert isinstance(second.row, BladeRow)
    counted = replace(second.row, count=(64, 64))
    assert put(replace(second, row=counted), first).names == {1: 62, 2: 63, 3: 64, 4: 1}
    back = replace(counted, direction="reversed", numbers={i: 5 - n for i, n in counted.numbers.items()})
    assert put(replace(second, row=back), first).names == {1: 7, 2: 6, 3: 5, 4: 4}


def test_rows_that_are_not_one_stay_apart(first: ModelOfRow, second: ModelOfRow) -> None:
    none = replace(second, row=NoRow(UnknownRow.NO_REPETITION))
    assert put(first, none).reason == NotOnFirst.NO_ROW
    assert put(none, second).reason == NotOnFirst.NO_ROW
    assert put(part(EARLY, range(12), pitch=1.15), second).reason == NotOnFirst.PITCH_DIFFERS
    flat = second.mesh.vertices - ELSEWHERE.shift
    squeezed = replace(second.mesh, vertices=flat * (0.4, 1.0, 1.0) + ELSEWHERE.shift)
    assert put(first, replace(second, mesh=squeezed)).reason in (NotOnFirst.SHAPE_DIFFERS, NotOnFirst.AXIS_DIFFERS)


def turns(rate: F64, hidden: int = 0) -> tuple[dict[int, float], dict[int, float]]:
    """Turn in frames 0 to 19 and 23 to 39 at a rate by frame, that of the second model less so many pitches."""
    turn = np.concatenate([[0.0], np.cumsum(rate)])
    return {k: turn[k] for k in range(20)}, {k: turn[k] - hidden for k in range(23, 40)}


TIMES = {k: 0.1 * k for k in range(60)}


@pytest.mark.parametrize("hidden", [-2, 0, 5])
def test_a_steady_turn_is_carried_over_a_gap(hidden: int) -> None:
    early, late = turns(np.full(39, 0.15), hidden)
    found = offset_between(early, late, TIMES)
    assert isinstance(found, Offset)
    assert (found.pitches, found.source) == (hidden, OffsetFrom.TURNING)
    back = offset_between(late, early, TIMES)
    assert isinstance(back, Offset)
    assert back.pitches == -hidden


def test_what_cannot_be_foretold_is_unknown() -> None:
    rng = np.random.default_rng(0)
    assert offset_between(*turns(rng.normal(0.15, 0.25, 39)), TIMES) == NoOffset.NOT_STEADY
    assert offset_between(*turns(np.full(39, 0.6)), TIMES) == NoOffset.TOO_FAR, "two blades pass in the gap"
    early, late = turns(np.full(39, 0.15))
    between = {frame: turn + 0.5 for frame, turn in late.items()}
    assert offset_between(early, between, TIMES) == NoOffset.NOT_STEADY, "half way between two whole numbers"
    videos = {k: TIMES[k] + (APART_S if k > 20 else 0.0) for k in TIMES}
    assert offset_between(early, late, videos) == NoOffset.TOO_FAR, "another video"
    assert offset_between(early, {}, TIMES) == NoOffset.NOT_NEXT
    assert offset_between(early, late, TIMES, [(20, 21)]) == NoOffset.JUMP
    assert isinstance(offset_between(early, late, TIMES, [(3, 4), (30, 31)]), Offset), "jumps inside a model"
    # Of three runs of frames the last is of the first model again, a blade farther on than the other gap says.
    again = early | {k: 0.15 * k + 1.0 for k in range(43, 60)}
    assert offset_between(again, late, TIMES) == NoOffset.DISAGREES


@pytest.mark.parametrize("text", ["4=2", "0-B4=2", "1-B4=2, 1-B5=3", "1-B4=2;2-B1=1", "1-B4"])
def test_what_is_no_pair_of_blades_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"does not read like|is enough"):
        RowSettings(same_blade=text)


def test_numbers_and_edges_that_are_told_are_those_of_the_first_model() -> None:
    told = of_further(RowSettings(count=64, zero_blade=3, direction="reversed", edge_a="leading"))
    assert (told.count, told.zero_blade, told.direction, told.edge_a) == (64, None, "as_seen", None)


def test_the_stage_of_a_further_model_puts_it_on_the_first_one(tmp_path: Path) -> None:
    told = make_settings("default", {"row.edge_a": "leading", "row.same_blade": "1-B2=6"})
    settings = only_declared(told, STAGES["blades"].settings)
    (tmp_path / "frames").mkdir()
    write_frames(tmp_path / "frames", run_frames(N_FRAMES), Crop(0, 0, 960, 720, 960, 720))
    mesh, views, found = moved(surface(LATE), seen(range(14, 30)))
    parts = {0: (surface(EARLY), seen(range(12)), TRUE), 1: (mesh, views, found)}
    inputs = {"frames": tmp_path / "frames"}
    for number, (own, cameras, hypothesis) in parts.items():
        inputs |= {key_of(stage, number): tmp_path / key_of(stage, number) for stage in ("extend", "mesh", "row")}
        for stage in ("mesh", "row"):
            (tmp_path / key_of(stage, number)).mkdir()
        write_model(tmp_path / key_of("extend", number), sparse_of(cameras))
        write_mesh(supported_mesh(tmp_path / key_of("mesh", number)), own)
        write_found(tmp_path / key_of("row", number), hypothesis)
        key = key_of("blades", number)
        (tmp_path / key).mkdir()
        task = StageTask(key, {"piece": number} if number else {}, settings, dict(inputs), {}, (), tmp_path / key)
        assert blades_stage.run(task).n_blades == 4
        inputs[key] = tmp_path / key
    assert read_on_first(tmp_path / "blades") is None
    on_first_row = read_on_first(tmp_path / "blades@1")
    assert on_first_row is not None
    assert on_first_row["names"] == {"1": "5", "2": "6", "3": "7", "4": "8"}, "what is told goes before the turn"
    further = read_blades(tmp_path / "blades@1")
    assert isinstance(further, BladeRow)
    assert sorted(further.numbers.values()) == [1, 2, 3, 4], "its own numbers, in order of first appearance"
    assert further.edge_a != EdgeName.UNKNOWN


def test_the_tables_name_the_blades_of_both_models_by_the_first_ones_numbers(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    first: ModelOfRow,
    second: ModelOfRow,
) -> None:
    parts = [(surface(EARLY), first), (moved(surface(LATE), seen(range(14, 30)))[0], second)]
    known = iter([first.row, second.row])
    # The search takes many seconds; what follows from the two rows is asked here.
    monkeypatch.setattr("core.row.published.estimate_row", lambda *_: next(known))
    folder = tmp_path / "result"
    rows, records = [], []
    for number, (mesh, model) in enumerate(parts):
        below = model_folder(folder, number)
        for name in ("dense", "sparse"):
            (below / name).mkdir(parents=True)
        write_mesh(below / SURFACE, mesh)
        sparse_of(model.views).write_binary(below / "sparse")
        of_last = np.array([surface_point(SCENE, 3, 0.5, 0.3, 1)])
        x, y, z = (ELSEWHERE.apply(of_last) if number else of_last)[0].tolist()
        rows.append(replace(mapped(number, (x, y, z)), model=number).to_dict())
        records.append(defect(number, model=number, centroid=(x, y, z)).to_dict())
    (folder / "mapping").mkdir()
    write_json(folder / DETECTIONS, rows)
    write_json(folder / DEFECTS, records)
    write_json(folder / SUMMARY, {})
    write_csv(folder / FRAMES, ["index", "time_s"], [{"index": k, "time_s": MOMENTS_S[k]} for k in MOMENTS_S])
    assert main(["row", str(folder)]) == 0
    last = capsys.readouterr().out.splitlines()[-1]
    assert last == "model 1: on the row of the first model, by turning; of its blades 1 is 4, 2 is 5, 3 is 6, 4 is 7"
    assert [row["blade"] for row in read_json(folder / DETECTIONS)] == ["4", "4"], "one blade, seen by both"
    assert [record["blade"] for record in read_json(folder / DEFECTS)] == ["4", "4"]
    further = read_json(folder / "models" / "1" / "row.json")
    assert further["findings"][0]["blade"] == 1, "the model's own number"
    assert further["on_first"]["offset_from"] == "turning"
    jump = {"code": "picture_jumps", "severity": "warning", "where": "between frames 12 and 13"}
    write_json(folder / "quality.json", {"verdict": "suspect", "flags": [jump]})
    known = iter([first.row, second.row])
    assert main(["row", str(folder)]) == 0
    assert "the pictures jump between them" in capsys.readouterr().out
    assert [row["blade"] for row in read_json(folder / DETECTIONS)] == ["4", "1-B1"]


def test_two_models_of_what_is_no_row_say_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = opened("two_models", tmp_path / "result")
    assert main(["row", str(folder)]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "model 1: the row of one of the two models is unknown"
    further = read_json(folder / "models" / "1" / "row.json")
    assert (further["status"], further["on_first"]["reason"]) == ("unknown", "no_row")
    assert further["on_first"]["names"] == {}
    assert "on_first" not in read_json(folder / "row.json")
