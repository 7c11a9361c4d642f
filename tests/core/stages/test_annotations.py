"""Stage `annotations` on real files: what it says of the time keys reaches the verdict."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from core.errors import BadInput
from core.report.build import build_report
from core.settings import make_settings
from core.stage import StageTask
from core.stages import annotations as annotations_stage
from core.stages import probe
from core.videos import Recording
from tests.core.making_record import full_record
from tests.inputs import INPUTS

VIDEO = INPUTS / "m96.avi"


@pytest.fixture(scope="module")
def probed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("probe")
    probe.run(StageTask("probe", {}, make_settings(), {}, {}, (Recording(VIDEO),), out))
    return out


def quality_after(probed: Path, out: Path, convention: str) -> dict[str, Any]:
    """`quality.json` of a sound run whose annotations stage read these keys."""
    settings = make_settings(options={"input.time_convention": convention})
    file = INPUTS / "frames_few.json"
    facts = annotations_stage.run(
        StageTask("annotations", {}, settings, {"probe": probed}, {}, (Recording(VIDEO, file),), out)
    ).facts
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


FOREIGN = INPUTS / "foreign"


def test_a_file_of_another_tool_is_put_on_frames_and_what_is_not_read_reaches_the_result(
    probed: Path, tmp_path: Path
) -> None:
    """The frames of m96.avi have a third of the pictures' width and height, so their shape."""
    settings = make_settings(options={"input.annotation_format": "labelme"})
    file = FOREIGN / "tools" / "labelme_frame_0003.json"
    facts = annotations_stage.run(
        StageTask("annotations", {}, settings, {"probe": probed}, {}, (Recording(VIDEO, file),), tmp_path)
    ).facts
    rows = json.loads((tmp_path / "detections.json").read_text())
    assert [row["source_index"] for row in rows] == [3, 3]
    assert rows[0]["box"] == pytest.approx([438 / 960, 336 / 720, 479 / 960, 377 / 720])
    assert (facts["format"], facts["n_detections"]) == ("labelme", 2)
    flags = {flag["code"]: flag for flag in facts["flags"]}
    assert flags["annotations_partly_read"]["where"] == "1 circle is not read"
    assert flags["annotations_partly_read"]["severity"] == "info"


def test_the_size_of_the_pictures_is_held_against_the_video(probed: Path, tmp_path: Path) -> None:
    document = json.loads((FOREIGN / "labelme.json").read_text())
    file = tmp_path / "other.json"
    file.write_text(json.dumps({**document, "imageHeight": 540}))
    task = StageTask("annotations", {}, make_settings(), {"probe": probed}, {}, (Recording(VIDEO, file),), tmp_path)
    with pytest.raises(BadInput, match=r"960x540 .* have 320x240"):
        annotations_stage.run(task)


def test_facts_count_keys_frames_and_what_lies_beyond_the_film(probed: Path, tmp_path: Path) -> None:
    """Of twenty-one keys the last is later than the film ends."""
    entry = {"detections": [{"bbox": [0.1, 0.1, 0.2, 0.2], "label": "dent"}]}
    file = tmp_path / "late.json"
    file.write_text(json.dumps({f"{0.25 * k:.2f}": entry for k in range(20)} | {"99.00": entry}))
    task = StageTask("annotations", {}, make_settings(), {"probe": probed}, {}, (Recording(VIDEO, file),), tmp_path)
    facts = annotations_stage.run(task).facts
    assert (facts["n_keys"], facts["n_detections"], facts["n_without_frame"]) == (21, 21, 1)
    assert facts["labels"] == {"dent": 21}


def test_annotations_of_another_film_say_so(probed: Path, tmp_path: Path) -> None:
    file = tmp_path / "other.json"
    file.write_text(json.dumps({f"{90 + k}.50": {} for k in range(4)}))
    task = StageTask("annotations", {}, make_settings(), {"probe": probed}, {}, (Recording(VIDEO, file),), tmp_path)
    with pytest.raises(BadInput, match="belong to another video: 4 of 4 time keys") as caught:
        annotations_stage.run(task)
    assert (caught.value.code, caught.value.where) == ("annotations_beyond_video", '"90.50"')
