"""What matching a pair of frames comes to; without any matcher, so that who reads it loads none."""

from __future__ import annotations

from dataclasses import dataclass

from core.verification import TwoViewGeometry

MUTUAL_NEAREST = 0
LIGHTGLUE = 1


@dataclass(frozen=True)
class MatchedPair:
    """Outcome of one pair."""

    method: int
    """`MUTUAL_NEAREST` or `LIGHTGLUE`: whose matches these are."""
    n_matches: int
    """Matches before verification."""
    geometry: TwoViewGeometry
    tried_lightglue: bool = False
