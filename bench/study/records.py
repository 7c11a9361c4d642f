"""The records that the page of a study saves, held against its right answers."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from core.errors import BadInput
from core.json_files import JsonObject
from core.study.build import SCHEMA_VERSION
from core.study.questions import is_right, task_id
from core.study.truth import Task

TASKS: Mapping[str, Task] = {task_id(task): task for task in Task}
N_GROUPS = 4
_SUS_ITEMS, _TLX_SCALES = 10, 6


class Condition(StrEnum):
    """What people answered with."""

    GALLERY = "gallery"
    PAGE = "page"


@dataclass(frozen=True)
class Given:
    """One answer of one person."""

    task: Task
    right: bool
    told: bool
    """False: "I cannot tell"."""
    seconds: float
    confidence: int


@dataclass(frozen=True)
class Part:
    """What a person did with one condition."""

    given: tuple[Given, ...]
    sus: float
    """System Usability Scale, 0 to 100."""
    tlx: float
    """NASA Task Load Index without weights, 0 (no load) to 100."""

    @property
    def share_right(self) -> float:
        """Of all answers, those that are right."""
        return sum(one.right for one in self.given) / len(self.given)

    @property
    def right_a_minute(self) -> float:
        """Right answers in a minute of looking for any."""
        return 60 * sum(one.right for one in self.given) / sum(one.seconds for one in self.given)


@dataclass(frozen=True)
class Person:
    """One person's whole run."""

    participant: int
    group: int
    parts: Mapping[Condition, Part]

    @property
    def minutes(self) -> float:
        """Time over all answers."""
        return sum(one.seconds for part in self.parts.values() for one in part.given) / 60


def read_people(paths: Sequence[Path], answers: Path) -> list[Person]:
    """The people of a study by their number.

    Args:
        paths: JSON files that its page saved, one a person.
        answers: `answers.json` of the same study.

    Raises:
        BadInput: a file is no finished run of this study, or a number appears twice.
    """
    key = _read(answers)
    if not isinstance(key.get("scenes"), dict) or key.get("schema_version") != SCHEMA_VERSION:
        raise BadInput(f"'{answers.name}' holds no right answers of a study", where="--answers")
    people = [_person(path, key) for path in paths]
    twice = [number for number, count in Counter(one.participant for one in people).items() if count > 1]
    if twice:
        raise BadInput(f"number {twice[0]} is there more than once", where="FILES")
    return sorted(people, key=lambda one: one.participant)


def _read(path: Path) -> JsonObject:
    try:
        value = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadInput(f"'{path.name}' cannot be read: {error}", where=path.name) from None
    if not isinstance(value, dict):
        raise BadInput(f"'{path.name}' holds no object", where=path.name)
    return value


def _person(path: Path, key: JsonObject) -> Person:
    row = _read(path)
    if row.get("study") != key["study"]:
        raise BadInput(f"'{path.name}' is of another study", where=path.name)
    if not row.get("ended"):
        raise BadInput(f"'{path.name}' is of a run that did not end", where=path.name)
    try:
        parts = {Condition(block["condition"]): _part(block, key["scenes"][block["scene"]]) for block in row["blocks"]}
        person = Person(int(row["participant"]), int(row["group"]), parts)
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"'{path.name}' is no record of this study: {error!r}", where=path.name) from None
    if set(parts) != set(Condition) or person.group not in range(N_GROUPS):
        raise BadInput(f"'{path.name}' lacks a condition or a group", where=path.name)
    return person


def _part(block: JsonObject, right: JsonObject) -> Part:
    """One block, marked.

    Raises:
        ValueError: an answer or a mark is missing or not possible.
    """
    given = tuple(_given(one, right) for one in block["answers"])
    if sorted(one.task for one in given) != sorted(Task):
        raise ValueError("not every question was answered once")
    sus, tlx = [int(mark) for mark in block["sus"]], [float(mark) for mark in block["tlx"].values()]
    if len(sus) != _SUS_ITEMS or not all(1 <= mark <= 5 for mark in sus):
        raise ValueError("the usability scale is not ten marks of 1 to 5")
    if len(tlx) != _TLX_SCALES or not all(0 <= mark <= 100 for mark in tlx):
        raise ValueError("the task load index is not six marks of 0 to 100")
    return Part(given, sus_score(sus), sum(tlx) / len(tlx))


def _given(one: JsonObject, right: JsonObject) -> Given:
    task, answer, seconds = TASKS[one["task"]], one["answer"], float(one["seconds"])
    if not math.isfinite(seconds) or seconds <= 0 or int(one["confidence"]) not in range(1, 8):
        raise ValueError(f"time or confidence of {one['task']}")
    told = None if answer is None else str(answer)
    return Given(task, is_right(task, told, right[one["task"]]), told is not None, seconds, int(one["confidence"]))


def sus_score(marks: Sequence[int]) -> float:
    """The System Usability Scale, 0 to 100, of ten marks (Brooke 1996): odd statements praise, even ones blame."""
    return 2.5 * sum(mark - 1 if number % 2 == 0 else 5 - mark for number, mark in enumerate(marks))
