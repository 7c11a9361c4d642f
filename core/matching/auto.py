"""One pair of frames from features to verified matches, by the method the settings name."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Generic, Literal, TypeVar

from core.errors import BadInput
from core.features.io import FrameFeatures
from core.matched_pair import LIGHTGLUE, MUTUAL_NEAREST, MatchedPair
from core.matching.mutual_nearest import Matches, mutual_nearest, unit_descriptors
from core.settings.groups import MatchSettings
from core.verification import STRONG_INLIERS, Verifier

if TYPE_CHECKING:
    from core.matching.lightglue import LightGlueMatcher

Made = TypeVar("Made")

GIVE_UP_AFTER = 2
"""Pairs in vain after which LightGlue is not tried on a frame that nothing has matched yet."""


JUMP_AFTER = 3
"""Pairs across a place of the sequence, tried in vain on frames that others match, after which LightGlue is not tried
across it: the nearest of all and the two next to it."""


class RematchPolicy:
    """Which pairs are worth LightGlue, by what came of it so far.

    A black frame would be tried with all its neighbours, and a jump of the picture with all pairs across it. Nearest
    pairs should come first: where they fail, farther ones do not succeed.
    """

    def __init__(self, n_search: int = 0) -> None:
        """Take how many frames, from the first on, are a sequence that pairs may be nearest in; 0 for none."""
        self._n_search = n_search
        self._in_vain: Counter[int] = Counter()
        self._failed: list[tuple[int, int]] = []
        self._matched: set[int] = set()
        self._joined: set[int] = set()
        """Frames k such that a strong pair joins k or one before it with one after it."""

    def gives_up(self, pair: tuple[int, int]) -> bool:
        """Whether one of the frames, or a place of the sequence between them, has been tried often enough."""
        if any(frame not in self._matched and self._in_vain[frame] >= GIVE_UP_AFTER for frame in pair):
            return True
        first, last = pair
        return last < self._n_search and any(self._is_jump(cut) for cut in range(first, last))

    def note(self, pair: tuple[int, int], outcome: MatchedPair) -> None:
        """Take in what a pair came to."""
        if len(outcome.geometry.inliers) >= STRONG_INLIERS:
            self._matched.update(pair)
            if pair[1] < self._n_search:
                self._joined.update(range(*pair))
        elif outcome.tried_lightglue:
            self._in_vain.update(pair)
            if pair[1] < self._n_search:
                self._failed.append(pair)

    def _is_jump(self, cut: int) -> bool:
        """Whether nothing reaches over a place, often enough tried on frames that others match: not on black ones."""
        if cut in self._joined:
            return False
        across = [pair for pair in self._failed if pair[0] <= cut < pair[1] and self._matched.issuperset(pair)]
        return len(across) >= JUMP_AFTER


class PairMatcher:
    """Matches and verifies pairs of frames that share one camera."""

    def __init__(self, matching: MatchSettings, verifier: Verifier, features: Literal["disk", "sift"] = "disk") -> None:
        """Refuse, as `BadInput`, LightGlue for SIFT: there are no weights for it."""
        if matching.method == "lightglue" and features != "disk":
            raise BadInput("matching.method 'lightglue' needs features.method 'disk'", where="matching.method")
        self._settings = matching
        self._use_lightglue = matching.method == "lightglue"
        self._may_rematch = matching.method == "auto" and features == "disk"
        self._verifier = verifier
        self._network: LightGlueMatcher | None = None
        self._units = _LastUsed(lambda features: unit_descriptors(features.descriptors))

    def match(self, first: FrameFeatures, second: FrameFeatures, *, rematch: bool = True) -> MatchedPair:
        """Verified matches of two frames.

        `auto` takes mutual nearest neighbours. Where too few or too small a share of them pass the
        verification, LightGlue tries again on the strongest keypoints, and the better outcome counts;
        without `rematch` it does not.
        """
        if self._use_lightglue:
            return self._verified(LIGHTGLUE, self._lightglue(first, second, None), first, second)
        matches = mutual_nearest(self._units(first), self._units(second), self._settings.ratio)
        cheap = self._verified(MUTUAL_NEAREST, matches, first, second)
        if not self._may_rematch or not rematch or not self._weak(cheap):
            return cheap
        matches = self._lightglue(first, second, self._settings.auto_keypoints)
        better = self._verified(LIGHTGLUE, matches, first, second)
        found = better if len(better.geometry.inliers) > len(cheap.geometry.inliers) else cheap
        return replace(found, tried_lightglue=True)

    def _weak(self, pair: MatchedPair) -> bool:
        inliers = len(pair.geometry.inliers)
        share = inliers / pair.n_matches if pair.n_matches else 0.0
        return inliers < self._settings.auto_min_inliers or share < self._settings.auto_min_inlier_share

    def _verified(self, method: int, matches: Matches, first: FrameFeatures, second: FrameFeatures) -> MatchedPair:
        geometry = self._verifier.verify(first.keypoints, second.keypoints, matches)
        return MatchedPair(method, len(matches), geometry)

    def _lightglue(self, first: FrameFeatures, second: FrameFeatures, strongest: int | None) -> Matches:
        from core.matching.lightglue import LightGlueMatcher  # many runs never load the network

        if self._network is None:
            self._network = LightGlueMatcher()
        return self._network.match(first, second, self._verifier.size, strongest)


class _LastUsed(Generic[Made]):
    """Remembers the results for the features used last, which neighbouring pairs share."""

    def __init__(self, make: Callable[[FrameFeatures], Made], size: int = 12) -> None:
        self._make, self._size = make, size
        self._kept: dict[int, tuple[FrameFeatures, Made]] = {}

    def __call__(self, features: FrameFeatures) -> Made:
        found = self._kept.pop(id(features), None) or (features, self._make(features))
        self._kept[id(features)] = found
        while len(self._kept) > self._size:
            del self._kept[next(iter(self._kept))]
        return found[1]
