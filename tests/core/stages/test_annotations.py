"""Stage `annotations` on real files: what it says of the time keys reaches the verdict."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.report.build import build_report
from core.settings import make_settings
from core.stage import StageTask
from core.stages import annotations as annotations_stage
from core.stages import probe
from tests.core.making_record import full_record
from tests.inputs import INPUTS

VIDEO = INPUTS / "m96.avi"


@pytest.fixture(scope="module")
def probed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("probe")
    probe.run(StageTask("probe", {}, make_settings(), {}, {}, VIDEO, None, out))
    return out


def quality_after(probed: Path, out: Path, convention: str) -> dict[str, Any]:
    """`quality.json` of a sound run whose annotations stage read these keys."""
    settings = make_settings(options={"input.time_convention": convention})
    file = INPUTS / "frames_few.json"
    facts = annotations_stage.run(StageTask("annotations", {}, settings, {"probe": probed}, {}, VIDEO, file, out)).facts
    record = full_record()
    tasks = [replace(task, facts=facts) if task.key == "annotations" else task for task in record.tasks]
    return build_report(replace(record, tasks=tasks)).quality


def test_keys_that_can_be_read_in_two_ways_make_a_result_suspect(probed: Path, tmp_path: Path) -> None:
    quality = quality_after(probed, tmp_path, "auto")
    flags = [flag for flag in quality["flags"] if flag["code"] == "annotation_times_ambiguous"]
    assert [flag["severity"] for flag in flags] == ["warning"]
    assert quality["verdict"] == "suspect"
    assert quality["time_convention"]["rivals"] == ["index"]
    assert quality["time_convention"]["last"] == {"key": "7", "source_index": 84, "time_s": 7.0}


def test_a_reading_that_is_told_leaves_no_doubt(probed: Path, tmp_path: Path) -> None:
    quality = quality_after(probed, tmp_path, "index")
    assert not [flag for flag in quality["flags"] if flag["code"].startswith("annotation_times")]
    assert (quality["time_convention"]["clock"], quality["time_convention"]["forced"]) == ("index", True)
    assert quality["time_convention"]["last"] == {"key": "7", "source_index": 7, "time_s": pytest.approx(7 / 12)}
