"""Groups of observations that no frame can tell apart become one defect.

Where the surface has a second, stray sheet behind or before the true one, some frames put a defect on the one and some
on the other. Both places then appear in the boxes of all of them: what differs is a depth that the boxes do not show.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import in_box
from core.mapping.observations import Observation
from core.mapping.support import box_in_crop_px
from core.scene.frame import Crop
from core.scene.views import Views
from core.timeline.instances import SAME_BOX_IOU, fused_place, overlap

F64 = NDArray[np.float64]

MERGE_RADII = 4.0
"""Groups whose places are further apart than this many radii of their patches are never one."""
IN_BOX_SHARE = 0.8
"""Of the boxes of either group, the other's place must lie in this share."""


def merge_alike(
    groups: Sequence[Sequence[int]], observations: Sequence[Observation], views: Views, crop: Crop
) -> list[list[int]]:
    """Join groups of one label whose places lie in each other's boxes, the most alike first.

    Args:
        groups: rows of `observations`, each sorted by time.
        observations: of the model of `views`.
        views: registered images.
        crop: from source to exported frames.

    Returns:
        Groups sorted by the time of their first row, each sorted by time.
    """
    merged = {number: list(group) for number, group in enumerate(groups)}
    places = {number: fused_place([observations[k] for k in group])[0] for number, group in merged.items()}

    def alike(a: int, b: int) -> float:
        return _alike(merged[a], merged[b], places[a], places[b], observations, views, crop)

    shares = {(a, b): alike(a, b) for a, b in combinations(merged, 2)}
    while shares and max(shares.values()) >= IN_BOX_SHARE:
        a, b = max(shares, key=lambda pair: (shares[pair], -pair[0], -pair[1]))
        merged[a] += merged.pop(b)
        places[a] = fused_place([observations[k] for k in merged[a]])[0]
        shares = {pair: share for pair, share in shares.items() if b not in pair}
        shares |= {pair: alike(*pair) for pair in shares if a in pair}

    def when(row: int) -> tuple[float, int]:
        return observations[row].row.moment_s, observations[row].row.id

    return sorted((sorted(group, key=when) for group in merged.values()), key=lambda group: when(group[0]))


def _alike(
    first: Sequence[int],
    second: Sequence[int],
    place_a: F64,
    place_b: F64,
    observations: Sequence[Observation],
    views: Views,
    crop: Crop,
) -> float:
    """The smaller of the shares of boxes that the other's place lies in; 0 where something else tells them apart."""
    own, other = [observations[k] for k in first], [observations[k] for k in second]
    radius = float(np.median([one.radius for one in (*own, *other)]))
    if float(np.linalg.norm(place_a - place_b)) > MERGE_RADII * radius or _label(own) != _label(other):
        return 0.0
    for one in own:
        for two in other:
            if one.row.frame_index == two.row.frame_index and overlap(one, two) < SAME_BOX_IOU:
                return 0.0
    return min(_in_boxes(place_b, own, views, crop), _in_boxes(place_a, other, views, crop))


def _label(group: Sequence[Observation]) -> str:
    return Counter(sorted(one.row.label for one in group)).most_common(1)[0][0]


def _in_boxes(place: F64, group: Sequence[Observation], views: Views, crop: Crop) -> float:
    """Share of the boxes of registered frames that a (3,) place appears in."""
    xy, seen = views.project(place[None])
    hits = []
    for one in group:
        row = None if one.row.frame_index is None else views.row(one.row.frame_index)
        if row is None:
            continue
        box = (one.row.box_x1, one.row.box_y1, one.row.box_x2, one.row.box_y2)
        hits.append(bool(seen[0, row] and in_box(xy[0, row], box_in_crop_px(box, crop, "source"))))
    return float(np.mean(hits)) if hits else 0.0
