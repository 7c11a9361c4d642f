"""Rows of the timeline and records of defects, one of each per cluster of the thesis's rule."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from core.mapping.rows import DetectionRow
from core.timeline.clusters import Cluster
from core.timeline.rows import EventRow

if TYPE_CHECKING:  # it loads the ray caster, which whoever writes tables does not need
    from core.timeline.visibility import Sighting

F64 = NDArray[np.float64]


def leading_label(rows: Sequence[DetectionRow]) -> str:
    """The most frequent label; among equals the one with the higher sum of scores, then by alphabet."""
    counts = Counter(row.label for row in rows)
    scores: Counter[str] = Counter()
    for row in rows:
        scores[row.label] += row.score or 0.0  # type: ignore[assignment]  # Counter adds floats as well
    return min(counts, key=lambda label: (-counts[label], -scores[label], label))


def event_rows(clusters: Sequence[Cluster]) -> list[EventRow]:
    """One event per cluster; `clusters` are sorted by start, ids are their positions."""
    return [_event(number, cluster) for number, cluster in enumerate(clusters)]


def _event(number: int, cluster: Cluster) -> EventRow:
    x, y, z = (float(value) for value in cluster.centroid)
    return EventRow(
        event_id=number,
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
    )


def with_defect_ids(rows: Sequence[DetectionRow], clusters: Sequence[Cluster]) -> list[DetectionRow]:
    """The rows in their order, each with the id of its cluster (None where it has none)."""
    defect = defect_of_detection(clusters)
    return [replace(row, defect_id=defect.get(row.id)) for row in rows]


def defect_of_detection(clusters: Sequence[Cluster]) -> dict[int, int]:
    """Detection id -> defect id."""
    return {row.id: number for number, cluster in enumerate(clusters) for row in cluster.rows}


def extent_of(supports: Sequence[F64]) -> dict[str, Any]:
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
    return {"value": value, "unit": "model", "sigma": sigma}


def defect_records(
    clusters: Sequence[Cluster],
    supports: Mapping[int, F64],
    sightings: Sequence[Sequence[Sighting]],
    faces: Sequence[Sequence[int]],
) -> list[dict[str, Any]]:
    """Records of ``mapping/defects.json``.

    Args:
        clusters: sorted by start.
        supports: (n, 3) support points by detection id.
        sightings: per cluster, the registered views that could see it, best first.
        faces: per cluster, its faces of the mesh.
    """
    records = []
    for number, cluster in enumerate(clusters):
        detected = {row.frame_index for row in cluster.rows}
        seen = sightings[number]
        records.append(
            {
                "id": number,
                "label": leading_label(cluster.rows),
                "labels": dict(sorted(Counter(row.label for row in cluster.rows).items())),
                "model": 0,
                "centroid": [float(value) for value in cluster.centroid],
                "extent": extent_of([supports[row.id] for row in cluster.rows]),
                "confidence": None,
                "persistence": _persistence(detected, seen),
                "events": [number],
                "detections": [row.id for row in cluster.rows],
                "frames": [sighting.to_dict(sighting.frame_index in detected) for sighting in seen],
                "faces": [int(face) for face in faces[number]],
                "blade": None,
            }
        )
    return records


def _persistence(detected: set[int | None], seen: Sequence[Sighting]) -> dict[str, Any]:
    """k of n: frames with a detection of the defect, of the registered views that could see it."""
    n = len(detected | {sighting.frame_index for sighting in seen})
    return {"k": len(detected), "n": n, "share": len(detected) / n}
