"""Where to cut a model that the checks rejected, and the parts of the video that are left between the cuts.

Pairs are rejected without any model: those that a fundamental matrix explains better than a motion of the known lens,
and those that triplets contradict. Where most pairs across a place of the sequence are, it is cut. Where no place is
cut so, a check that rejects a model says at which pairs it fails: where most pairs across one place do, the two sides
are put together wrongly, and each may be right by itself. Single pairs that do not fit the model stay: they are the
evidence that the parts are judged by in their turn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.checks.joins import BROKEN_POINTS, points_across, tracks_of
from core.checks.matches import MOVED_SHARE, match_agreement
from core.checks.rotations import MAX_CUT_DEG, MIN_PAIRS_AT_CUT, disagreement, measured_rotations, model_rotations
from core.matching.bridges import components_of, select
from core.matching.cycles import contradicted
from core.matching.jumps import spans_any
from core.verification import UNCALIBRATED
from core.viewgraph import PairTable

if TYPE_CHECKING:
    import pycolmap

Bool = NDArray[np.bool_]
F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MIN_FRAMES = 12
"""A part with fewer frames shows too little to stand for itself."""
MAX_PARTS = 8
MAX_MISFIT_SHARE = 0.5
"""Where more of the pairs across a place do not fit the model, it is put together wrongly there."""


@dataclass(frozen=True)
class Pruned:
    """A view graph without what a rejected model and the triplets speak against."""

    table: PairTable
    """All pairs; those taken out are there as tried in vain."""
    n_rejected: int
    """Verified pairs taken out because no motion of the lens explains them, or because triplets contradict them."""
    cuts: Sequence[int]
    """Frames k such that nothing joins the frames up to k with those after it any more."""
    parts: Sequence[tuple[int, int]]
    """Half-open intervals of frames that still hang together, by their start; empty when nothing was taken out."""


def prune(table: PairTable, model: pycolmap.Reconstruction, position: F64, n_search: int) -> Pruned:
    """Take out what is wrong, and find the parts that are left.

    Args:
        table: pairs of ``graph.npz``.
        model: rejected (`pycolmap.Reconstruction`, image_id = index + 1).
        position: (n,) place of every frame in the sequence (`core.matching.jumps.positions`).
        n_search: frames from this on are out of order: they make no cut and no part.
    """
    rejected = table.verified & (table.config == UNCALIBRATED)
    rejected |= contradicted(select(table, ~rejected))
    # Where most pairs are rejected the others have only not been asked: they are in too few triplets.
    cuts = cut_apart(
        table.pairs[table.verified].astype(np.int64), rejected[table.verified].astype(np.float64), 0.0, n_search
    )
    # A model that was made of such pairs is bent over all its length, and would be cut at places that are right.
    cuts = cuts or find_cuts(select(table, ~rejected), model, n_search)
    rest = select(table, ~(rejected | spans_any(table, position, cuts)))
    parts = find_parts(rest, n_search) if cuts or rejected.any() else []
    return Pruned(rest, int(rejected.sum()), cuts, parts)


def find_cuts(table: PairTable, model: pycolmap.Reconstruction, n_search: int) -> list[int]:
    """Places at which the checks of rotations, matches and joins find a model (as of `prune`) put together wrongly."""
    frames, rotations = model_rotations(model)
    found = disagreement(measured_rotations(table), frames, rotations)
    agreement = match_agreement(model, table)
    ordered = frames[frames < n_search]
    broken = points_across(tracks_of(model), ordered, 0.0) < BROKEN_POINTS
    return sorted(
        {
            *cut_apart(found.pairs, found.angles_deg, MAX_CUT_DEG, n_search),
            *cut_apart(agreement.pairs, 1.0 - agreement.shares, 1.0 - MOVED_SHARE, n_search),
            *ordered[:-1][broken].tolist(),
        }
    )


def cut_apart(pairs: I64, misfit: F64, limit: float, n_search: int) -> list[int]:
    """Frames k such that across no other place most pairs misfit by more than `limit`, once it is cut at all of them.

    The place with the largest share of such pairs is cut first, of equals the one with the largest median misfit: its
    pairs also reach over its neighbours, which may be right without them.

    Args:
        pairs: (m, 2) frame indices, first below second.
        misfit: (m,) of each pair.
        limit: in the unit of `misfit`.
        n_search: pairs with a frame from this on do not count.
    """
    inside = pairs[:, 1] < n_search
    pairs, misfit = pairs[inside], misfit[inside]
    cuts: list[int] = []
    while True:
        worst = (MAX_MISFIT_SHARE, 0.0, -1)
        for frame in np.unique(pairs[:, 0]).tolist():
            across = misfit[(pairs[:, 0] <= frame) & (pairs[:, 1] > frame)]
            if len(across) >= MIN_PAIRS_AT_CUT:
                worst = max(worst, (float((across > limit).mean()), float(np.median(across)), frame))
        share, _, frame = worst
        if share <= MAX_MISFIT_SHARE:
            return sorted(cuts)
        cuts.append(frame)
        beside = (pairs[:, 1] <= frame) | (pairs[:, 0] > frame)
        pairs, misfit = pairs[beside], misfit[beside]


def find_parts(table: PairTable, n_search: int) -> list[tuple[int, int]]:
    """Half-open intervals of the frames that strong pairs join, the largest `MAX_PARTS` of them, by their start."""
    inside = select(table, np.asarray((table.pairs < n_search).all(axis=1), np.bool_))
    labels = components_of(inside, n_search)
    groups = [np.flatnonzero(labels == label) for label in np.unique(labels)]
    large = sorted((group for group in groups if len(group) >= MIN_FRAMES), key=len, reverse=True)[:MAX_PARTS]
    return sorted((int(group[0]), int(group[-1]) + 1) for group in large)
