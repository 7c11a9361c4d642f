"""Spatial clusters of placed detections (equation 3.3 of the thesis): one cluster is one event and one defect."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.io.annotations import read_rows
from core.mapping.surface import Surface
from core.products.surface import TimelineProduct
from core.scene.defect import MODEL_UNIT, DefectRecord, EventRow, Extent, Persistence, Sighting
from core.scene.detection import DetectionRow, Outcome, leading_label
from core.scene.methods import Grouped, Report
from core.scene.views import Views
from core.settings.groups import TimelineSettings
from core.surface.glb import vertex_normals
from core.surface.ply import Mesh
from core.thesis.coloring import read_coloring
from core.thesis.sightings import mean_normal, sample_points, sightings
from core.timeline.surface import defect_of_vertices, faces_of_defects

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]


@dataclass(frozen=True)
class Cluster:
    """Detections of one place. `rows` are in time order."""

    rows: tuple[DetectionRow, ...]

    @property
    def centroid(self) -> F64:
        """(3,) mean of the detections' places."""
        mean: F64 = np.array([(row.x, row.y, row.z) for row in self.rows], dtype=np.float64).mean(axis=0)
        return mean

    @property
    def radius(self) -> float:
        """Largest distance of a detection's place from the centroid, scene units."""
        places = np.array([(row.x, row.y, row.z) for row in self.rows], dtype=np.float64)
        return float(np.linalg.norm(places - self.centroid, axis=1).max())

    @property
    def start_s(self) -> float:
        """Time of the first detection."""
        return self.rows[0].time_s

    @property
    def end_s(self) -> float:
        """Time of the last detection."""
        return self.rows[-1].time_s


@dataclass
class _Growing:
    """A cluster while it grows: the running sum gives the running mean."""

    rows: list[DetectionRow] = field(default_factory=list)
    total: F64 = field(default_factory=lambda: np.zeros(3))


def cluster_radius(diagonal: float, fraction: float) -> float:
    """Equation 3.3: r_t = fraction * d_mesh, scene units (thesis: 0.02)."""
    return fraction * diagonal


def cluster_detections(rows: Sequence[DetectionRow], radius: float) -> list[Cluster]:
    """Group mapped detections by place alone; labels and time gaps play no part.

    In time order (input order at equal times) each detection joins the nearest cluster whose running
    mean is at most `radius` away, the earlier of two equally near ones, else it starts one. The clusters
    come back sorted by start time, so their positions are the renumbered ids.
    """
    growing: list[_Growing] = []
    for row in sorted((row for row in rows if row.outcome == Outcome.MAPPED), key=lambda row: (row.moment_s, row.id)):
        place = np.array((row.x, row.y, row.z), dtype=np.float64)
        chosen = _nearest(growing, place, radius)
        if chosen is None:
            chosen = _Growing()
            growing.append(chosen)
        chosen.rows.append(row)
        chosen.total = chosen.total + place
    clusters = [Cluster(tuple(cluster.rows)) for cluster in growing]
    return sorted(clusters, key=lambda cluster: (cluster.rows[0].moment_s, cluster.rows[0].id))


def _nearest(growing: Sequence[_Growing], place: F64, radius: float) -> _Growing | None:
    if not growing:
        return None
    means = np.array([cluster.total / len(cluster.rows) for cluster in growing])
    distance = np.linalg.norm(means - place, axis=1)
    best = int(distance.argmin())
    return growing[best] if distance[best] <= radius else None


def event_rows(clusters: Sequence[Cluster]) -> list[EventRow]:
    """One event per cluster and video, by start; `clusters` are sorted by start, ids are positions.

    The thesis has one video; the times of an event are of one.
    """
    parts = [
        (Cluster(tuple(rows)), number)
        for number, cluster in enumerate(clusters)
        for _, rows in groupby(cluster.rows, key=lambda row: row.video)
    ]
    parts.sort(key=lambda part: (part[0].rows[0].moment_s, part[1]))
    return [_event(event, number, part) for event, (part, number) in enumerate(parts)]


def _event(event: int, number: int, cluster: Cluster) -> EventRow:
    x, y, z = (float(value) for value in cluster.centroid)
    return EventRow(
        event_id=event,
        defect_id=number,
        label=leading_label(cluster.rows),
        start_s=cluster.start_s,
        end_s=cluster.end_s,
        n_detections=len(cluster.rows),
        n_frames=len({row.frame_index for row in cluster.rows}),
        x=x,
        y=y,
        z=z,
        radius=cluster.radius,
        confidence=None,
        video=cluster.rows[0].video,
    )


def with_defect_ids(rows: Sequence[DetectionRow], clusters: Sequence[Cluster]) -> list[DetectionRow]:
    """The rows in their order, each with the id of its cluster (None where it has none)."""
    defect = defect_of_detection(clusters)
    return [replace(row, defect_id=defect.get(row.id)) for row in rows]


def defect_of_detection(clusters: Sequence[Cluster]) -> dict[int, int]:
    """Detection id -> defect id."""
    return {row.id: number for number, cluster in enumerate(clusters) for row in cluster.rows}


def extent_of(supports: Sequence[F64]) -> Extent:
    """Size of a defect from its detections' support points: median over detections, ± their spread.

    Of one detection it is the diameter of the evenly covered disc with the same median distance from the
    points' component-wise median, so that a few points on a farther blade do not count. `sigma` is 1.4826
    times the median absolute deviation over the detections, null for fewer than three.
    """
    sizes = []
    for points in supports:
        middle = np.median(points, axis=0)
        sizes.append(2.0 * np.sqrt(2.0) * float(np.median(np.linalg.norm(points - middle, axis=1))))
    value = float(np.median(sizes))
    sigma = 1.4826 * float(np.median(np.abs(np.array(sizes) - value))) if len(sizes) >= 3 else None
    return Extent(value, MODEL_UNIT, sigma)


def defect_records(
    clusters: Sequence[Cluster],
    events: Sequence[EventRow],
    supports: Mapping[int, F64],
    sightings: Sequence[Sequence[Sighting]],
    faces: Sequence[Sequence[int]],
) -> list[DefectRecord]:
    """Records of the defects.

    Args:
        clusters: sorted by start.
        events: of all clusters.
        supports: (n, 3) support points by detection id.
        sightings: per cluster, the registered views that could see it, best first.
        faces: per cluster, its faces of the mesh.
    """
    records = []
    for number, cluster in enumerate(clusters):
        own = tuple(event.event_id for event in events if event.defect_id == number)
        support = [supports[row.id] for row in cluster.rows]
        records.append(_record(number, cluster, own, support, sightings[number], faces[number]))
    return records


def _record(
    number: int,
    cluster: Cluster,
    events: tuple[int, ...],
    supports: Sequence[F64],
    seen: Sequence[Sighting],
    faces: Sequence[int],
) -> DefectRecord:
    detected = {row.frame_index for row in cluster.rows}
    x, y, z = (float(value) for value in cluster.centroid)
    return DefectRecord(
        id=number,
        label=leading_label(cluster.rows),
        labels=dict(sorted(Counter(row.label for row in cluster.rows).items())),
        model=0,
        centroid=(x, y, z),
        extent=extent_of(supports),
        confidence=None,
        persistence=Persistence(len(detected), len(detected | {sighting.frame_index for sighting in seen})),
        events=events,
        detections=tuple(row.id for row in cluster.rows),
        frames=tuple(replace(sighting, detected=sighting.frame_index in detected) for sighting in seen),
        faces=tuple(int(face) for face in faces),
    )


@dataclass(frozen=True)
class ThesisGrouping:
    """Grouping by place alone, of the rows that `ThesisPlacing` left."""

    folder: Path
    """Result of the placing."""
    mesh: Mesh
    views: Views
    settings: TimelineSettings
    report: Report

    def group(self) -> Grouped[TimelineProduct]:
        """Cluster the mapped detections and find the views of every cluster."""
        rows = read_rows(self.folder)
        self.report(1, 4, "grouping detections")
        radius = cluster_radius(self.mesh.diagonal, self.settings.radius_fraction)
        clusters = cluster_detections(rows, radius)
        coloring, support = read_coloring(self.folder)
        vertex_defect = defect_of_vertices(coloring.detection, defect_of_detection(clusters))
        events = event_rows(clusters)
        self.report(2, 4, "finding the views of every defect")
        supports = {int(i): support.position[support.detection == i] for i in np.unique(support.detection)}
        seen = self._views_of(clusters, supports, vertex_defect, coloring.weight)
        faces = [own.tolist() for own in faces_of_defects(self.mesh.faces, vertex_defect, len(clusters))]
        return Grouped(
            rows=tuple(with_defect_ids(rows, clusters)),
            events=tuple(events),
            defects=tuple(defect_records(clusters, events, supports, seen, faces)),
            confidences=(),
            weight=coloring.weight,
            vertex_defect=vertex_defect,
            product=TimelineProduct(n_events=len(events), n_defects=len(clusters), cluster_radius_su=radius),
        )

    def _views_of(
        self, clusters: Sequence[Cluster], supports: Mapping[int, F64], vertex_defect: I32, weight: NDArray[np.float32]
    ) -> list[list[Sighting]]:
        normals = vertex_normals(self.mesh)
        surface = Surface(self.mesh.vertices, self.mesh.faces)
        tolerance = self.settings.occlusion_fraction * self.mesh.diagonal
        seen: list[list[Sighting]] = []
        for number, cluster in enumerate(clusters):
            points = sample_points(np.concatenate([supports[row.id] for row in cluster.rows]))
            normal = mean_normal(normals, vertex_defect, weight, number)
            seen.append(sightings(points, normal, self.views, surface, tolerance))
            self.report(2 + (number + 1) / len(clusters), 4, "finding the views of every defect")
        return seen
