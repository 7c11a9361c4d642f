"""Matching with `auto` against LightGlue on every pair, both followed by the same verification."""

from __future__ import annotations

import random

import torch

from bench.speed.finished import FinishedRun
from bench.speed.timing import Row, Table, interleaved
from core.features.io import FrameFeatures
from core.matched_pair import LIGHTGLUE, MatchedPair
from core.matching.auto import PairMatcher
from core.matching.pairs import match_pairs
from core.settings.groups import MatchSettings
from core.verification import Verifier, read_camera

Pair = tuple[int, int]


def draw_pairs(run: FinishedRun, count: int, seed: int = 0) -> list[Pair]:
    """Pairs drawn without replacement from the whole pair list of the run, in order."""
    frames = run.frames()
    pairs = match_pairs(frames.moments_s, frames.n_search, run.settings.matching.window)
    return sorted(random.Random(seed).sample(pairs, min(count, len(pairs))))


def compare(run: FinishedRun, *, threads: int, repeat: int, n_pairs: int = 60) -> Table:
    """Match the drawn pairs with both methods, pair by pair in turn."""
    torch.set_num_threads(threads)
    pairs = draw_pairs(run, n_pairs)
    features = {frame: run.features(frame) for pair in pairs for frame in pair}
    settings = run.settings
    verifier = Verifier(read_camera(run.folder("camera")), settings.verification, settings.seed)
    methods: dict[str, MatchSettings] = {
        name: settings.matching.model_copy(update={"method": name}) for name in ("auto", "lightglue")
    }
    matchers = {name: PairMatcher(method, verifier, settings.features.method) for name, method in methods.items()}
    _warm_up(matchers, features, pairs[0])
    seconds = dict.fromkeys(matchers, 0.0)
    matched: dict[str, list[MatchedPair]] = {name: [] for name in matchers}
    for first, second in pairs:

        def work(name: str, a: FrameFeatures = features[first], b: FrameFeatures = features[second]) -> None:
            matched[name].append(matchers[name].match(a, b))

        sides = {name: (lambda name=name, work=work: work(name)) for name in matchers}
        for name, timing in interleaved(sides, repeat).items():
            seconds[name] += timing.median
    inliers = {name: sum(len(pair.geometry.inliers) for pair in found) // repeat for name, found in matched.items()}
    rematched = sum(pair.method == LIGHTGLUE for pair in matched["auto"]) // repeat
    return Table(
        "matching",
        f"{len(pairs)} pairs drawn with seed 0 over all gaps, {threads} threads, median of {repeat} for each pair",
        (
            Row("auto", seconds["auto"] / len(pairs), "s a pair"),
            Row("LightGlue on every pair", seconds["lightglue"] / len(pairs), "s a pair"),
            Row("ratio", seconds["lightglue"] / seconds["auto"], "x", "at least 10"),
            Row("verified inliers, auto", inliers["auto"]),
            Row("verified inliers, LightGlue", inliers["lightglue"]),
            Row("share of inliers", inliers["auto"] / max(1, inliers["lightglue"]), "", "at least 0.98"),
            Row("pairs where auto kept LightGlue's", rematched),
        ),
    )


def _warm_up(matchers: dict[str, PairMatcher], features: dict[int, FrameFeatures], pair: Pair) -> None:
    """Load the networks outside of the measured time, on a few keypoints."""
    few = [
        FrameFeatures(f.keypoints[:64], f.scores[:64], f.descriptors[:64])
        for f in (features[pair[0]], features[pair[1]])
    ]
    for matcher in matchers.values():
        matcher.match(*few)
