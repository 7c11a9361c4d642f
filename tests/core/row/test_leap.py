"""A part that is joined whole pitches off makes a perfect row of blades; the camera's turn tells that it is none."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.io.frames import write_frames
from core.io.sparse import write_model
from core.io.surface import supported_mesh
from core.outputs import FRAMES, QUALITY, ROW, SPARSE, SUMMARY, SURFACE
from core.report.tables import write_csv
from core.row import estimate
from core.row.estimate import describe_row, without_leap
from core.row.files import read_blades, write_blades, write_found
from core.row.model import BladeRow, NoRow, UnknownRow
from core.row.overlap import Hypothesis
from core.row.passing import Leap, leap_within
from core.row.published import write_row
from core.row.turn import Axis
from core.scene.frame import Crop
from core.scene.views import Views
from core.settings import make_settings, only_declared
from core.stage import StageTask
from core.stage_specs import STAGES
from core.stages import blades as blades_stage
from core.surface.ply import write_mesh
from core.videos import APART_S
from tests.core.making_blades import PITCH_RAD, blades, sparse_of, walk
from tests.core.making_rows import run_frames

F64 = NDArray[np.float64]

TRUE = Hypothesis(Axis(np.array([0.0, 0.0, 1.0]), np.zeros(3)), PITCH_RAD)
N_FRAMES, CUT = 30, 17
WALK = walk(N_FRAMES)
"""The camera passes 3 pitches: 0.1 a frame."""
TIMES = {frame: 0.1 * frame for frame in range(N_FRAMES)}


def turn(rate: F64 | float = 0.1, leap: float = 0.0, at: int = CUT) -> dict[int, float]:
    """Turn in every frame at a rate by frame, from frame `at` on so many pitches more."""
    steps = np.broadcast_to(np.asarray(rate, np.float64), N_FRAMES - 1)
    total = np.concatenate([[0.0], np.cumsum(steps)])
    return {k: float(total[k]) + (leap if k >= at else 0.0) for k in range(N_FRAMES)}


def joined_off(pitches: int) -> Views:
    """The walk, its frames from `CUT` on turned by whole pitches about the axis, with what they saw."""
    back = Rotation.from_rotvec([0.0, 0.0, -pitches * PITCH_RAD]).as_matrix()
    late = (np.arange(N_FRAMES) >= CUT)[:, None, None]
    return replace(WALK, R=np.where(late, WALK.R @ back, WALK.R))


@pytest.mark.parametrize("pitches", [-3, -1, 1, 2])
@pytest.mark.parametrize("rate", [0.0, 0.1, -0.3])
def test_a_turn_that_leaps_by_whole_pitches_is_found(pitches: int, rate: float) -> None:
    assert leap_within(turn(rate, pitches), TIMES) == Leap((CUT - 1, CUT), pitches)
    every_second = {frame: value for frame, value in turn(rate / 2, pitches).items() if frame % 2 == 0}
    assert leap_within(every_second, TIMES) == Leap((CUT - 1, CUT + 1), pitches)


def test_two_leaps_do_not_hide_each_other() -> None:
    twice = {frame: value + (frame >= 22) for frame, value in turn(0.1, 1.0, at=10).items()}
    assert leap_within(twice, TIMES) == Leap((9, 10), 1)


def test_a_turn_that_may_be_right_is_no_leap() -> None:
    rng = np.random.default_rng(0)
    assert leap_within(turn(), TIMES) is None
    assert leap_within(turn(0.1 + 0.1 * np.sin(np.arange(N_FRAMES - 1) / 3)), TIMES) is None, "a hand that hesitates"
    assert leap_within(turn(rng.normal(0.1, 0.5, N_FRAMES - 1)), TIMES) is None, "nothing can be foretold"
    assert leap_within(turn(leap=0.6), TIMES) is None, "no whole number: the surface shows it"
    assert leap_within(turn(leap=1.0), TIMES, [(CUT - 1, CUT)]) is None, "there the pictures jump"
    assert leap_within(turn(leap=1.0), TIMES, [(3, 4)]) is not None, "they jump elsewhere"
    videos = {frame: at + (APART_S if frame >= CUT else 0.0) for frame, at in TIMES.items()}
    assert leap_within(turn(leap=1.0), videos) is None, "another video"
    gap = {frame: at + (3.0 if frame >= CUT else 0.0) for frame, at in TIMES.items()}
    assert leap_within(turn(leap=1.0), gap) is None, "a gap in which a blade may pass"
    assert leap_within({0: 0.0, 1: 1.0}, TIMES) is None
    assert leap_within({}, TIMES) is None


@pytest.fixture(scope="module")
def row() -> BladeRow:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(estimate, "FIT_POINTS", 2500)
        found = describe_row(blades(4), WALK, 0, TRUE)
    assert isinstance(found, BladeRow)
    return found


def test_a_row_whose_camera_leaps_is_none_and_is_flagged(row: BladeRow, tmp_path: Path) -> None:
    assert without_leap(row, WALK, TIMES) is row
    none = without_leap(row, joined_off(1), TIMES)
    assert isinstance(none, NoRow)
    assert none == NoRow(UnknownRow.TURN_LEAPS, row.contrast, leap=Leap((CUT - 1, CUT), 1))
    (flag,) = none.flags
    assert (flag.code, flag.value, flag.threshold) == ("row_irregular", 1, 0.5)
    assert flag.where == "between frames 16 and 17, where the camera's turn leaps by 1 of the pitches"
    write_blades(tmp_path, none)
    assert read_blades(tmp_path) == none
    assert none.to_dict()["evidence"] == {
        "contrast": round(row.contrast, 4),
        "leap_pitches": 1,
        "frames": [CUT - 1, CUT],
    }


def test_the_stage_tells_no_row_where_the_camera_leaps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(estimate, "FIT_POINTS", 2500)
    inputs = {name: tmp_path / name for name in ("frames", "extend", "mesh", "row")}
    for name in ("frames", "mesh", "row"):
        inputs[name].mkdir()
    write_frames(inputs["frames"], run_frames(N_FRAMES), Crop(0, 0, 960, 720, 960, 720))
    write_model(inputs["extend"], sparse_of(joined_off(-1)))
    write_mesh(supported_mesh(inputs["mesh"]), blades(4))
    write_found(inputs["row"], TRUE)
    settings = only_declared(make_settings("default", {}), STAGES["blades"].settings)
    (tmp_path / "blades").mkdir()
    found = blades_stage.run(StageTask("blades", {}, settings, inputs, {}, (), tmp_path / "blades"))
    assert (found.n_blades, found.reason) == (0, "turn_leaps")
    assert [flag.code for flag in found.flags] == ["row_irregular"]


@pytest.mark.parametrize("jump", [False, True])
def test_a_published_result_whose_camera_leaps_has_no_row(
    row: BladeRow, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jump: bool
) -> None:
    monkeypatch.setattr("core.row.published.estimate_row", lambda *_: row)
    for name in (SURFACE, QUALITY, SPARSE, FRAMES):
        (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / SPARSE).mkdir()
    write_mesh(tmp_path / SURFACE, blades(4))
    sparse_of(joined_off(1)).write_binary(tmp_path / SPARSE)
    write_csv(tmp_path / FRAMES, ["index", "time_s"], [{"index": k, "time_s": at} for k, at in TIMES.items()])
    flag = {"code": "picture_jumps", "severity": "warning", "where": f"between frames {CUT - 1} and {CUT}"}
    (tmp_path / QUALITY).write_text(json.dumps({"verdict": "ok", "flags": [flag] if jump else []}))
    (tmp_path / SUMMARY).write_text("{}")
    found = write_row(tmp_path)
    assert isinstance(found, BladeRow if jump else NoRow)
    document = json.loads((tmp_path / ROW).read_text())
    assert document["reason"] == (None if jump else "turn_leaps")
    if not jump:
        assert document["evidence"]["frames"] == [CUT - 1, CUT]
        assert "leaps by whole blades" in document["reason_text"]
    codes = [one["code"] for one in json.loads((tmp_path / QUALITY).read_text())["flags"]]
    assert codes == (["picture_jumps"] if jump else ["row_irregular"])
