"""What holds of the findings of a result after all records: pure, and the same in the page (`web/src/model/review.ts`).

Records speak of findings as they were in some attempt. Each is attached to the finding that has the same label and
model and lies within the joint standard deviation of both places; where there is none it stays, as unattached.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from core.json_files import JsonObject
from core.review.record import ReviewRecord
from core.review.target import Target
from core.review.words import Action, ReviewState, TargetKind

_EXACT = 1e-6
"""Places closer than this share of their size are one: what a file rounds off."""


@dataclass(frozen=True)
class Note:
    """A note, and who wrote it."""

    text: str
    by: str
    time: str


@dataclass(frozen=True)
class Review:
    """What people say of one finding; None where they say nothing."""

    state: ReviewState = ReviewState.OPEN
    reason: str = ""
    """Of a rejection, one of `Rejection`."""
    label: str | None = None
    blade: str | None = None
    """Empty: on none."""
    severity: str | None = None
    point: tuple[float, float, float] | None = None
    """Where it lies, in the world frame of its model."""
    merged_into: str | None = None
    """Name of the finding that it is part of."""
    notes: tuple[Note, ...] = ()
    measures: tuple[JsonObject, ...] = ()
    """As in the records, the newest last."""
    without: tuple[int, ...] = ()
    """Detections that are findings of their own."""
    by: str = ""
    """Of the last record that holds."""
    time: str = ""

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {
            "state": self.state,
            "reason": self.reason or None,
            "label": self.label,
            "blade": self.blade,
            "severity": self.severity,
            "point": None if self.point is None else list(self.point),
            "merged_into": self.merged_into,
            "notes": [note.__dict__ for note in self.notes],
            "measures": list(self.measures),
            "without": list(self.without),
            "by": self.by or None,
            "time": self.time or None,
        }


@dataclass(frozen=True)
class ReviewedFinding:
    """A finding with what people say of it."""

    name: str
    """``D7`` for the method's, ``H1`` for those that people made, in the order in which they did; ``U1`` for what is
    not attached."""
    target: Target
    """As it is now; of one that is not attached, as the first record named it."""
    review: Review
    made: ReviewRecord | None = None
    """The record that made it; None for the method's."""

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {
            "name": self.name,
            "target": self.target.to_dict(),
            "review": self.review.to_dict(),
            "made": None if self.made is None else self.made.to_dict(),
        }


@dataclass(frozen=True)
class Reviewed:
    """A result after review."""

    revision: int
    """Of the last record; 0 without any."""
    findings: tuple[ReviewedFinding, ...]
    """The method's in their order, reviewed or not, then those that people made."""
    unattached: tuple[ReviewedFinding, ...]
    """What was said of findings that the result does not have, such as those of a former attempt."""

    def find(self, name: str) -> ReviewedFinding | None:
        """The finding of a name; None when there is none."""
        return next((one for one in self.findings if one.name == name), None)

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {
            "revision": self.revision,
            "findings": [one.to_dict() for one in self.findings],
            "unattached": [one.to_dict() for one in self.unattached],
        }


def standing(records: Sequence[ReviewRecord]) -> list[ReviewRecord]:
    """The records that hold, in their order: those that no later record takes back, without the takings back."""
    ordered = sorted(records, key=lambda one: one.revision)
    taken = {one.value for one in ordered if one.action == Action.UNDO}
    return [one for one in ordered if one.action != Action.UNDO and one.id not in taken]


def fold(records: Sequence[ReviewRecord], defects: Sequence[Target]) -> Reviewed:
    """What holds after all records.

    Args:
        records: of one result, in any order; their revisions order them.
        defects: the findings of the method in the result as it is now.
    """
    revision = max((one.revision for one in records), default=0)
    folding = _Folding(_made(records), list(defects))
    for record in standing(records):
        folding.apply(record)
    return folding.reviewed(revision)


def _made(records: Sequence[ReviewRecord]) -> dict[str, str]:
    """Names of findings that people made by the id of the record; also of those taken back, so that none is renamed."""
    makers = [one for one in sorted(records, key=lambda one: one.revision) if one.action in (Action.ADD, Action.SPLIT)]
    return {one.id: f"H{number}" for number, one in enumerate(makers, 1)}


@dataclass
class _Folding:
    """Findings by name, as far as records were applied."""

    names: dict[str, str]
    defects: list[Target]
    found: dict[str, ReviewedFinding] = field(default_factory=dict)
    lost: dict[str, ReviewedFinding] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for one in self.defects:
            self.found[f"D{one.id}"] = ReviewedFinding(f"D{one.id}", one, Review())

    def apply(self, record: ReviewRecord) -> None:
        """Take one record into account; those that hold come in their order."""
        if record.action == Action.ADD:
            self._make(record, _added(record))
            return
        name = self._name(record.target)
        here = self.found if name in self.found else self.lost
        one = here.setdefault(name, ReviewedFinding(name, record.target, Review()))
        review = self._after(one, record)
        here[name] = replace(one, review=replace(review, by=record.by, time=record.time))
        if record.action == Action.SPLIT:
            self._make(record, replace(one.target, kind=TargetKind.ADDED, id=record.id, centroid=None, sigma=None))

    def reviewed(self, revision: int) -> Reviewed:
        """What came of it."""
        return Reviewed(revision, tuple(self.found.values()), tuple(self.lost.values()))

    def _make(self, record: ReviewRecord, target: Target) -> None:
        name = self.names[record.id]
        self.found[name] = ReviewedFinding(name, target, Review(by=record.by, time=record.time), record)

    def _name(self, target: Target) -> str:
        """The finding that a target means; what is not there gets a name that says what was meant."""
        if target.kind == TargetKind.ADDED:
            return self.names.get(str(target.id), f"H-{target.id}")
        near = [one for one in self.defects if is_same(one, target)]
        # Of several that overlap the one that also has the number, then the nearest.
        best = min(near, key=lambda one: (one.id != target.id, one.distance(target)), default=None)
        if best is not None:
            return f"D{best.id}"
        known = (name for name, one in self.lost.items() if one.target == target)
        return next(known, f"U{1 + sum(one.target.kind == TargetKind.DEFECT for one in self.lost.values())}")

    def _after(self, one: ReviewedFinding, record: ReviewRecord) -> Review:
        review, value = one.review, record.value
        match record.action:
            case Action.ACCEPT:
                return replace(review, state=ReviewState.ACCEPTED, reason="", merged_into=None)
            case Action.REJECT:
                return replace(review, state=ReviewState.REJECTED, reason=record.reason, merged_into=None)
            case Action.RELABEL:
                return replace(review, label=str(value))
            case Action.SET_BLADE:
                return replace(review, blade=str(value))
            case Action.SEVERITY:
                return replace(review, severity=str(value))
            case Action.NOTE:
                return replace(review, notes=(*review.notes, Note(str(value), record.by, record.time)))
        if isinstance(value, dict):
            match record.action:
                case Action.MOVE:
                    x, y, z = value["point"]
                    return replace(review, point=(x, y, z))
                case Action.MEASURE:
                    return replace(review, measures=(*review.measures, value))
                case Action.SPLIT:
                    return replace(review, without=tuple(sorted({*review.without, *value["detections"]})))
                case Action.MERGE:
                    return self._merged(one, Target.parse(value, "value"))
        return review

    def _merged(self, one: ReviewedFinding, into: Target) -> Review:
        """Merged, unless that would close a circle: then both stay."""
        name = self._name(into)
        at: str | None = name
        while at is not None:
            if at == one.name:
                return one.review
            at = self.found[at].review.merged_into if at in self.found else None
        return replace(one.review, state=ReviewState.MERGED, reason="", merged_into=name)


def is_same(defect: Target, told: Target) -> bool:
    """Whether a finding is the one that a record named: same model and label, and no farther than both sigmas allow."""
    if defect.label != told.label:
        return False
    size = max((abs(value) for value in told.centroid or ()), default=0.0)
    allowed = math.hypot(defect.sigma or 0.0, told.sigma or 0.0) + _EXACT * max(1.0, size)
    return defect.distance(told) <= allowed


def _added(record: ReviewRecord) -> Target:
    value = record.value if isinstance(record.value, dict) else {}
    point = value.get("point")
    centroid = None if point is None else (point[0], point[1], point[2])
    return Target(TargetKind.ADDED, record.id, str(value.get("label", "")), record.target.model, centroid)
