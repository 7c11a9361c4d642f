"""The command as a user meets it: exit codes and one clear line."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest

from cli import exits
from cli.main import main
from core.errors import BadInput, Cancelled, DiskFull, NoReconstruction, StageFailed
from core.settings import option_names
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[2]
VIDEO = str(ROOT / "samples" / "turbine.mp4")
ANNOTATIONS = str(ROOT / "samples" / "turbine.json")


def call(*words: str, expect: int, capsys: pytest.CaptureFixture[str]) -> str:
    """Standard output of the command after checking its exit code; errors must be one line."""
    code = main(words)
    captured = capsys.readouterr()
    assert code == expect, captured.err
    if expect == exits.BAD_INPUT:
        assert captured.err.count("\n") == 1
        assert captured.err.startswith("bladeatlas: ")
        return captured.err
    return captured.out


@pytest.mark.parametrize(
    ("words", "part"),
    [
        ([str(ROOT / "README.md")], "'README.md' is not a video"),
        ([str(ROOT / "missing.mp4")], "'missing.mp4' does not exist"),
        ([str(ROOT)], "is a directory"),
        ([VIDEO, str(ROOT / "README.md")], "text of another kind, no JSON and no XML"),
        ([VIDEO, str(ROOT / "missing.json")], "'missing.json' does not exist"),
        ([VIDEO, ANNOTATIONS, "--set", "matching.windw=3"], "did you mean 'matching.window'"),
        ([VIDEO, ANNOTATIONS, "--set", "matching.window=-1"], "matching.window"),
        ([VIDEO, ANNOTATIONS, "--set", "roi.x1=0.01"], "is empty"),
        ([VIDEO, ANNOTATIONS, "--roi", "0.5,0,0.5,1"], "empty or outside"),
        ([VIDEO, ANNOTATIONS, "--preset", "fast"], "unknown preset 'fast'"),
        ([VIDEO, ANNOTATIONS, "--from", "meshing"], "unknown stage 'meshing'"),
        ([VIDEO, ANNOTATIONS, "--workers", "0"], "at least 1"),
        ([VIDEO, ANNOTATIONS, "--parameters", str(ROOT / "README.md")], "not valid JSON"),
    ],
)
def test_bad_input_of_run(tmp_path: Path, capsys: pytest.CaptureFixture[str], words: list[str], part: str) -> None:
    out = tmp_path / "out"
    assert part in call("run", *words, "--out", str(out), expect=exits.BAD_INPUT, capsys=capsys)
    assert not out.exists(), "bad input leaves nothing behind"


def test_wrong_box_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "a.json"
    file.write_text(json.dumps({"0.5": {"detections": [{"label": "dent", "bbox": [0.5, 0.5, 0.4, 0.6], "score": 1}]}}))
    line = call("run", VIDEO, str(file), "--out", str(tmp_path / "o"), expect=exits.BAD_INPUT, capsys=capsys)
    assert "0.5" in line
    assert "bbox" in line
    assert line == call("check", str(file), expect=exits.BAD_INPUT, capsys=capsys)


def test_usage_errors_are_bad_input() -> None:
    for words in (["run", VIDEO], ["inspect"], [], ["run", VIDEO, "--out", "o", "--seed", "x"]):
        with pytest.raises(SystemExit) as stopped:
            main(words)
        assert stopped.value.code == exits.BAD_INPUT


def test_probe(capsys: pytest.CaptureFixture[str]) -> None:
    text = call("probe", VIDEO, expect=exits.DONE, capsys=capsys)
    assert "960x720, h264, 96 frames" in text
    assert "constant rate" in text
    data = json.loads(call("probe", VIDEO, "--json", expect=exits.DONE, capsys=capsys))
    assert (data["schema_version"], data["n_frames"], data["average_rate"]) == (1, 96, "12/1")
    assert data["max_step_s"] == pytest.approx(1 / 12, abs=1e-3)


def test_check(capsys: pytest.CaptureFixture[str]) -> None:
    text = call("check", ANNOTATIONS, VIDEO, expect=exits.DONE, capsys=capsys)
    assert "90 detections at 67 of 96 times" in text
    assert "67 frames with detections, 0 times outside" in text
    data = json.loads(call("check", ANNOTATIONS, "--json", expect=exits.DONE, capsys=capsys))
    assert data["n_detections"] == sum(data["detections_by_label"].values()) == 90
    assert data["n_annotated_frames"] is None
    assert data["time_convention"] is None


def test_check_says_how_the_times_were_read(capsys: pytest.CaptureFixture[str]) -> None:
    text = call("check", ANNOTATIONS, VIDEO, expect=exits.DONE, capsys=capsys)
    assert "time keys: pts, rounding nearest, at most 0.000033 s off; 96 frames hit, 0 keys miss every frame" in text
    assert 'first "0.0000" = frame 0 at 0.0000 s, last "7.9167" = frame 95 at 7.9167 s' in text
    assert "other readings that fit: none" in text
    assert "warning" not in text


def test_check_warns_of_times_that_can_be_read_in_two_ways(capsys: pytest.CaptureFixture[str]) -> None:
    words = ("check", str(INPUTS / "frames_few.json"), str(INPUTS / "m96.avi"))
    text = call(*words, expect=exits.DONE, capsys=capsys)
    assert "warning: the time keys fit 2 readings" in text
    assert "input.time_convention" in text
    data = json.loads(call(*words, "--json", expect=exits.DONE, capsys=capsys))
    assert (data["time_convention"]["clock"], data["time_convention"]["rivals"]) == ("pts", ["index"])
    assert data["time_convention"]["last"] == {"key": "7", "source_index": 84, "time_s": 7.0}
    told = call(*words, "--set", "input.time_convention=index", expect=exits.DONE, capsys=capsys)
    assert "time keys: index, as told" in told
    assert 'last "7" = frame 7 at 0.5833 s' in told
    assert "times: 0.0000 to 0.5833 s" in told
    assert "keys are frame numbers from 0" in told
    assert "warning" not in told


@pytest.mark.parametrize("assignment", ["input.time_convention=sidereal", "frames.count=3", "input.time_convention"])
def test_check_refuses_what_says_nothing_about_the_input(assignment: str, capsys: pytest.CaptureFixture[str]) -> None:
    line = call("check", ANNOTATIONS, "--set", assignment, expect=exits.BAD_INPUT, capsys=capsys)
    assert assignment.split("=")[0] in line


def test_options_list_every_setting(capsys: pytest.CaptureFixture[str]) -> None:
    lines = call("options", expect=exits.DONE, capsys=capsys).splitlines()
    assert [line.split(" = ")[0] for line in lines] == list(option_names())
    window = next(line for line in lines if line.startswith("matching.window ="))
    for part in ("5 frames", "integer >= 1", "following frames", "[thesis]"):
        assert part in window
    data = json.loads(call("options", "--preset", "draft", "--json", expect=exits.DONE, capsys=capsys))
    by_name = {option["name"]: option for option in data["options"]}
    assert by_name["windows.mode"]["value"] == "single"
    assert by_name["windows.mode"]["default"] == "search"
    assert "unknown preset" in call("options", "--preset", "x", expect=exits.BAD_INPUT, capsys=capsys)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    data = json.loads(call("version", "--json", expect=exits.DONE, capsys=capsys))
    assert {"bladeatlas", "pycolmap", "torch"} <= set(data["versions"])


@pytest.mark.parametrize(
    ("error", "code"),
    [
        (BadInput("x"), 2),
        (NoReconstruction("x"), 3),
        (Cancelled("x"), 130),
        (DiskFull("x"), 1),
        (StageFailed("x"), 1),
    ],
)
def test_exit_codes(error: Exception, code: int) -> None:
    assert exits.exit_code(error) == code  # type: ignore[arg-type]


def test_one_line_names_the_place_once() -> None:
    assert exits.one_line(BadInput("bad box", where="a.json")) == "a.json: bad box"
    assert exits.one_line(BadInput("bad box in a.json", where="a.json")) == "bad box in a.json"


def installed(*words: str, stdout: int | None = subprocess.PIPE) -> subprocess.Popen[str]:
    command: Sequence[str] = [sys.executable, "-m", "cli.main", *words]
    return subprocess.Popen(command, cwd=ROOT, stdout=stdout, stderr=subprocess.PIPE, text=True, env=os.environ)


def test_help_loads_no_vision_library() -> None:
    code = (
        "import sys\nfrom cli.main import main\ntry:\n    main(['run', '--help'])\nexcept SystemExit:\n    pass\n"
        "print([n for n in ('torch', 'pycolmap', 'open3d', 'cv2', 'av') if n in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "[]"
    assert "exit codes: 0 done" in done.stdout


def test_a_reader_that_goes_away_is_no_error() -> None:
    process = installed("options", "--json")
    assert process.stdout is not None
    process.stdout.close()
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 0
    assert errors == ""
