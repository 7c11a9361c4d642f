"""The finding that a review record speaks of."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

from core.json_files import JsonObject
from core.review.checks import bad, index, is_unusable, length, require_member, require_text, three
from core.review.words import TargetKind

MAX_LABEL = 100
"""Characters of a label that people give."""
_MAX_MACHINE_LABEL = 1000
_ID = re.compile(r"[A-Za-z0-9:.+_-]{1,64}")
_MEMBERS = ("kind", "id", "label", "model", "centroid", "sigma")


@dataclass(frozen=True)
class Target:
    """The finding that a record speaks of, named so that it is found again in a later attempt."""

    kind: TargetKind
    id: int | str
    """Number of the defect; of a finding that people made, the id of the record that made it."""
    label: str
    """The machine's label when it was reviewed."""
    model: int = 0
    centroid: tuple[float, float, float] | None = None
    """In the world frame of `model`; None for one without a place."""
    sigma: float | None = None
    """Standard deviation of the place, units of the model."""

    @classmethod
    def of_defect(cls, record: Mapping[str, object]) -> Target:
        """The target that names a record of defects.json."""
        centroid, sigma = record.get("centroid"), record.get("centroid_sigma")
        return cls(
            TargetKind.DEFECT,
            index(record.get("id"), "defects.id"),
            plain_label(str(record.get("label"))),
            index(record.get("model") or 0, "defects.model"),
            None if centroid is None else three(centroid, "defects.centroid"),
            None if sigma is None else length(sigma, "defects.centroid_sigma"),
        )

    @classmethod
    def parse(cls, value: object, where: str) -> Target:
        """From JSON.

        Raises:
            BadInput: it does not name a finding.
        """
        row = require_member(value, where, _MEMBERS)
        kind, name, centroid, sigma = (row.get(member) for member in ("kind", "id", "centroid", "sigma"))
        if kind not in tuple(TargetKind):
            raise bad(f"{where}.kind", f"must be one of {', '.join(TargetKind)}")
        of = f"{where}.id"
        return cls(
            TargetKind(kind),
            index(name, of) if kind == TargetKind.DEFECT else record_id(name, of),
            require_text(row.get("label"), f"{where}.label", _MAX_MACHINE_LABEL, empty=True),
            index(row.get("model") or 0, f"{where}.model"),
            None if centroid is None else three(centroid, f"{where}.centroid"),
            None if sigma is None else length(sigma, f"{where}.sigma"),
        )

    def to_dict(self) -> JsonObject:
        """JSON form."""
        return {
            "kind": self.kind,
            "id": self.id,
            "label": self.label,
            "model": self.model,
            "centroid": None if self.centroid is None else list(self.centroid),
            "sigma": self.sigma,
        }

    def distance(self, other: Target) -> float:
        """Between the two places, units of the model; infinite when one has none or they are of different models."""
        if self.centroid is None or other.centroid is None or self.model != other.model:
            return math.inf
        return math.dist(self.centroid, other.centroid)


def record_id(value: object, where: str) -> str:
    """The id of a record.

    Raises:
        BadInput: it is none.
    """
    if not isinstance(value, str) or not _ID.fullmatch(value):
        raise bad(where, "must be 1 to 64 letters, digits or : . + _ -")
    return value


def plain_label(label: str) -> str:
    """A label of the machine as targets name it: without the characters that no text of a record may have."""
    return "".join(character for character in label if not is_unusable(character))[:_MAX_MACHINE_LABEL]
