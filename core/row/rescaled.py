"""A result's lengths under another scale: a radius that is told gives one, or is joined with the one that is there."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import sqrt
from pathlib import Path

from core.errors import BadInput
from core.flags import Flag
from core.json_files import read_json
from core.measure.scale import join_scales
from core.outputs import ROW, SUMMARY, model_folder
from core.scene.defect import DefectRecord
from core.scene.detection import DetectionRow
from core.scene.size import LengthUnit, Measure, Scale, ScaleSource, Size

_POWERS = {"length": 1, "width": 1, "area": 2, "depth": 1}
MEASURED = (*(f"{name}{end}" for name in _POWERS for end in ("", "_sigma")), "length_unit")
"""Columns of detections and defects that a scale changes, beside those of the row."""


@dataclass(frozen=True)
class ChangeOfScale:
    """The scale that a model's lengths are in, and the one that they shall be in; None = units of the model."""

    old: Scale | None
    new: Scale | None
    flags: tuple[Flag, ...] = ()
    """What there is to say of the new one."""

    def record(self, record: DefectRecord) -> DefectRecord:
        """A defect with its size under the new scale; the columns of the row are left."""
        if self.old == self.new:
            return record
        size = Size() if record.size is None else record.size  # its unit is that of the distances on the row too
        return replace(record, size=size.unscaled(self.old).scaled(self.new))

    def detection(self, row: DetectionRow) -> DetectionRow:
        """A detection with its size under the new scale; the columns of the row are left."""
        if self.old == self.new or self.new is None or row.length_unit is None:
            return row
        old = self.old if row.length_unit == LengthUnit.MM else None
        changed = {"length": row.length, "width": row.width, "area": row.area}
        sigmas = {"length": row.length_sigma, "width": row.width_sigma, "area": row.area_sigma}
        values: dict[str, float | None] = {}
        for name, value in changed.items():
            sigma = sigmas[name]
            if value is not None and sigma is not None:
                values[name], values[f"{name}_sigma"] = _rescaled(value, sigma, _POWERS[name], old, self.new)
        return replace(row, **values, length_unit=LengthUnit.MM)  # type: ignore[arg-type]  # names of numbers alone


def _rescaled(value: float, sigma: float, power: int, old: Scale | None, new: Scale) -> tuple[float, float]:
    """A measure and its standard deviation in mm; the part of the deviation that the old scale had is taken out."""
    if old is None:
        measure = Measure(value, sigma, 0.0, 0.0)
    else:
        own = sqrt(max(sigma**2 - (power * old.share * value) ** 2, 0.0))
        measure = Measure(value, own, 0.0, 0.0).unscaled(old, power)
    scaled = measure.scaled(new, power)
    return scaled.value, scaled.sigma


def changed_scale(old: Scale | None, of_row: Scale | None) -> ChangeOfScale:
    """The scale of a model when its row gives one.

    Args:
        old: that the result has.
        of_row: that the row gives with what is told; None = nothing is told, and the old one stays.

    Raises:
        BadInput: the old one was joined from a row's and others, which cannot be taken apart.
    """
    if of_row is None:
        return ChangeOfScale(old, old)
    if old is None or old.source == ScaleSource.ROW:
        return ChangeOfScale(old, of_row)
    if ScaleSource.ROW in old.source.split("+"):
        detail = f"the scale of the result is from {old.source} together: run the inspection again with another radius"
        raise BadInput(detail, where="row.radius_mm")
    joined = join_scales([old, of_row])
    return ChangeOfScale(old, joined.scale, joined.flags)


def scale_of_model(folder: Path, model: int) -> Scale | None:
    """The scale of a model of a result, by its row.json; where an older one says none, for the first by the summary."""
    path = model_folder(folder, model) / ROW
    told = read_json(path).get("scale") if path.is_file() else None
    if told is None and model == 0:
        told = read_json(folder / SUMMARY).get("scale")
    return Scale.from_dict(told or {})
