"""One review record: who says what of which finding. Records are only added; taking one back is a record too.

Records come from strangers' files and browsers: `ReviewRecord.parse` checks every member and gives the one form in
which they are kept. Texts stay as they were written; whoever shows them shows them as text.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

from core.json_files import JsonObject
from core.review.checks import bad, index, require_member, require_text
from core.review.target import Target, record_id
from core.review.values import value_of
from core.review.words import Action

_MEMBERS = ("id", "revision", "target", "action", "value", "reason", "time", "by", "origin")


class Rejection(StrEnum):
    """Why a finding is none."""

    NOT_DAMAGE = "not damage"
    WRONG_PLACE = "wrong place"
    DUPLICATE = "duplicate"
    OTHER = "other"


@dataclass(frozen=True)
class Origin:
    """Where a record was made before it came here: what its file says, which nobody can check."""

    time: str
    by: str


@dataclass(frozen=True)
class ReviewRecord:
    """One thing that somebody said."""

    id: str
    """Made where the record was made, at random: the same record is kept once however often it is sent."""
    revision: int
    """Its number among those that it is kept with, from 1 without gaps."""
    target: Target
    action: Action
    value: str | JsonObject | None
    """What the action needs; see `core.review.values`."""
    reason: str
    """Why; of a rejection one of `Rejection`."""
    time: str
    """ISO 8601, by the clock of whoever keeps the records: of the service, or of the browser that works without one."""
    by: str
    """Who; empty when it is not known."""
    origin: Origin | None = None

    @classmethod
    def parse(cls, value: object, where: str) -> ReviewRecord:
        """From JSON.

        Raises:
            BadInput: a member is missing, unknown or of another form; the message names it.
        """
        row = require_member(value, where, _MEMBERS)
        revision = index(row.get("revision"), f"{where}.revision")
        if not revision:
            raise bad(f"{where}.revision", "begins at 1")
        time = require_text(row.get("time"), f"{where}.time", 40)
        target = Target.parse(row.get("target"), f"{where}.target")
        action = parse_action(row.get("action"), f"{where}.action")
        name = record_id(row.get("id"), f"{where}.id")
        origin = row.get("origin")
        return cls(
            name,
            revision,
            target,
            action,
            value_of(action, row.get("value"), f"{where}.value"),
            reason_of(action, row.get("reason"), f"{where}.reason"),
            time,
            require_text(row.get("by") or "", f"{where}.by", 200, empty=True),
            None if origin is None else _origin(origin, f"{where}.origin"),
        )

    def to_dict(self) -> JsonObject:
        """JSON form, keys in the order of the fields; `origin` only where there is one."""
        row: JsonObject = {
            "id": self.id,
            "revision": self.revision,
            "target": self.target.to_dict(),
            "action": self.action,
            "value": self.value,
            "reason": self.reason,
            "time": self.time,
            "by": self.by,
        }
        return row if self.origin is None else {**row, "origin": self.origin.__dict__}

    def kept(self, revision: int, time: str | None = None, by: str | None = None) -> ReviewRecord:
        """The same under another number, and as said at another time by somebody else; it then tells its origin."""
        if time is None:
            return replace(self, revision=revision, by=self.by if by is None else by)
        origin = self.origin or Origin(self.time, self.by)
        return replace(self, revision=revision, time=time, by=by or "", origin=origin)


def parse_action(value: object, where: str) -> Action:
    """An action by its name.

    Raises:
        BadInput: there is no such one.
    """
    if not isinstance(value, str) or value not in tuple(Action):
        raise bad(where, f"must be one of {', '.join(Action)}")
    return Action(value)


def reason_of(action: Action, value: object, where: str) -> str:
    """The reason of an action; a rejection needs one of `Rejection`, the others may have a sentence.

    Raises:
        BadInput: it is none.
    """
    text = require_text(value or "", where, 200, empty=True)
    if action == Action.REJECT and text not in tuple(Rejection):
        raise bad(where, f"must be one of {', '.join(Rejection)}")
    return text


def _origin(value: object, where: str) -> Origin:
    row = require_member(value, where, ("time", "by"))
    time = require_text(row.get("time"), f"{where}.time", 40)
    return Origin(time, require_text(row.get("by") or "", f"{where}.by", 200, empty=True))
