"""Places where the picture jumps: matches that are too few for what two frames should share.

When the rotor is turned by a whole number of blades between two frames, their edges and highlights fall on each other
and a few hundred matches verify as if hardly anything had moved; of the marks on the metal none match. So matches are
counted per share of the picture that the two frames have in common, and compared with their neighbours.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from core.viewgraph import PairTable

F64 = NDArray[np.float64]
Bool = NDArray[np.bool_]

NEAR = 10
"""Frames on either side that say how many matches are usual."""
JUMP_SHARE = 0.3
"""A cut whose best pair has less than this of the usual density is a jump. A jump by eight blades leaves 0.18; dark,
blurred and fast stretches of rendered clips 0.8."""
BESIDE = 2
"""Frames right before and right after a jump, which match among themselves"""
GOOD_SHARE = 0.5
"""with at least this share of the usual density."""
PAIR_SHARE = 0.2
"""A pair sought over a gap is seen from further apart, and may have less."""
MIN_OVERLAP = 0.05


def match_density(table: PairTable, keypoints: Sequence[NDArray[np.float32]], width: int, height: int) -> F64:
    """(m,) inliers of each pair over the share of the picture that its median displacement leaves in common."""
    density = np.zeros(len(table.pairs))
    for row, (first, second) in enumerate(table.pairs.tolist()):
        matches = table.inliers[table.offsets[row] : table.offsets[row + 1]]
        if len(matches):
            moved = np.abs(np.median(keypoints[second][matches[:, 1]] - keypoints[first][matches[:, 0]], axis=0))
            shared = np.maximum(1.0 - moved / (width, height), MIN_OVERLAP)
            density[row] = len(matches) / float(shared.prod())
    return density


def usual_density(pairs: NDArray[np.int32], density: F64, position: F64, low: float, high: float) -> float:
    """Median density of the pairs within `NEAR` frames before `low` or after `high`; 0 without any.

    Args:
        pairs: (m, 2) of the sequence.
        density: (m,) of them.
        position: (n,) place of every frame in the sequence.
        low: position.
        high: position, not below `low`.
    """
    first, last = np.sort(position[pairs], axis=1).T
    near = ((first >= low - NEAR) & (last <= low)) | ((first >= high) & (last <= high + NEAR))
    near &= density > 0
    return float(np.median(density[near])) if near.any() else 0.0


def find_jumps(table: PairTable, density: F64, position: F64, n_search: int) -> list[int]:
    """Frames k of the sequence such that the picture jumps between k and k + 1.

    Cuts that no pair spans are none of them: there is nothing to be mistaken about. Nor is a blurred or dark stretch,
    whose frames match each other as badly as they match the others.
    """
    first, last = np.sort(position[table.pairs], axis=1).T
    jumps = []
    for cut in range(n_search - 1):
        across = (first <= cut) & (last > cut) & (density > 0)
        if not across.any():
            continue
        usual = usual_density(table.pairs, density, position, cut, cut + 1)
        before = (last <= cut) & (first >= cut - BESIDE)
        after = (first >= cut + 1) & (last <= cut + 1 + BESIDE)
        sharp = all(own.any() and np.median(density[own]) >= GOOD_SHARE * usual for own in (before, after))
        if sharp and density[across].max() < JUMP_SHARE * usual:
            jumps.append(cut)
    return jumps


def spans_any(table: PairTable, position: F64, jumps: Sequence[int]) -> Bool:
    """(m,) which pairs reach over a jump."""
    spans = np.zeros(len(table.pairs), bool)
    first, last = np.sort(position[table.pairs], axis=1).T
    for cut in jumps:
        spans |= (first <= cut) & (last > cut)
    return spans


def dense_enough(extra: PairTable, extra_density: F64, table: PairTable, density: F64, position: F64) -> Bool:
    """(m,) which pairs sought over gaps have the matches that their overlap asks for, by the usual of both ends."""
    enough = np.zeros(len(extra.pairs), bool)
    for row, (first, second) in enumerate(extra.pairs.tolist()):
        usual = [usual_density(table.pairs, density, position, position[end], position[end]) for end in (first, second)]
        enough[row] = extra_density[row] >= PAIR_SHARE * min(usual)
    return enough


def positions(times_s: Sequence[float], n_search: int, videos: Sequence[int] = ()) -> F64:
    """(n,) place of every frame in the sequence: its index, and for frames added later where their time falls.

    Args:
        times_s: (n,) times on one axis.
        n_search: frames of the sequence.
        videos: (n,) video of every frame; none = all are of one. A frame added later stays among those of its own.
    """
    order = np.arange(len(times_s), dtype=np.float64)
    order[n_search:] = np.interp(times_s[n_search:], times_s[:n_search], order[:n_search])
    for added in range(n_search, len(videos)):
        own = [frame for frame in range(n_search) if videos[frame] == videos[added]]
        if own:
            order[added] = np.clip(order[added], own[0], own[-1])
    return order
