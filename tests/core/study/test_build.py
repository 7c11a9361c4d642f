"""The folder of a study: what people open, what stays with who evaluates, and results that are no scene."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cli.main import main
from core.errors import BadInput
from core.study.build import ANSWERS, STUDY, build_study
from core.study.questions import QUESTIONS, AnswerKind, is_right, task_id
from core.study.truth import UNKNOWN, Task
from tests.core.making_results import opened
from tests.core.study.making_scenes import OTHERWISE, result_with_blades, write_study


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_study(tmp_path_factory.mktemp("study"), contact="</script>room 7")


def test_right_answers_lie_beside_the_study_and_not_in_it(study: Path) -> None:
    key = json.loads((study / ANSWERS).read_text(encoding="utf-8"))
    assert key["scenes"]["A"]["largest"] == ["D1"]
    assert key["scenes"]["B"] == {
        "count": ["3"],
        "largest": ["D0"],
        "blade": ["1"],
        "best_frame": ["2"],
        "span": ["40"],
        "root_or_tip": ["root"],
        "not_seen": ["2"],
        "same": ["D0"],
    }
    script = (study / STUDY / "study.js").read_text(encoding="ascii")
    assert "<" not in script
    data = json.loads(script.removeprefix("window.STUDY_DATA = ").removesuffix(";\n"))
    assert data["contact"] == "</script>room 7"
    assert [one["id"] for one in data["tasks"]] == [task_id(task) for task in Task]
    assert not any(word in script for word in ('"right"', '"D0"', '"D1"'))
    for scene in "AB":
        folder = study / STUDY / "scenes" / scene
        assert (folder / "gallery" / "index.html").is_file()
        assert (folder / "viewer" / "data.js").read_text(encoding="ascii").endswith("forgets = true;\n")


def test_the_same_scenes_are_the_same_study_and_others_another(study: Path, tmp_path: Path) -> None:
    write_study(tmp_path / "again")
    build_study((tmp_path / "again" / "second", tmp_path / "again" / "first"), tmp_path / "turned")
    ids = [
        json.loads((at / ANSWERS).read_text())["study"] for at in (study, tmp_path / "again/out", tmp_path / "turned")
    ]
    assert ids[0] == ids[1] != ids[2]


def test_what_is_no_scene_is_refused(study: Path, tmp_path: Path) -> None:
    good = result_with_blades(tmp_path / "good")
    several = result_with_blades(tmp_path / "several", "two_models", OTHERWISE)
    with pytest.raises(BadInput, match="several models"):
        build_study((good, several), tmp_path / "out")
    with pytest.raises(BadInput, match="has no finding"):
        build_study((opened("refused", tmp_path / "refused"), good), tmp_path / "out")
    with pytest.raises(BadInput, match="holds a study already"):
        build_study((good, good), study)
    (good / "gallery" / "index.html").unlink()
    with pytest.raises(BadInput, match="has no gallery"):
        build_study((good, good), tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_the_command_says_what_the_scenes_do_not_hold(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    told = result_with_blades(tmp_path / "told")
    bare = opened("one_model", tmp_path / "bare")
    asked = ["study", str(told), str(bare), "--out", str(tmp_path / "out"), "--practice", str(told)]
    assert main(asked) == 0
    said = capsys.readouterr().out
    assert 'note: scene B: its tables do not hold "On which blade are most findings?"' in said
    assert "scene A" not in said
    assert str(tmp_path / "out" / STUDY / "index.html") in said
    assert (tmp_path / "out" / STUDY / "scenes" / "practice" / "viewer" / "index.html").is_file()
    assert main(asked) == 2


@pytest.mark.parametrize(
    ("task", "answer", "right", "expected"),
    [
        (Task.COUNT, "3", {"3"}, True),
        (Task.COUNT, "4", {"3"}, False),
        (Task.COUNT, None, {"3"}, False),
        (Task.SPAN, "70", {"75"}, True),
        (Task.SPAN, "69", {"75"}, False),
        (Task.SPAN, "75", {UNKNOWN}, False),
        (Task.SPAN, None, {UNKNOWN}, True),
        (Task.LARGEST, "D1", {"D1"}, True),
        (Task.LARGEST, "D2", {"D1"}, False),
        (Task.BLADE, "2", {"2", "3"}, True),
        (Task.BLADE, "many", {"2"}, False),
        (Task.BLADE, "nan", {"2"}, False),
        (Task.ROOT_OR_TIP, "tip", {"root"}, False),
    ],
)
def test_answers_are_marked(task: Task, answer: str | None, right: set[str], expected: bool) -> None:
    assert is_right(task, answer, right) == expected


def test_every_task_has_its_question() -> None:
    assert set(QUESTIONS) == set(Task)
    assert QUESTIONS[Task.ROOT_OR_TIP].kind == AnswerKind.END
    assert [task for task in Task if "{box}" in QUESTIONS[task].text] == [Task.SAME]
