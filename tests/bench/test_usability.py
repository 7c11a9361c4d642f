"""The keystroke-level model, the right answers, and the page that gives all of them in time."""

from __future__ import annotations

from pathlib import Path

import pytest

from bench.usability.command import BROWSER, Outcome, measure, table
from bench.usability.instruments import found, least_seen
from bench.usability.klm import Hand
from core.errors import BadInput
from core.study.truth import UNKNOWN, Task, answers
from tests.core.making_results import opened
from tests.core.study.making_scenes import result_with_blades

pytestmark = pytest.mark.slow

LONGEST_S = {Task.COUNT: 3.0}
"""Of model time; every other question has five seconds."""


def test_times_are_those_of_the_model() -> None:
    hand = Hand()
    hand.point_and_press()
    hand.look()
    hand.press_key()
    hand.press_key()
    hand.point_and_press()
    assert "".join(hand.done) == "PKMHKKHPK"
    assert hand.seconds == pytest.approx(2 * 1.10 + 4 * 0.20 + 2 * 0.40 + 1.35)


def test_right_answers_come_from_the_tables(tmp_path: Path) -> None:
    right = answers(result_with_blades(tmp_path / "result", "two_models"))
    assert {task: sorted(right[task]) for task in Task} == {
        Task.COUNT: ["3"],
        Task.LARGEST: ["D1"],
        Task.BLADE: ["2"],
        Task.BEST_FRAME: ["0"],
        Task.SPAN: ["75"],
        Task.ROOT_OR_TIP: ["tip"],
        Task.NOT_SEEN: ["2"],
        Task.SAME: ["D0"],
    }


def test_what_the_tables_do_not_know_is_unknown(tmp_path: Path) -> None:
    right = answers(opened("two_models", tmp_path / "result"))
    unknown = {Task.BLADE, Task.SPAN, Task.ROOT_OR_TIP, Task.NOT_SEEN}
    assert {task for task in Task if right[task] == {UNKNOWN}} == unknown
    with pytest.raises(BadInput, match="has no finding to ask about"):
        answers(opened("refused", tmp_path / "refused"))
    with pytest.raises(BadInput, match="is it a finished result"):
        answers(tmp_path)


def test_a_table_says_what_is_wrong_and_what_is_not_answered() -> None:
    said = [("1", True), ("D2", False), (None, False), (None, True)]
    outcomes = [Outcome(task, "viewer", *said[number % 4], "PK", 1.3) for number, task in enumerate(Task)]
    lines = table(outcomes)
    assert lines[0] == "| question | viewer |"
    assert [line.split(" | ")[1].removesuffix(" |") for line in lines[2:6]] == [
        "1, right, 1.3 s (PK)",
        "D2, WRONG, 1.3 s (PK)",
        "not answered",
        "nothing to say",
    ]


def test_answers_are_read_off_what_is_shown() -> None:
    assert found(r"(D\d+)", "the finding D12 of") == "D12"
    assert found(r"(D\d+)", "nothing") is None
    assert least_seen("44 % of blade 1, 60 % of blade 2, 60 % of blade 3") == "2"
    assert least_seen("all is seen") is None


@pytest.mark.browser
@pytest.mark.tool(BROWSER)
def test_the_page_answers_every_question_rightly_and_in_time(tmp_path: Path) -> None:
    pytest.importorskip("playwright")
    outcomes = measure(result_with_blades(tmp_path / "result", "two_models"))
    own = {one.task: one for one in outcomes if one.instrument == "viewer"}
    assert {task: one.answer for task, one in own.items() if not one.right} == {}
    for task, one in own.items():
        assert one.seconds <= LONGEST_S.get(task, 5.0), (task, one.operators)
    report = {one.task: one for one in outcomes if one.instrument == "report"}
    # It counts the findings of both models, the page those of its own; and no box of it can be pressed.
    assert report[Task.COUNT].answer == "4"
    assert {task for task, one in report.items() if not one.right} == {Task.COUNT, Task.SAME}
