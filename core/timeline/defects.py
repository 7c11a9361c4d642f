"""Defects, events and confidences out of observations on the surface."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.mapping.confidence import confidence
from core.mapping.observations import Observation
from core.mapping.scene import Scene
from core.outputs import evidence_name
from core.scene.defect import MODEL_UNIT, Confidence, DefectRecord, EventRow, Extent, Persistence, Sighting
from core.scene.detection import Outcome, leading_label
from core.scene.frame import Crop
from core.scene.size import Size
from core.timeline.instances import existence, fused_place, group_observations
from core.timeline.merging import merge_alike
from core.timeline.seen import views_of_place, visits

F64 = NDArray[np.float64]

MIN_EXISTENCE = 0.5
"""A place whose detections are more likely inventions than not makes no record."""
SMALLEST_SHARE = 0.05
"""The quantile of the boxes' sizes that stands for the smallest size at which the detector finds something."""
SMALLEST_SLACK = 0.9
"""A frame counts as one that could show a defect when it would show it at this share of the smallest size or larger."""


@dataclass(frozen=True)
class Defect:
    """One physical defect."""

    members: tuple[int, ...]
    """Rows of its observations, by time."""
    place: F64
    sigma: float
    normal: F64
    sightings: tuple[Sighting, ...]
    """Registered views that could see it, best first."""
    k: int
    """Frames with a detection of it."""
    n: int
    """Frames that could show it: those of the sightings that the detector saw, large enough for it, and the k."""
    exists: float
    visits: tuple[tuple[int, ...], ...]
    """Frame indices with a detection, by visit."""


@dataclass(frozen=True)
class Found:
    """Everything of one model."""

    observations: tuple[Observation, ...]
    """As given, with confidence and defect id."""
    defects: tuple[Defect, ...]
    """By the time of their first detection; the position is the id."""
    unconfirmed: int
    """Groups of mapped detections that other frames speak against too much for a record."""


def find_defects(
    observations: Sequence[Observation], scene: Scene, times_s: Mapping[int, float], n_warnings: int = 0
) -> Found:
    """Group the observations of a model into defects.

    Args:
        observations: in input order, all of them.
        scene: of the model.
        times_s: of its registered frames on one axis of all videos (`core.videos.moment`), by frame index.
        n_warnings: warnings of the checks about the model.
    """
    looked = set(scene.views.frame_index[scene.frames.rows].tolist())
    groups = merge_alike(group_observations(observations), observations, scene.views, scene.crop)
    smallest = _smallest_px(observations, scene.crop)
    candidates = [_defect(members, observations, scene, times_s, looked, smallest) for members in groups]
    recall = _recall(candidates)
    candidates = [replace(defect, exists=existence(defect.k, defect.n, recall)) for defect in candidates]
    updated = list(observations)
    for defect in candidates:
        for member in defect.members:
            updated[member] = _judged(updated[member], defect, n_warnings)
    defects = tuple(defect for defect in candidates if defect.exists >= MIN_EXISTENCE)
    for number, defect in enumerate(defects):
        for member in defect.members:
            updated[member] = replace(updated[member], row=replace(updated[member].row, defect_id=number))
    return Found(_with_estimates(updated, defects), defects, len(candidates) - len(defects))


def _defect(
    members: Sequence[int],
    observations: Sequence[Observation],
    scene: Scene,
    times_s: Mapping[int, float],
    looked: set[int],
    smallest_px: float,
) -> Defect:
    own = [observations[k] for k in members]
    place, sigma = fused_place(own)
    nearest, _ = scene.surface.nearest(place[None])
    normal = sum((one.normal for one in own), np.zeros(3))
    normal = normal / max(float(np.linalg.norm(normal)), 1e-12)
    points = _core(own, place)
    seen = views_of_place(points, normal, scene.views, scene.surface, scene.tolerance, nearest[0], scene.crop)
    detected = sorted({one.row.frame_index for one in own if one.row.frame_index is not None}, key=lambda i: times_s[i])
    asked = [sighting.frame_index for sighting in seen if sighting.frame_index in looked]
    n = len(set(detected) | set(_large_enough(asked, own, place, scene, smallest_px)))
    return Defect(
        tuple(members),
        nearest[0],
        sigma,
        normal,
        tuple(seen),
        len(detected),
        n,
        0.0,
        tuple(tuple(visit) for visit in visits(detected, [s.frame_index for s in seen], times_s)),
    )


def _smallest_px(observations: Sequence[Observation], crop: Crop) -> float:
    """Side of the smallest boxes that this detector drew: what a frame shows smaller is not expected of it."""
    sides = [_side_px(one, crop) for one in observations if one.row.outcome == Outcome.MAPPED]
    return float(np.quantile(sides, SMALLEST_SHARE)) if sides else 0.0


def _side_px(one: Observation, crop: Crop) -> float:
    """Of the square with the area of its box, source px."""
    width, height = one.row.box_x2 - one.row.box_x1, one.row.box_y2 - one.row.box_y1
    return float(np.sqrt(max(width * crop.source_width * height * crop.source_height, 0.0)))


def _large_enough(
    frames: Sequence[int], own: Sequence[Observation], place: F64, scene: Scene, smallest_px: float
) -> list[int]:
    """Of the frames, those that show a place at least as large as the detector's smallest boxes, by its own boxes."""
    distance = np.linalg.norm(scene.views.centers - place, axis=1)
    away = dict(zip(scene.views.frame_index.tolist(), distance.tolist(), strict=True))
    sizes = [_side_px(one, scene.crop) * away[one.row.frame_index] for one in own if one.row.frame_index in away]
    size = float(np.median(sizes)) if sizes else np.inf
    return [frame for frame in frames if size >= SMALLEST_SLACK * smallest_px * away[frame]]


def _core(own: Sequence[Observation], place: F64) -> F64:
    """Surface points of the observations near the fused place: the nearer half of them."""
    points = np.concatenate([one.points for one in own])
    distance = np.linalg.norm(points - place, axis=1)
    nearer: F64 = points[distance <= np.median(distance)]
    return nearer


def _recall(defects: Sequence[Defect]) -> float:
    """How often the detector finds what it could see: over all frames that could show a defect seen at least twice."""
    known = [defect for defect in defects if defect.k >= 2]
    total = sum(defect.n for defect in known)
    return sum(defect.k for defect in known) / total if total else 0.5


def _judged(one: Observation, defect: Defect, n_warnings: int) -> Observation:
    """The observation with its confidence, which depends on the other observations of the same defect."""
    if one.parts is None:
        return one
    place = np.array((one.row.x, one.row.y, one.row.z))
    offset = float(np.linalg.norm(place - defect.place)) / max(one.radius, 1e-12)
    parts = replace(one.parts, peers=len(defect.members) - 1, offset=offset, model_warnings=n_warnings)
    return replace(one, parts=parts, row=replace(one.row, confidence=round(confidence(parts), 4)))


def _with_estimates(observations: Sequence[Observation], defects: Sequence[Defect]) -> tuple[Observation, ...]:
    """Estimated places join the defect they fall on; they make none of their own."""
    places = np.array([defect.place for defect in defects]).reshape(-1, 3)
    found = []
    for one in observations:
        if one.row.outcome == Outcome.APPROXIMATE and len(places):
            distance = np.linalg.norm(places - np.array((one.row.x, one.row.y, one.row.z)), axis=1)
            nearest = int(distance.argmin())
            reach = max(one.radius, max(_radius(defects[nearest], observations), one.sigma or 0.0))
            if distance[nearest] <= reach:
                one = replace(one, row=replace(one.row, defect_id=nearest))
        found.append(one)
    return tuple(found)


def _radius(defect: Defect, observations: Sequence[Observation]) -> float:
    return float(np.median([observations[k].radius for k in defect.members]))


def event_rows(found: Found, times_s: Mapping[int, float]) -> list[EventRow]:
    """One event per visit, by start; the ids are their positions."""
    rows: list[tuple[float, int, EventRow]] = []
    for number, defect in enumerate(found.defects):
        for visit in defect.visits:
            own = [found.observations[k] for k in defect.members if found.observations[k].row.frame_index in visit]
            rows.append((own[0].row.moment_s, number, _event(number, defect, own, len(visit))))
    rows.sort(key=lambda item: item[:2])
    return [replace(row, event_id=k) for k, (_, _, row) in enumerate(rows)]


def _event(number: int, defect: Defect, own: Sequence[Observation], n_frames: int) -> EventRow:
    places = np.array([(o.row.x, o.row.y, o.row.z) for o in own])
    middle = places.mean(axis=0)
    return EventRow(
        event_id=-1,
        defect_id=number,
        label=leading_label([one.row for one in own]),
        start_s=own[0].row.time_s,
        end_s=own[-1].row.time_s,
        n_detections=len(own),
        n_frames=n_frames,
        x=float(middle[0]),
        y=float(middle[1]),
        z=float(middle[2]),
        radius=float(np.linalg.norm(places - middle, axis=1).max()),
        confidence=_combined(own, defect),
        video=own[0].row.video,
    )


def _combined(own: Sequence[Observation], defect: Defect) -> float:
    """Confidence of several observations of one place: the median of theirs, held down by what other frames say."""
    stated = [one.row.confidence for one in own if one.row.confidence is not None]
    return round(float(np.median(stated)) * defect.exists, 4) if stated else 0.0


def defect_records(
    found: Found,
    events: Sequence[EventRow],
    faces: Sequence[Sequence[int]],
    model: int,
    sizes: Sequence[Size] | None = None,
) -> list[DefectRecord]:
    """Records of the defects; `faces` are those of the coloured mesh by defect, `sizes` their sizes where measured."""
    records = []
    for number, defect in enumerate(found.defects):
        own = [found.observations[k] for k in defect.members]
        rows = [one.row for one in own]
        detected = {row.frame_index for row in rows}
        records.append(
            DefectRecord(
                id=number,
                label=leading_label(rows),
                labels=dict(sorted(Counter(row.label for row in rows).items())),
                model=model,
                centroid=_three(defect.place.tolist()),
                centroid_sigma=defect.sigma,
                normal=_three([round(float(value), 6) for value in defect.normal]),
                extent=_extent(own),
                confidence=Confidence(_combined(own, defect), _parts(own, defect)),
                persistence=Persistence(defect.k, defect.n),
                events=tuple(event.event_id for event in events if event.defect_id == number),
                detections=tuple(row.id for row in rows),
                approximate_detections=_approximate(found.observations, number),
                frames=tuple(replace(one, detected=one.frame_index in detected) for one in defect.sightings),
                evidence=f"gallery/{evidence_name(number)}",
                faces=tuple(int(face) for face in faces[number]),
                size=None if sizes is None else sizes[number],
            )
        )
    return records


def _three(values: Sequence[float]) -> tuple[float, float, float]:
    x, y, z = values
    return x, y, z


def _approximate(observations: Sequence[Observation], number: int) -> tuple[int, ...]:
    return tuple(o.row.id for o in observations if o.row.outcome == Outcome.APPROXIMATE and o.row.defect_id == number)


def _extent(own: Sequence[Observation]) -> Extent:
    """Diameter: twice the median radius of the patches; sigma is 1.4826 MAD, null for fewer than three."""
    sizes = np.array([2.0 * one.radius for one in own])
    value = float(np.median(sizes))
    sigma = 1.4826 * float(np.median(np.abs(sizes - value))) if len(sizes) >= 3 else None
    return Extent(value, MODEL_UNIT, sigma)


def _parts(own: Sequence[Observation], defect: Defect) -> dict[str, Any]:
    """What the confidence of a defect is made of: medians over its observations, and its existence."""
    dicts = [one.parts.to_dict() for one in own if one.parts is not None]
    names = dicts[0].keys() if dicts else ()
    medians = {name: _median([d[name] for d in dicts if d[name] is not None]) for name in names}
    return {"exists": round(defect.exists, 4), "observations": len(own), **medians}


def _median(values: Sequence[Any]) -> float | None:
    return round(float(np.median(values)), 4) if values else None
