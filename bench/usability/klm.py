"""The keystroke-level model: time of a practised person without errors, from the actions that a task needs.

Source: Card, Moran and Newell, "The Keystroke-Level Model for User Performance Time with Interactive Systems",
Communications of the ACM 23(7), 1980, table 1. A press of the mouse button counts as a keystroke. The answer of the
computer is taken as immediate, and reading is one mental act however much there is to read: times are lower bounds that
can be compared with each other.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum


class Operator(StrEnum):
    """Actions of the model."""

    KEY = "K"
    """A key or a button is pressed."""
    POINT = "P"
    """The mouse is moved to a target."""
    HOME = "H"
    """The hand goes from the keyboard to the mouse or back."""
    MENTAL = "M"
    """What is seen is taken in and decided on."""


SECONDS: Mapping[Operator, float] = {
    Operator.KEY: 0.20,
    Operator.POINT: 1.10,
    Operator.HOME: 0.40,
    Operator.MENTAL: 1.35,
}
"""Of an average skilled typist."""


@dataclass
class Hand:
    """A hand that begins at the mouse, and the actions it made."""

    done: list[Operator] = field(default_factory=list)
    _at_keys: bool = False

    def point_and_press(self) -> None:
        """Move the mouse to a target and press."""
        self._reach(at_keys=False)
        self.done += [Operator.POINT, Operator.KEY]

    def press_key(self) -> None:
        """Press one key."""
        self._reach(at_keys=True)
        self.done.append(Operator.KEY)

    def look(self) -> None:
        """Take in what is shown."""
        self.done.append(Operator.MENTAL)

    @property
    def seconds(self) -> float:
        """Time of the actions so far."""
        return sum(SECONDS[one] for one in self.done)

    @property
    def counts(self) -> Counter[Operator]:
        """How often each was made."""
        return Counter(self.done)

    def _reach(self, *, at_keys: bool) -> None:
        if at_keys != self._at_keys:
            self.done.append(Operator.HOME)
            self._at_keys = at_keys
