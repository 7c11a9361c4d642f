"""The options of what is known of the row of blades. Defaults here are the preset `default`."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import model_validator

from core.settings.base import Group, option

LEAST_BLADES, MOST_BLADES = 7, 180
"""Of a whole row."""


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

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if self.zero_blade is not None and self.count is None:
            raise ValueError("row.zero_blade needs row.count: numbers go round with it")
        return self
