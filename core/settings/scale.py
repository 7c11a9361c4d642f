"""The options of what is known of true lengths. Defaults here are the preset `default`."""

from __future__ import annotations

from typing import Self

from pydantic import model_validator

from core.settings.base import Group, option


class ScaleSettings(Group):
    """What is known of true lengths; without it sizes are in the unit of the model."""

    points: tuple[float, float, float, float] | None = option(
        None,
        "x and y of two pixels of the source frame at scale.time_s, pixel centres at 0.5, between which "
        "scale.length_mm is known in a straight line",
        unit="px",
        source="user",
    )
    length_mm: float | None = option(None, "length between scale.points", unit="mm", source="user", gt=0)
    length_sigma_mm: float | None = option(
        None, "standard deviation of scale.length_mm; none = 1 % of it", unit="mm", source="user", ge=0
    )
    time_s: float = option(0.0, "time of the frame that scale.points lie on", unit="s", source="user", ge=0)
    video: int = option(0, "number of the video that this frame is of", source="user", ge=0)

    @model_validator(mode="after")
    def _whole(self) -> Self:
        if (self.points is None) != (self.length_mm is None):
            raise ValueError("scale.points and scale.length_mm belong together: give both")
        if self.points is not None and self.points[:2] == self.points[2:]:
            raise ValueError("scale.points must be two different pixels")
        return self
