"""Spatial clusters of placed detections: equation 3.3 of the thesis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from core.mapping.rows import DetectionRow, Outcome

F64 = NDArray[np.float64]


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
    for row in sorted((row for row in rows if row.outcome == Outcome.MAPPED), key=lambda row: (row.time_s, row.id)):
        place = np.array((row.x, row.y, row.z), dtype=np.float64)
        chosen = _nearest(growing, place, radius)
        if chosen is None:
            chosen = _Growing()
            growing.append(chosen)
        chosen.rows.append(row)
        chosen.total = chosen.total + place
    clusters = [Cluster(tuple(cluster.rows)) for cluster in growing]
    return sorted(clusters, key=lambda cluster: (cluster.start_s, cluster.rows[0].id))


def _nearest(growing: Sequence[_Growing], place: F64, radius: float) -> _Growing | None:
    if not growing:
        return None
    means = np.array([cluster.total / len(cluster.rows) for cluster in growing])
    distance = np.linalg.norm(means - place, axis=1)
    best = int(distance.argmin())
    return growing[best] if distance[best] <= radius else None
