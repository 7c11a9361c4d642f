"""Where a detection may lie on the surface: one candidate per patch under it, and the choice among them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.mapping.consensus import ViewConsensus
from core.mapping.patches import Patch

F64 = NDArray[np.float64]

MIN_SHARE = 0.1
"""A patch under a smaller share of a detection's pixels is the rim of something else."""
NEAREST_BONUS = 0.25
"""A nick is missing metal: what it belongs to is nearer than what is seen through it."""
SHARE_WEIGHT = 0.2
DEPTH_WEIGHT = 0.8
"""A patch that depth maps see through is a sheet that fusion or Poisson left before the blades."""
PRIOR_VIEWS = 3.0
"""The share of supporting views is trusted only as far as there are more of them than this."""
CONSISTENT = 0.5
"""Share of depth maps' looks, or of sparse points, on a patch that is there."""
MIN_ALONE = 0.5
"""Without depth maps, the least share of a detection's pixels on a patch that nothing else speaks for."""
MIN_SPARSE = 0.2
"""Of the sparse points on or before a patch, the least share that lies on it: else something nearer was meant."""


@dataclass(frozen=True)
class Candidate:
    """A patch that a detection may show."""

    detection: int
    """Row of the detection."""
    patch: Patch
    place: F64
    """(3,) point of the mesh nearest to the area centroid of the patch."""
    normal: F64
    """(3,) unit, towards the camera that saw it."""
    nearest: bool
    """No other candidate of the detection is nearer to the camera."""
    depth: float | None
    """Share of the depth maps' looks that met it, see `core.mapping.depth_consistency`."""
    sparse: float | None = None
    """Of the sparse points of the detection that lie on it or before it, the share on it; None = too few."""


def merit(candidate: Candidate, visible: int, support: int) -> float:
    """How likely this is the one that was meant; only the order among the candidates of a detection matters."""
    share = support / (visible + PRIOR_VIEWS)
    depth = 0.5 if candidate.depth is None else candidate.depth
    return share + NEAREST_BONUS * candidate.nearest + SHARE_WEIGHT * candidate.patch.share + DEPTH_WEIGHT * depth


def is_depth_consistent(candidate: Candidate) -> bool:
    """Whether depth maps or sparse points say that what was seen lies on it."""
    return any(share is not None and share >= CONSISTENT for share in (candidate.depth, candidate.sparse))


def is_contradicted(candidate: Candidate, visible: int, support: int) -> bool:
    """Whether the sparse points show something before it, and neither depth maps nor most views that could see it
    show it there.

    That is a blade whose surface is missing: what its pixels meet is the next one.
    """
    if candidate.sparse is None or candidate.sparse >= MIN_SPARSE or 2 * support > visible:
        return False
    return candidate.depth is None or candidate.depth < CONSISTENT


def is_unsupported(candidate: Candidate, support: int, maps: bool) -> bool:
    """Whether the detection's pixels are all that speaks for it: no other view, no depth map and no sparse points.

    That is the next blade beside one whose surface is missing. In ten results on rendered scenes five wrong places
    were such, under 0.6 to 0.9 of the pixels, and none of 1,350 right ones. Where there are no depth maps at all, most
    of the pixels are enough.
    """
    if support or is_depth_consistent(candidate):
        return False
    return maps or candidate.patch.share < MIN_ALONE


def choose(
    candidates: Sequence[Candidate], consensus: ViewConsensus, maps: bool = True
) -> dict[int, tuple[int, float]]:
    """The best candidate of each detection that has one: its row and by how much it leads (infinite without another).

    Those that are contradicted or unsupported do not count.

    Args:
        candidates: of all detections.
        consensus: a row for each candidate.
        maps: whether there are depth maps.
    """
    visible, support = consensus.n_visible, consensus.n_support
    by_detection: dict[int, list[tuple[float, int]]] = {}
    for row, candidate in enumerate(candidates):
        seen, agree = int(visible[row]), int(support[row])
        if is_contradicted(candidate, seen, agree) or is_unsupported(candidate, agree, maps):
            continue
        value = merit(candidate, int(visible[row]), int(support[row]))
        by_detection.setdefault(candidate.detection, []).append((-value, row))
    chosen = {}
    for detection, found in by_detection.items():
        found.sort()
        lead = found[1][0] - found[0][0] if len(found) > 1 else float("inf")
        chosen[detection] = (found[0][1], lead)
    return chosen
