"""The options of what is known of the row of blades. Defaults here are the preset `default`."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal, Self

from pydantic import field_validator, model_validator

from core.scene.on_row import OF_FURTHER
from core.settings.base import Group, option

LEAST_BLADES, MOST_BLADES = 7, 180
"""Of a whole row."""


_SAME = re.compile(rf"{OF_FURTHER.pattern}=(\d{{1,3}})")


@dataclass(frozen=True)
class SameBlade:
    """A blade that two models show, by its numbers in both."""

    model: int
    """The further model."""
    number: int
    """In that model: in order of first appearance."""
    first: int
    """On the row of the first model, as the tables name it."""


def same_blades(text: str | None) -> tuple[SameBlade, ...]:
    """The pairs that `row.same_blade` tells; ValueError for what is no list of pairs, or tells of one model twice."""
    if text is None:
        return ()
    pairs = [_SAME.fullmatch(pair.strip()) for pair in text.split(",")]
    found = tuple(SameBlade(*map(int, pair.groups())) for pair in pairs if pair is not None)
    if len(found) < len(pairs) or any(one.model == 0 for one in found):
        raise ValueError(f"'{text}' does not read like 1-B4=2: blade 4 of model 1 is blade 2 of the first")
    if len({one.model for one in found}) < len(found):
        raise ValueError("one blade of each further model is enough")
    return found


class RowSettings(Group):
    """What a person knows of the row of blades; without it numbers are counted from the blade seen first."""

    count: int | None = option(
        None, "blades in the whole row; the pitch is exact then", source="user", ge=LEAST_BLADES, le=MOST_BLADES
    )
    zero_blade: int | None = option(
        None,
        "which blade is the engine's number 1, counted from 1 in order of first appearance; it may lie outside of what "
        "was seen (0 is the one before the first); needs row.count",
        source="user",
        ge=-MOST_BLADES,
        le=MOST_BLADES,
    )
    direction: Literal["as_seen", "reversed"] = option(
        "as_seen", "whether the engine's numbers rise in order of first appearance", source="user"
    )
    edge_a: Literal["leading", "trailing"] | None = option(
        None,
        "which edge is edge a: that end of a blade that lies lower along the axis of row.json; none = unknown",
        source="user",
    )
    radius_mm: float | None = option(
        None,
        "distance of row.radius_at from the axis of the engine, which gives the scale",
        unit="mm",
        source="user",
        gt=0,
    )
    radius_sigma_mm: float | None = option(
        None, "standard deviation of row.radius_mm; none = 1 % of it", unit="mm", source="user", ge=0
    )
    radius_at: Literal["root", "tip"] = option("root", "the end of the blades that row.radius_mm is of", source="user")

    same_blade: str | None = option(
        None,
        "blades that two models show, as 1-B4=2 (blade 4 of model 1 is blade 2 of the first), with commas between; "
        "none = by frames of both or by the turn between them, else unknown",
        source="user",
    )

    @field_validator("same_blade")
    @classmethod
    def _pairs(cls, text: str | None) -> str | None:
        same_blades(text)
        return text

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.zero_blade is not None and self.count is None:
            raise ValueError("row.zero_blade needs row.count: numbers go round with it")
        return self
