"""From the command line to settings."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import pytest

from cli import arguments, parameters
from core.errors import BadInput
from core.geometry.lens import LensModel
from core.settings import PRESET_NAMES, make_settings, option_names
from core.settings.describe import describe_options
from tests.inputs import INPUTS


def parse(*words: str) -> argparse.Namespace:
    return arguments.parser().parse_args(["run", "v.mp4", "a.json", "--out", "o", *words])


def test_nothing_given_is_the_default_preset() -> None:
    assert parameters.from_arguments(parse()).settings() == make_settings()


def test_command_line_wins_over_the_file(tmp_path: Path) -> None:
    file = tmp_path / "p.json"
    options = {"matching.window": 7, "seed": 3, "camera.fov_starts_deg": [50, 60]}
    file.write_text(json.dumps({"preset": "draft", "options": options, "label": "row 3", "external_id": "X-1"}))
    wanted = parameters.from_arguments(
        parse("--parameters", str(file), "--set", "matching.window=9", "--seed", "5", "--set", "frames.clip_end_s=null")
    )
    settings = wanted.settings()
    assert (settings.preset, settings.matching.window, settings.seed) == ("draft", 9, 5)
    assert settings.camera.fov_starts_deg == (50.0, 60.0)
    assert (wanted.label, wanted.external_id) == ("row 3", "X-1")
    assert parameters.from_arguments(parse("--parameters", str(file), "--preset", "thesis")).preset == "thesis"


def test_roi_and_truncated() -> None:
    settings = parameters.from_arguments(parse("--roi", "full", "--allow-truncated")).settings()
    assert settings.roi.model_dump() == {"x0": 0, "y0": 0, "x1": 1, "y1": 1}
    assert settings.input.allow_truncated
    roi = parameters.parse_roi("0.1,0.2,0.8,0.9")
    assert roi == {"roi.x0": 0.1, "roi.y0": 0.2, "roi.x1": 0.8, "roi.y1": 0.9}


def test_a_calibration_counts_before_the_file_of_parameters_and_after_what_is_set_by_name(tmp_path: Path) -> None:
    lens, file = tmp_path / "cameras.txt", tmp_path / "p.json"
    lens.write_text("1 SIMPLE_RADIAL 480 360 260 240 180 -0.1\n")
    file.write_text(json.dumps({"options": {"camera.model": "SIMPLE_RADIAL", "matching.window": 7}}))
    given = ("--parameters", str(file), "--calibration", str(lens), "--set", "mapper.refine_lens=true")
    settings = parameters.from_arguments(parse(*given)).settings()
    assert settings.camera.model == LensModel.OPENCV
    assert settings.camera.size_px == (480, 360)
    assert settings.camera.params == pytest.approx((260, 260, 240, 180, -0.1, 0, 0, 0))
    assert (settings.matching.window, settings.mapper.refine_lens) == (7, True)


@pytest.mark.parametrize("text", ["", "1", "0,0,1", "a,b,c,d", "0.5,0,0.5,1", "0,0.9,1,0.1", "-0.1,0,1,1", "0,0,1,1.2"])
def test_roi_that_cannot_be(text: str) -> None:
    with pytest.raises(BadInput, match=r"neither|empty or outside"):
        parameters.parse_roi(text)


@pytest.mark.parametrize("text", ["nan,0,1,1", "0,0,inf,1"])
def test_roi_of_no_numbers(text: str) -> None:
    with pytest.raises(BadInput):
        parameters.parse_roi(text)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("a.b=1", ("a.b", 1)),
        ("a.b=0.5", ("a.b", 0.5)),
        ("a.b=true", ("a.b", True)),
        ("a.b=null", ("a.b", None)),
        ("a.b=[40, 55]", ("a.b", [40, 55])),
        ("a.b=disk", ("a.b", "disk")),
        ("a.b=x=y", ("a.b", "x=y")),
    ],
)
def test_assignments(text: str, expected: tuple[str, Any]) -> None:
    assert parameters.parse_assignment(text) == expected


@pytest.mark.parametrize(
    ("words", "part"),
    [
        (["--set", "matching.windw=3"], "did you mean 'matching.window'"),
        (["--set", "matching=3"], "unknown option 'matching'"),
        (["--set", "preset=draft"], "unknown option 'preset'"),
        (["--set", "matching.window"], "not NAME=VALUE"),
        (["--set", "=3"], "not NAME=VALUE"),
        (["--set", "matching.window=0"], "greater than or equal to 1"),
        (["--set", "matching.window=many"], "integer"),
        (["--set", "mapping.time_tolerance_s=NaN"], "finite"),
        (["--set", "features.method=orb"], "disk"),
        (["--preset", "fast"], "unknown preset 'fast'"),
        (["--seed", "-1"], "seed"),
    ],
)
def test_refused_options(words: list[str], part: str) -> None:
    with pytest.raises(BadInput, match=part):
        parameters.from_arguments(parse(*words)).settings()


@pytest.mark.parametrize(
    ("text", "part"),
    [
        ("{", "not valid JSON"),
        ("[]", "object"),
        ('{"option": {}}', "unknown key 'option'"),
        ('{"options": []}', "'options'"),
        ('{"preset": 3}', "'preset' must be a text"),
        ('{"options": {"seed": NaN}}', "not a finite number"),
        ('{"options": {"seeed": 1}}', "did you mean 'seed'"),
        ("[" * 100_000, "not valid JSON"),
        ('"' + "x" * (1 << 20) + '"', "larger than 1 MiB"),
    ],
)
def test_refused_parameter_files(tmp_path: Path, text: str, part: str) -> None:
    file = tmp_path / "p.json"
    file.write_text(text)
    with pytest.raises(BadInput, match=part):
        parameters.read_parameters(file).settings()


def test_a_parameter_file_may_begin_with_a_byte_order_mark() -> None:
    file = INPUTS / "param_bom.json"
    assert file.read_bytes().startswith(b"\xef\xbb\xbf")
    assert parameters.read_parameters(file).preset == "draft"


def test_missing_parameter_file(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="No such file"):
        parameters.read_parameters(tmp_path / "none.json")


def test_every_option_can_be_set_to_its_own_default() -> None:
    for name, value in ((option.name, option.default) for option in describe_options()):
        parsed = parameters.from_arguments(parse("--set", f"{name}={json.dumps(value)}")).settings()
        assert parsed.overrides == (name,)


def test_descriptions_cover_every_option_and_preset() -> None:
    described = {option.name: option for option in describe_options()}
    assert list(described) == list(option_names())
    assert all(option.meaning and option.source and option.range for option in described.values())
    assert described["matching.method"].range == "mutual_nearest|lightglue|auto"
    assert described["matching.window"].range == "integer >= 1"
    assert described["camera.fov_deg"].range == "number > 5 < 220 or null"
    for preset in PRESET_NAMES:
        settings = make_settings(preset).model_dump(mode="json")
        group, leaf = "frames", "count"
        assert described["frames.count"].value(preset) == settings[group][leaf]


def test_metadata_of_the_file_is_names_and_texts(tmp_path: Path) -> None:
    file = tmp_path / "p.json"
    file.write_text(json.dumps({"metadata": {"engine_serial": "V1", "inspector": ""}}))
    assert parameters.read_parameters(file).metadata == {"engine_serial": "V1"}
    for wrong in (["a"], {"A": "x"}, {"a\n": "x"}, {"a": 1}, {"a": "x" * 257}, {f"n{i}": "x" for i in range(33)}):
        file.write_text(json.dumps({"metadata": wrong}))
        with pytest.raises(BadInput, match="metadata"):
            parameters.read_parameters(file)
