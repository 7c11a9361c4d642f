"""How large a finding is: its measures with their uncertainties, and the scale that gives them a unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from math import hypot, sqrt

from core.json_files import JsonObject

MM_PER_INCH = 25.4
"""Some people read inches; files are in mm."""


class LengthUnit(StrEnum):
    """What a length counts."""

    MODEL = "model"
    """The unit of the model's coordinates, which is unknown."""
    MM = "mm"


class SizeFrom(StrEnum):
    """What the outline of a finding is known from."""

    MASK = "mask"
    BOX = "box"
    """The ellipse in it stands for the shape that it was drawn around."""


class Unmeasured(StrEnum):
    """Why a finding has no size."""

    NO_VIEW = "no_view"
    """No registered view with an outline of it is left."""
    NO_SURFACE = "no_surface"
    """The surface is not there."""
    NOT_SEEN = "not_seen"
    """No view sees the surface inside its outlines."""


class ScaleSource(StrEnum):
    """Where a scale is from."""

    POINTS = "points"
    """A known length between two pixels of a frame."""
    ROW = "row"
    """A known radius of the row of blades."""


@dataclass(frozen=True)
class Scale:
    """Millimetres in a unit of the model."""

    value: float
    """mm per model unit."""
    sigma: float
    """Standard deviation of `value`."""
    source: str
    """`ScaleSource`; several that were joined with ``+`` between."""

    @property
    def share(self) -> float:
        """The standard deviation over the value."""
        return self.sigma / self.value

    @classmethod
    def from_dict(cls, row: JsonObject) -> Scale | None:
        """From the JSON form of `scale_fields`; None where no scale is known."""
        return None if row.get("value") is None else cls(row["value"], row["sigma"], row["source"])


def scale_fields(scale: Scale | None) -> JsonObject:
    """The JSON form of a scale: unit, value, sigma, source; the last three None while no scale is known."""
    if scale is None:
        return {"unit": LengthUnit.MODEL, "value": None, "sigma": None, "source": None}
    return {"unit": LengthUnit.MM, **asdict(scale)}


@dataclass(frozen=True)
class Measure:
    """A length or an area, and the standard deviations that its parts give it, in the same unit."""

    value: float
    outline: float
    """By where the outlines run."""
    pose: float
    """By the distances of the views."""
    surface: float
    """By the surface that it is measured on."""
    scale: float = 0.0
    """By the scale; 0 while none is known."""

    @property
    def sigma(self) -> float:
        """All together."""
        return sqrt(self.outline**2 + self.pose**2 + self.surface**2 + self.scale**2)

    def scaled(self, scale: Scale, power: int) -> Measure:
        """In mm (power 1) or mm² (power 2)."""
        factor = scale.value**power
        parts = (factor * part for part in (self.value, self.outline, self.pose, self.surface))
        value, outline, pose, surface = parts
        return Measure(value, outline, pose, surface, power * scale.share * value)

    def unscaled(self, scale: Scale, power: int) -> Measure:
        """In units of the model, from mm (power 1) or mm² (power 2)."""
        factor = scale.value**-power
        return Measure(factor * self.value, factor * self.outline, factor * self.pose, factor * self.surface)

    def parts(self) -> dict[str, float]:
        """The standard deviations by their source."""
        return {name: value for name, value in asdict(self).items() if name != "value"}


@dataclass(frozen=True)
class SizeColumns:
    """Columns of a defect that say how large it is; the fields are their names, in order."""

    length: float | None = None
    """Its largest extent along the surface, in `length_unit`."""
    length_sigma: float | None = None
    """Standard deviation of the length."""
    width: float | None = None
    """Its extent along the surface across its length, in `length_unit`."""
    width_sigma: float | None = None
    """Standard deviation of the width."""
    area: float | None = None
    """Area of the surface that it covers, in the square of `length_unit`."""
    area_sigma: float | None = None
    """Standard deviation of the area."""
    depth: float | None = None
    """How deep it lies below a smooth surface through its surroundings, where that stands out from the roughness."""
    depth_sigma: float | None = None
    """Standard deviation of the depth."""
    length_unit: LengthUnit | None = None
    """`mm` where a scale is known, else `model`: the unit of the model's coordinates; empty without any length."""
    size_from: SizeFrom | None = None
    """What its outline is known from: `mask`, or `box` for the ellipse in its boxes."""


@dataclass(frozen=True)
class Size:
    """Size of a finding; all None = unknown, which `reason` explains."""

    length: Measure | None = None
    width: Measure | None = None
    area: Measure | None = None
    depth: Measure | None = None
    unit: LengthUnit = LengthUnit.MODEL
    size_from: SizeFrom | None = None
    reason: Unmeasured | None = None

    def scaled(self, scale: Scale | None) -> Size:
        """The same in mm; unchanged without a scale."""
        if scale is None:
            return self
        length, width, depth = (
            None if one is None else one.scaled(scale, 1) for one in (self.length, self.width, self.depth)
        )
        area = None if self.area is None else self.area.scaled(scale, 2)
        return Size(length, width, area, depth, LengthUnit.MM, self.size_from, self.reason)

    def unscaled(self, scale: Scale | None) -> Size:
        """The same in units of the model, from mm by the scale that made them; unchanged where it is not in mm."""
        if scale is None or self.unit != LengthUnit.MM:
            return self
        length, width, depth = (
            None if one is None else one.unscaled(scale, 1) for one in (self.length, self.width, self.depth)
        )
        area = None if self.area is None else self.area.unscaled(scale, 2)
        return Size(length, width, area, depth, LengthUnit.MODEL, self.size_from, self.reason)

    @property
    def measures(self) -> Mapping[str, Measure]:
        """Those that are known, by name."""
        named = {"length": self.length, "width": self.width, "area": self.area, "depth": self.depth}
        return {name: one for name, one in named.items() if one is not None}

    def columns(self) -> SizeColumns:
        """As columns of a table."""
        values = {name: one.value for name, one in self.measures.items()}
        sigmas = {f"{name}_sigma": one.sigma for name, one in self.measures.items()}
        unit = self.unit if values else None
        return SizeColumns(**values, **sigmas, length_unit=unit, size_from=self.size_from)

    def to_dict(self) -> JsonObject:
        """JSON form: the columns, then `size_reason`, and `size_sigma`: every standard deviation by its source."""
        sigmas = {name: one.parts() for name, one in self.measures.items()}
        return {**asdict(self.columns()), "size_reason": self.reason, "size_sigma": sigmas}

    @classmethod
    def from_dict(cls, row: JsonObject) -> Size:
        """From the JSON form."""
        measures = {
            name: Measure(row[name], **parts) for name, parts in row["size_sigma"].items() if row[name] is not None
        }
        unit, known, reason = row["length_unit"], row["size_from"], row["size_reason"]
        return cls(
            **measures,
            unit=LengthUnit.MODEL if unit is None else LengthUnit(unit),
            size_from=None if known is None else SizeFrom(known),
            reason=None if reason is None else Unmeasured(reason),
        )


SIZE_COLUMNS: tuple[str, ...] = tuple(field.name for field in fields(SizeColumns))
"""Columns of the size of a defect."""


def together(*parts: float) -> float:
    """Standard deviation of a sum of independent parts."""
    return hypot(*parts)
