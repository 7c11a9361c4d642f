"""How people are asked: each question in words that stand alone, and the form of its answer.

Every person gets the questions in an order of his own, so none may lean on the one before it.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from enum import StrEnum

from core.study.truth import UNKNOWN, Task


class AnswerKind(StrEnum):
    """What is entered."""

    NUMBER = "number"
    """A whole number from 0."""
    FINDING = "finding"
    """The number of a finding: a list to choose from would tell how many there are."""
    END = "end"
    """Root or tip."""


@dataclass(frozen=True)
class Question:
    """One question as people read it."""

    text: str
    kind: AnswerKind
    unit: str = ""
    """Of a number, as it stands behind the field."""
    tolerance: float = 0.0
    """By how much a number may differ from the right one, in its unit."""


QUESTIONS: Mapping[Task, Question] = {
    Task.COUNT: Question("How many findings are there?", AnswerKind.NUMBER),
    Task.LARGEST: Question("Which finding is the largest?", AnswerKind.FINDING),
    Task.BLADE: Question("On which blade are most findings?", AnswerKind.NUMBER, "(number of the blade)"),
    Task.BEST_FRAME: Question(
        "Which frame shows the largest finding best, of those in which it was detected?",
        AnswerKind.NUMBER,
        "(number of the frame)",
    ),
    Task.SPAN: Question(
        "How far from the root of its blade towards the tip does the largest finding lie?",
        AnswerKind.NUMBER,
        "% of the span",
        tolerance=5.0,
    ),
    Task.ROOT_OR_TIP: Question("Is the largest finding nearer to the root or to the tip of its blade?", AnswerKind.END),
    Task.NOT_SEEN: Question(
        "Of which blade was the smallest share of its surface seen?", AnswerKind.NUMBER, "(number of the blade)"
    ),
    Task.SAME: Question("Which finding is in the box {box}?", AnswerKind.FINDING),
}
"""By task; `{box}` is filled with the words for the box of the scene."""

NOT_TOLD = "I cannot tell"


def task_id(task: Task) -> str:
    """Name of a task in files."""
    return task.name.lower()


def is_right(task: Task, answer: str | None, right: Collection[str]) -> bool:
    """Whether an answer is one of the right ones.

    Args:
        task: what was asked.
        answer: as it was entered; None where the person could not tell, which is right where nobody can.
        right: every right answer, `UNKNOWN` among them where the result does not hold it.
    """
    if answer is None:
        return UNKNOWN in right
    if QUESTIONS[task].kind != AnswerKind.NUMBER:
        return answer in right
    try:
        given = float(answer)
    except ValueError:
        return False
    known = [float(one) for one in right if one != UNKNOWN]
    return math.isfinite(given) and any(abs(given - one) <= QUESTIONS[task].tolerance for one in known)
