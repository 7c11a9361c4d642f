"""Observations on the surface grouped into defects, and these as colour on the mesh."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.mapping.coloring import coloring_radius, vertex_weights
from core.mapping.observations import parts_rows, read_observations
from core.mapping.scene import Scene
from core.measure.scale import FoundScale
from core.measure.sizes import Sizes, measure_defects
from core.outputs import evidence_name
from core.products.contract import Products
from core.products.surface import TimelineProduct
from core.scene.defect import DefectRecord, EventRow
from core.scene.detection import Detection, DetectionRow
from core.scene.frame import RunFrames
from core.scene.methods import Grouped, Report
from core.scene.size import Scale, Size, scale_fields
from core.settings.groups import MappingSettings
from core.surface.ply import Mesh
from core.task_key import stage_of, submodel_of
from core.timeline.defects import Found, defect_records, event_rows, find_defects
from core.timeline.surface import defect_of_vertices, faces_of_defects

I32 = NDArray[np.int32]


@dataclass(frozen=True)
class Start:
    """First free ids of a model: those of a further one go on where the models before it ended."""

    defect: int = 0
    event: int = 0

    @classmethod
    def after(cls, products: Products, submodel: int) -> Start:
        """Behind the timelines of all models before `submodel`."""
        keys = (key for key in products if stage_of(key) == "timeline" and submodel_of(key) < submodel)
        before = products.every(TimelineProduct, keys)
        return cls(sum(own.n_defects for own in before), sum(own.n_events for own in before))

    def rows(self, rows: Sequence[DetectionRow]) -> list[DetectionRow]:
        """Detections."""
        return [row if row.defect_id is None else replace(row, defect_id=row.defect_id + self.defect) for row in rows]

    def events(self, rows: Sequence[EventRow]) -> list[EventRow]:
        """Events."""
        return [replace(row, event_id=row.event_id + self.event, defect_id=row.defect_id + self.defect) for row in rows]

    def records(self, records: Sequence[DefectRecord]) -> list[DefectRecord]:
        """Defects."""
        return [
            replace(
                record,
                id=record.id + self.defect,
                events=tuple(event + self.event for event in record.events),
                evidence=f"gallery/{evidence_name(record.id + self.defect)}",
            )
            for record in records
        ]

    def vertices(self, defect: I32) -> I32:
        """Defect of every vertex; -1 = none."""
        return np.where(defect >= 0, defect + self.defect, defect).astype(np.int32)


@dataclass(frozen=True)
class SurfaceGrouping:
    """Grouping of the observations that `core.mapping.surface_rules.SurfacePlacing` left."""

    folder: Path
    """Result of the placing."""
    detections: Mapping[int, Detection]
    """Of the annotation file, by id."""
    scale: FoundScale
    """Of the model."""
    scene: Scene
    frames: RunFrames
    mesh: Mesh
    """To be coloured."""
    n_warnings: int
    """Warnings of the checks about the model that the places lie on."""
    start: Start
    settings: MappingSettings
    threads: int
    report: Report

    def group(self) -> Grouped[TimelineProduct]:
        """Instances, visits and confidences."""
        observations = read_observations(self.folder)
        self.report(1, 4, "telling defects apart")
        times_s = self.frames.moment_of_index
        found = find_defects(observations, self.scene, times_s, self.n_warnings)
        events = event_rows(found, times_s)
        self.report(2, 4, "colouring the surface and measuring the defects")
        weight, vertex_defect = paint_defects(self.mesh, found, self.settings, self.threads)
        faces = [own.tolist() for own in faces_of_defects(self.mesh.faces, vertex_defect, len(found.defects))]
        sizes = _in_unit(_measured(found, self.detections, self.scene), self.scale.scale)
        records = defect_records(found, events, faces, self.scene.model, sizes.defects)
        rows = [_with_size(one.row, sizes.detections.get(one.row.id)) for one in found.observations]
        return Grouped(
            rows=tuple(self.start.rows(rows)),
            events=tuple(self.start.events(events)),
            defects=tuple(self.start.records(records)),
            confidences=tuple(parts_rows(found.observations)),
            weight=weight,
            vertex_defect=self.start.vertices(vertex_defect),
            product=TimelineProduct(
                n_events=len(events),
                n_defects=len(found.defects),
                n_unconfirmed=found.unconfirmed,
                n_measured=sum(size.length is not None for size in sizes.defects),
                scale=scale_fields(self.scale.scale),
                flags=tuple(self.scale.flags),
            ),
            scale=self.scale.scale,
        )


def _measured(found: Found, detections: Mapping[int, Detection], scene: Scene) -> Sizes:
    members = [[found.observations[k] for k in defect.members] for defect in found.defects]
    return measure_defects(members, [defect.place for defect in found.defects], detections, scene)


def _in_unit(sizes: Sizes, scale: Scale | None) -> Sizes:
    return Sizes(
        tuple(size.scaled(scale) for size in sizes.defects),
        {number: size.scaled(scale) for number, size in sizes.detections.items()},
    )


def _with_size(row: DetectionRow, size: Size | None) -> DetectionRow:
    """The row with the columns of its own size, all but the depth, which no single view tells."""
    if size is None:
        return row
    columns = {name: value for name, value in asdict(size.columns()).items() if not name.startswith("depth")}
    return replace(row, **columns)


def paint_defects(
    mesh: Mesh, found: Found, settings: MappingSettings, threads: int
) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
    """(n,) weight and (n,) defect (-1 none) of every vertex, by the points of the surface that detections showed.

    Equation 3.2 with these points instead of the thesis's sparse support. Places that made no record stay
    uncoloured.
    """
    owners = [(number, k) for number, defect in enumerate(found.defects) for k in defect.members]
    points = [found.observations[k].points for _, k in owners]
    position = np.concatenate([np.zeros((0, 3)), *points])
    defect = np.concatenate(
        [np.zeros(0, np.int32), *(np.full(len(p), n, np.int32) for (n, _), p in zip(owners, points, strict=True))]
    )
    radius = coloring_radius(mesh.diagonal, settings.radius_fraction)
    coloring = vertex_weights(mesh.vertices, position, radius, settings.sigma_fraction * radius, threads)
    strongest = np.full(len(mesh.vertices), -1, np.int32)
    near = coloring.point >= 0
    strongest[near] = defect[coloring.point[near]]
    return coloring.weight, defect_of_vertices(strongest, {n: n for n in range(len(found.defects))})
