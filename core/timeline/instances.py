"""Observations to physical defects: one record for one place, however often and from wherever it was seen.

Pairs of observations are joined from the nearest on, as in single-linkage clustering, but every join is
checked against the groups it would make: their middles must be near each other and no frame may show
two of its boxes apart. Distances are in radii of the observations' own patches, so no scale is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import exp, log

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.geometry.boxes import box_iou
from core.mapping.observations import Observation
from core.scene.detection import Outcome

F64 = NDArray[np.float64]

LINK_RADII = 1.0
"""Two observations further apart than this many of their patches' radii show two defects."""
SAME_TRACK = 2.0
"""Observations that the detector followed as one may lie this many times as far apart."""
OTHER_LABEL = 0.6
"""Of different labels, this share of it: detectors confuse labels, but neighbours with two labels are usually two."""
OTHER_SIDE = 0.6
"""Seen from opposite sides: an edge may be, the two faces of a blade may not."""
SAME_BOX_IOU = 0.2
"""Two boxes of one frame that overlap less show two defects."""


@dataclass
class _Group:
    members: list[int]
    total: F64
    weight: float
    radius: float
    frames: dict[int | None, list[int]] = field(default_factory=dict)

    @property
    def middle(self) -> F64:
        middle: F64 = self.total / self.weight
        return middle


def group_observations(observations: Sequence[Observation]) -> list[list[int]]:
    """Rows of the observations of each defect, sorted by time; only `mapped` ones take part.

    Args:
        observations: of one model.
    """
    rows = [k for k, one in enumerate(observations) if one.row.outcome == Outcome.MAPPED and len(one.points)]
    if not rows:
        return []
    places = np.array([(o.row.x, o.row.y, o.row.z) for o in (observations[k] for k in rows)], np.float64)
    reach = np.array([_reach(observations[k]) for k in rows])
    groups = [_group(k, observations[row], places[k], reach[k]) for k, row in enumerate(rows)]
    owner = list(range(len(rows)))
    for _, a, b in _edges([observations[row] for row in rows], places, reach):
        first, second = owner[a], owner[b]
        if first != second and _may_join(groups[first], groups[second], [observations[row] for row in rows]):
            _join(groups[first], groups[second])
            for member in groups[second].members:
                owner[member] = first
    kept = [groups[k] for k in sorted(set(owner))]
    order = [sorted((rows[m] for m in group.members), key=lambda k: _when(observations[k])) for group in kept]
    return sorted(order, key=lambda members: _when(observations[members[0]]))


def _when(one: Observation) -> tuple[float, int]:
    return one.row.moment_s, one.row.id


def _reach(one: Observation) -> float:
    """How far from its place an observation's defect may be thought to lie, scene units."""
    return one.radius + (one.sigma or 0.0)


def _group(k: int, one: Observation, place: F64, reach: float) -> _Group:
    weight = 1.0 / max(one.sigma or reach, 1e-12) ** 2
    return _Group([k], place * weight, weight, reach, {one.row.frame_index: [k]})


def _edges(observations: Sequence[Observation], places: F64, reach: F64) -> list[tuple[float, int, int]]:
    """Pairs that may show one defect, by their distance in allowed distances."""
    tree = cKDTree(places)
    edges = []
    for a, b in sorted(tree.query_pairs(SAME_TRACK * LINK_RADII * float(reach.max()))):
        allowed = _allowed(observations[a], observations[b], (reach[a] + reach[b]) / 2)
        ratio = float(np.linalg.norm(places[a] - places[b])) / allowed
        if ratio <= 1.0:
            edges.append((ratio, a, b))
    return sorted(edges)


def _allowed(a: Observation, b: Observation, reach: float) -> float:
    allowed = LINK_RADII * reach
    # Every file numbers its tracks by itself: equal ids of two videos are two tracks.
    if a.track_id is not None and a.track_id == b.track_id and a.row.video == b.row.video:
        return SAME_TRACK * allowed
    if a.row.label != b.row.label:
        allowed *= OTHER_LABEL
    if float(a.normal @ b.normal) < 0.0:
        allowed *= OTHER_SIDE
    return allowed


def _may_join(a: _Group, b: _Group, observations: Sequence[Observation]) -> bool:
    smaller, larger = sorted((a, b), key=lambda group: len(group.members))
    reach = (a.radius * len(a.members) + b.radius * len(b.members)) / (len(a.members) + len(b.members))
    if float(np.linalg.norm(a.middle - b.middle)) > LINK_RADII * reach:
        return False
    for frame, members in smaller.frames.items():
        for other in larger.frames.get(frame, ()):
            if any(overlap(observations[m], observations[other]) < SAME_BOX_IOU for m in members):
                return False
    return True


def _join(a: _Group, b: _Group) -> None:
    n, m = len(a.members), len(b.members)
    a.radius = (a.radius * n + b.radius * m) / (n + m)
    a.members += b.members
    a.total = a.total + b.total
    a.weight += b.weight
    for frame, members in b.frames.items():
        a.frames.setdefault(frame, []).extend(members)


def overlap(a: Observation, b: Observation) -> float:
    """Intersection over union of the boxes of two rows."""
    one, two = ((o.row.box_x1, o.row.box_y1, o.row.box_x2, o.row.box_y2) for o in (a, b))
    return box_iou(one, two)


def fused_place(observations: Sequence[Observation]) -> tuple[F64, float]:
    """Place of a defect over its observations, and its standard deviation, scene units.

    Weighted by the inverse variances, then by nearness to what most of them say (a Cauchy weight at three
    standard deviations), a few times over. The spread of the observations enters the deviation, so errors
    that they have in common but did not foresee count too.
    """
    places = np.array([(o.row.x, o.row.y, o.row.z) for o in observations], np.float64)
    sigma = np.array([max(o.sigma or o.radius, 1e-12) for o in observations])
    middle: F64 = np.median(places, axis=0)
    weight = 1.0 / sigma**2
    for _ in range(10):
        distance = np.linalg.norm(places - middle, axis=1)
        robust = weight / (1.0 + (distance / (3.0 * sigma)) ** 2)
        middle = (robust[:, None] * places).sum(axis=0) / robust.sum()
    spread = float((robust * distance**2).sum() / robust.sum()) / 3.0
    effective = float(robust.sum() ** 2 / (robust**2).sum())
    return middle, float(np.sqrt(max(spread, 1.0 / float(weight.mean())) / effective))


FALSE_RATE = 0.02
"""Share of the frames in which a detector reports something at a place where nothing is."""


def existence(k: int, n: int, recall: float) -> float:
    """Probability that something is there that was detected in k of the n frames that could show it.

    A detector that finds a share `recall` of what it could see is compared with one that invents at
    `FALSE_RATE`, both equally likely before (binomial likelihoods).
    """
    recall = min(0.95, max(2.0 * FALSE_RATE, recall))
    odds = k * log(recall / FALSE_RATE) + (n - k) * log((1.0 - recall) / (1.0 - FALSE_RATE))
    return 1.0 / (1.0 + exp(-max(-30.0, min(30.0, odds))))
