"""Pairs that triplets contradict: around three frames that are matched with each other the rotations must close.

A pair of frames can have hundreds of inliers and a wrong motion: on an object with repeated parts, or where two frames
share too little of the picture. What no single pair shows, a third frame does (Zach, Klopschitz and Pollefeys,
"Disambiguating visual relations using loop constraints", CVPR 2010; here a count stands for their belief).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.verification import CALIBRATED, STRONG_INLIERS, UNCALIBRATED
from core.viewgraph import PairTable

Bool = NDArray[np.bool_]
I64 = NDArray[np.int64]

MOVED = (CALIBRATED, UNCALIBRATED)
"""Configurations whose rotation one motion alone explains; a plane leaves two."""
CLOSES_DEG = 5.0
"""A triplet whose rotations, one after the other, lead back to within this is consistent."""
MIN_TRIPLETS = 2
"""Fewer triplets say too little of a pair."""
MAX_OPEN_SHARE = 0.5
"""A pair with a larger share of triplets that do not close is contradicted."""


def contradicted(table: PairTable) -> Bool:
    """(m,) which strong pairs most of their triplets contradict.

    One wrong pair opens the triplets of right ones too. So the pair with the largest share of open triplets is taken
    out, of equals the one with fewer inliers, and the others are asked again without it, until none is left.
    """
    triplets, opened = _triplets(table)
    out = np.zeros(len(table.pairs), bool)
    alive = np.ones(len(triplets), bool)
    while True:
        asked = np.bincount(triplets[alive].ravel(), minlength=len(out))
        against = np.bincount(triplets[alive & opened].ravel(), minlength=len(out))
        share = np.where(asked >= MIN_TRIPLETS, against / np.maximum(asked, 1), 0.0)
        worst = int(np.lexsort((table.n_inliers, -share))[0]) if len(out) else 0
        if not len(out) or share[worst] <= MAX_OPEN_SHARE:
            return out
        out[worst] = True
        alive &= ~(triplets == worst).any(axis=1)


def _triplets(table: PairTable) -> tuple[I64, Bool]:
    """(t, 3) rows of the pairs (a, b), (b, c) and (a, c) of every triplet of strong pairs, and which do not close."""
    usable = np.isin(table.config, MOVED) & (table.n_inliers >= STRONG_INLIERS)
    row_of = {(int(a), int(b)): row for row, (a, b) in enumerate(table.pairs.tolist()) if usable[row]}
    after: dict[int, list[int]] = {}
    for a, b in row_of:
        after.setdefault(a, []).append(b)
    found = [
        (row, row_of[b, c], row_of[a, c])
        for (a, b), row in row_of.items()
        for c in after.get(b, ())
        if (a, c) in row_of
    ]
    triplets = np.array(found, np.int64).reshape(-1, 3)
    if not len(triplets):
        return triplets, np.zeros(0, bool)
    first, second, whole = (Rotation.from_quat(table.rotation_xyzw[rows]) for rows in triplets.T)
    opened: Bool = np.degrees((whole.inv() * second * first).magnitude()) > CLOSES_DEG
    return triplets, opened
