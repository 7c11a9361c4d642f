"""The tables of a model with the columns of the row: detections, events, defects, and the findings of ``row.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import hypot

import numpy as np
from numpy.typing import NDArray

from core.json_files import JsonObject
from core.row.model import BladeRow, NoRow
from core.row.places import OnRow, normals_at, on_row
from core.row.sample import smoothed
from core.scene.defect import MODEL_UNIT, DefectRecord, EventRow
from core.scene.detection import DetectionRow
from core.scene.on_row import blade_name
from core.scene.size import LengthUnit, Scale, ScaleSource, scale_fields
from core.scene.views import Views
from core.settings.row import RowSettings
from core.surface.ply import Mesh

F64 = NDArray[np.float64]

TOLD_SHARE = 0.01
"""Standard deviation of a radius that is told without one, as a share of it."""
RADIUS_SHARE = 0.015
"""Of a radius found, though the pitch be exact: on the sample the axis lies 1.8 mm of 150 mm off."""


@dataclass(frozen=True)
class RowOfModel:
    """A row, and what places of its model are compared with."""

    row: BladeRow
    mesh: Mesh
    """Surface of the model, its faces counter-clockwise seen from the cameras."""
    views: Views
    """Of the model."""
    model: int = 0
    scale: Scale | None = None
    on_first: JsonObject | None = None
    """Of a further model: how it lies on the row of the first (`core.row.on_first`)."""

    @cached_property
    def steady(self) -> Mesh:
        """What is asked which way the surface looks: the wall of a dent looks anywhere, the blade about it does not."""
        return smoothed(self.mesh, self.row.radius_sigma)

    @property
    def unit(self) -> LengthUnit:
        """Of the lengths in its columns."""
        return MODEL_UNIT if self.scale is None else LengthUnit.MM

    def name(self, number: int | None) -> str | None:
        """A blade as the tables name it (`blade_name`); None for what lies on none."""
        return None if number is None else blade_name(number, self.model, self.on_first)

    def detections(self, rows: Sequence[DetectionRow], sigmas: Mapping[int, float | None]) -> list[DetectionRow]:
        """The rows, those with a place in this model with their blade and where on it they lie.

        Args:
            rows: of any model.
            sigmas: standard deviations of the places by detection, in the unit of the model; some may be missing.
        """
        own = [row for row in rows if row.x is not None and row.model in (None, self.model)]
        places = np.array([(row.x, row.y, row.z) for row in own], np.float64).reshape(-1, 3)
        normals = self._seen(own, places, normals_at(self.steady, places))
        found = on_row(self.row, places, normals, [sigmas.get(row.id) for row in own])
        by_id = {row.id: place.scaled(self.scale) for row, place in zip(own, found, strict=True)}
        return [self._with(row, by_id[row.id]) if row.id in by_id else row for row in rows]

    def _seen(self, rows: Sequence[DetectionRow], places: F64, normals: F64) -> F64:
        """(n, 3) the normals, each turned to the camera that saw its detection: a thin blade has its back near by."""
        views = [None if row.frame_index is None else self.views.row(row.frame_index) for row in rows]
        seen = normals.copy()
        for k, view in enumerate(views):
            if view is not None and float((self.views.centers[view] - places[k]) @ normals[k]) < 0:
                seen[k] = -normals[k]
        return seen

    def _with(self, row: DetectionRow, place: OnRow) -> DetectionRow:
        return replace(row, blade=self.name(place.blade), on_row=place.columns, length_unit=self.unit)

    def records(self, records: Sequence[DefectRecord]) -> tuple[list[DefectRecord], list[JsonObject]]:
        """The records of this model with their blade and where on it they lie, and the same as findings of the row."""
        places = np.array([record.centroid for record in records], np.float64).reshape(-1, 3)
        normals = normals_at(self.steady, places)
        for k, record in enumerate(records):
            if record.normal is not None:
                normals[k] = record.normal
        found = on_row(self.row, places, normals, [record.centroid_sigma for record in records])
        scaled = [place.scaled(self.scale) for place in found]
        placed = [
            replace(record, blade=self.name(place.blade), on_row=place.columns)
            for record, place in zip(records, scaled, strict=True)
        ]
        findings = [
            {"defect": record.id, "label": record.label, **place.to_dict(), "length_unit": str(self.unit)}
            for record, place in zip(records, scaled, strict=True)
        ]
        return placed, findings


def row_document(
    row: BladeRow | NoRow, findings: Sequence[JsonObject], scale: Scale | None, on_first: JsonObject | None
) -> JsonObject:
    """The object of ``row.json``; `on_first` only of further models."""
    further = {} if on_first is None else {"on_first": on_first}
    return {**row.to_dict(), "findings": list(findings), "scale": scale_fields(scale), **further}


def events_on_row(events: Sequence[EventRow], records: Sequence[DefectRecord]) -> list[EventRow]:
    """The events, each with the blade of its defect."""
    blades = {record.id: record.blade for record in records}
    return [replace(event, blade=blades.get(event.defect_id)) for event in events]


def scale_of_row(row: BladeRow | NoRow, told: RowSettings) -> Scale | None:
    """The scale that a radius gives which is told; None without one, or without a row.

    The radius found goes with the pitch, for the two trade; with an exact pitch the place of the axis remains.
    """
    if told.radius_mm is None or isinstance(row, NoRow):
        return None
    found = row.root_radius if told.radius_at == "root" else row.tip_radius
    given = told.radius_sigma_mm if told.radius_sigma_mm is not None else TOLD_SHARE * told.radius_mm
    shares = (
        given / told.radius_mm,
        max(RADIUS_SHARE, row.pitch_sigma_rad / row.pitch_rad),
        row.radius_sigma / found,
    )
    value = told.radius_mm / found
    return Scale(value, value * hypot(*shares), ScaleSource.ROW)
