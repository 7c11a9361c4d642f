"""The evaluation of a study: records are marked, too few people are no result, and known differences are found."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.main import main
from bench.study.comparison import chance, differences, holm, missing
from bench.study.records import TASKS, Condition, read_people
from core.errors import BadInput

RIGHT = {
    name: ["D1"] if name in ("largest", "same") else ["root"] if name == "root_or_tip" else ["2"] for name in TASKS
}
ORDERS = (("gallery", "A"), ("page", "A"), ("gallery", "B"), ("page", "B"))


def record(participant: int, wrong: dict[str, int], seconds: dict[str, float], sus: dict[str, int]) -> dict[str, Any]:
    """A run in which the first `wrong` questions of a condition are not told, at the same time for each."""
    first, scene = ORDERS[(participant - 1) % 4]
    other = ("page" if first == "gallery" else "gallery", "B" if scene == "A" else "A")
    blocks = []
    for condition, at in ((first, scene), other):
        answers = [
            {
                "task": name,
                "answer": None if number < wrong[condition] else RIGHT[name][0],
                "seconds": seconds[condition],
                "confidence": 5,
                "hidden_s": 0,
                "reopened": 0,
            }
            for number, name in enumerate(TASKS)
        ]
        marks = [sus[condition] if number % 2 == 0 else 6 - sus[condition] for number in range(10)]
        tlx = dict.fromkeys(("mental", "physical", "temporal", "performance", "effort", "frustration"), 40)
        blocks.append({"condition": condition, "scene": at, "answers": answers, "sus": marks, "tlx": tlx})
    person = {"participant": participant, "group": (participant - 1) % 4, "ended": "2026-01-01", "blocks": blocks}
    return {"schema_version": 1, "study": "abc", **person}


def usual(participant: int) -> dict[str, Any]:
    """Better with the page, each by another amount; the load is the same."""
    return record(
        participant,
        {"gallery": 3 + participant % 3, "page": participant % 2},
        {"gallery": 30.0 + participant, "page": 20.0},
        {"gallery": 3, "page": 5},
    )


@pytest.fixture
def saved(tmp_path: Path) -> Callable[..., list[str]]:
    key = {"schema_version": 1, "study": "abc", "scenes": {"A": RIGHT, "B": RIGHT}}
    (tmp_path / "answers.json").write_text(json.dumps(key))

    def write(*rows: dict[str, Any]) -> list[str]:
        paths = []
        for number, row in enumerate(rows):
            paths.append(tmp_path / f"{number}.json")
            paths[-1].write_text(json.dumps(row))
        return ["study", *map(str, paths), "--answers", str(tmp_path / "answers.json")]

    return write


def test_fifteen_people_are_no_result(saved: Callable[..., list[str]], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(saved(*map(usual, range(1, 16)))) == 0
    said = capsys.readouterr().out
    assert "15 people took part; at least 16 are needed: nothing is compared and nothing claimed." in said
    assert not any(word in said for word in ("gallery", "page", "better", "chance"))
    assert main([*saved(*map(usual, range(1, 16))), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["differences"] is None


def test_sixteen_of_unequal_groups_are_none_either(saved: Callable[..., list[str]]) -> None:
    people = read_people(*files(saved(*map(usual, [*range(1, 16), 17]))))
    assert "The four groups hold 5, 4, 4, 3 people" in missing(people)
    with pytest.raises(ValueError, match="groups"):
        differences(people)


def files(arguments: list[str]) -> tuple[list[Path], Path]:
    return [Path(one) for one in arguments[1:-2]], Path(arguments[-1])


def test_sixteen_people_tell_what_differs(saved: Callable[..., list[str]], capsys: pytest.CaptureFixture[str]) -> None:
    arguments = saved(*map(usual, range(1, 17)))
    found = {one.measure.split()[0]: one for one in differences(read_people(*files(arguments)))}
    right = [usual(number)["blocks"] for number in range(1, 17)]
    shares = {
        kind: np.mean(
            [
                sum(one["answer"] is not None for one in b["answers"]) / 8
                for run in right
                for b in run
                if b["condition"] == kind
            ]
        )
        for kind in Condition
    }
    assert found["answers"].gallery == pytest.approx(shares[Condition.GALLERY])
    assert found["answers"].page == pytest.approx(shares[Condition.PAGE])
    assert found["answers"].low <= found["answers"].difference <= found["answers"].high
    assert found["answers"].page_is_better is True
    assert found["answers"].chance == pytest.approx(4 * 2 / 2**16)  # only all signs alike are as far, of four measures
    assert (found["usability"].gallery, found["usability"].page) == (50, 100)
    assert found["task"].page_is_better is None
    assert found["task"].chance == 1
    assert main(arguments) == 0
    said = capsys.readouterr().out
    assert "right answers a minute: the page was better." in said
    assert "task load (NASA-TLX, 0 to 100): this study does not tell whether they differ." in said


def test_chance_is_as_often_small_as_it_says() -> None:
    random = np.random.default_rng(5)
    values = np.array([chance(random.normal(size=10)) for _ in range(400)])
    assert (values < 0.05).mean() == pytest.approx(0.05, abs=0.035)
    assert chance(np.full(20, 1.0)) == pytest.approx(2 / 2**16, abs=3 / 2**16)
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])


def changed(**parts: Any) -> dict[str, Any]:
    return {**usual(1), **parts}


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([changed(study="other")], "another study"),
        ([changed(ended=None)], "did not end"),
        ([usual(1), usual(1)], "more than once"),
        ([changed(blocks=usual(1)["blocks"][:1])], "lacks a condition"),
        ([changed(blocks=[{**one, "sus": [3]} for one in usual(1)["blocks"]])], "ten marks"),
        (
            [changed(blocks=[{**one, "answers": one["answers"][1:]} for one in usual(1)["blocks"]])],
            "not every question",
        ),
        ([changed(blocks=[{**one, "tlx": {"mental": 4}} for one in usual(1)["blocks"]])], "six marks"),
    ],
)
def test_what_is_no_record_is_said(saved: Callable[..., list[str]], rows: list[dict[str, Any]], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        read_people(*files(saved(*rows)))
