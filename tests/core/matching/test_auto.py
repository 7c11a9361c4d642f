from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from core.errors import BadInput
from core.features.io import FrameFeatures
from core.matched_pair import LIGHTGLUE, MUTUAL_NEAREST
from core.matching.auto import GIVE_UP_AFTER, PairMatcher, RematchPolicy
from core.matching.lightglue import LightGlueMatcher, rename
from core.settings import make_settings
from core.verification import Verifier
from tests.core.making_views import bumpy_points, fisheye, pose, true_matches, view


def _matcher(**options: Any) -> PairMatcher:
    settings = make_settings(options={name.replace("__", "."): value for name, value in options.items()})
    return PairMatcher(settings.matching, Verifier(fisheye(), settings.verification), settings.features.method)


def _frames(blur: float) -> tuple[FrameFeatures, FrameFeatures, np.ndarray]:
    """Two views whose points carry random descriptors, disturbed by `blur`; and the true matches."""
    points = bumpy_points(250)
    rng = np.random.default_rng(4)
    descriptors = rng.normal(size=(len(points), 128))
    frames, seen = [], []
    for i in (0, 2):
        keypoints, visible = view(points, pose(i), seed=i)
        mine = descriptors[visible] + blur * rng.normal(size=(len(visible), 128))
        mine /= np.linalg.norm(mine, axis=1, keepdims=True)
        scores = np.linspace(2, 1, len(visible), dtype=np.float32)
        frames.append(FrameFeatures(keypoints, scores, mine.astype(np.float16)))
        seen.append(visible)
    return frames[0], frames[1], true_matches(seen[0], seen[1])


@pytest.fixture(autouse=True)
def _one_thread() -> None:
    torch.set_num_threads(1)


def test_good_pairs_never_see_lightglue() -> None:
    first, second, truth = _frames(blur=0.1)
    found = _matcher(matching__method="auto").match(first, second)
    assert found.method == MUTUAL_NEAREST
    assert len(found.geometry.inliers) > 0.95 * len(truth)


def test_weak_pairs_are_tried_again_and_the_better_outcome_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    first, second, truth = _frames(blur=1.6)  # most nearest neighbours are wrong
    asked: list[int | None] = []

    def match(self: LightGlueMatcher, a: FrameFeatures, b: FrameFeatures, size: Any, strongest: int | None) -> Any:
        asked.append(strongest)
        assert size == (640, 480)
        return truth

    monkeypatch.setattr(LightGlueMatcher, "match", match)
    cheap = _matcher(matching__method="mutual_nearest").match(first, second)
    options = {"matching__method": "auto", "matching__auto_min_inliers": 150, "matching__auto_keypoints": 99}
    found = _matcher(**options).match(first, second)
    assert asked == [99]
    assert found.method == LIGHTGLUE
    assert len(found.geometry.inliers) > len(cheap.geometry.inliers)

    truth = truth[:5]  # LightGlue fails too: what there was is kept
    kept = _matcher(**options).match(first, second)
    assert kept.method == MUTUAL_NEAREST
    np.testing.assert_array_equal(kept.geometry.inliers, cheap.geometry.inliers)


def test_a_frame_is_given_up_unless_something_matched_it() -> None:
    first, second, _ = _frames(blur=0.1)
    good = _matcher(matching__method="mutual_nearest").match(first, second)
    poor = replace(good, geometry=replace(good.geometry, inliers=good.geometry.inliers[:9]), tried_lightglue=True)
    policy = RematchPolicy()
    for other in range(GIVE_UP_AFTER):
        assert not policy.gives_up((1, 9))
        policy.note((other, 9), replace(poor, tried_lightglue=False))  # the cheap way says nothing about LightGlue
        policy.note((other, 9), poor)
    assert policy.gives_up((1, 9))
    assert policy.gives_up((9, 10))
    assert not policy.gives_up((0, 1))
    policy.note((8, 9), good)
    assert not policy.gives_up((9, 10))


def tried_in_order(
    n_frames: int, window: int, n_search: int, strong: Callable[[int, int], bool]
) -> list[tuple[int, int]]:
    """Pairs that LightGlue is tried on where the cheap way matches none but those that `strong` names."""
    first, second, _ = _frames(blur=0.1)
    good = _matcher(matching__method="mutual_nearest").match(first, second)
    poor = replace(good, geometry=replace(good.geometry, inliers=good.geometry.inliers[:9]), tried_lightglue=True)
    policy, tried = RematchPolicy(n_search), list[tuple[int, int]]()
    for pair in [(a, a + gap) for gap in range(1, window + 1) for a in range(n_frames - gap)]:
        if strong(*pair):
            policy.note(pair, good)
        elif not policy.gives_up(pair):
            tried.append(pair)
            policy.note(pair, poor)
    return tried


def test_a_jump_is_tried_on_the_three_nearest_pairs_across_it() -> None:
    tried = tried_in_order(12, 5, 12, lambda a, b: (a < 6) == (b < 6))
    assert tried == [(5, 6), (4, 6), (5, 7)]
    assert len(tried_in_order(12, 5, 0, lambda a, b: (a < 6) == (b < 6))) == 15  # where nothing says which are nearest


def test_pairs_over_a_black_frame_are_no_jump() -> None:
    tried = tried_in_order(12, 5, 12, lambda a, b: (a < 6) == (b < 6) and 6 not in (a, b))
    assert [pair for pair in tried if 6 in pair] == [(5, 6), (6, 7)]
    across = [pair for pair in tried if 6 not in pair]
    assert across == [(5, 7), (4, 7), (5, 8)]


def test_a_place_that_one_pair_reaches_over_is_tried_on_all() -> None:
    tried = tried_in_order(12, 5, 12, lambda a, b: (a < 6) == (b < 6) or (a, b) == (5, 6))
    assert len(tried) == 14


def test_without_a_rematch_the_cheap_outcome_stays(monkeypatch: pytest.MonkeyPatch) -> None:
    first, second, truth = _frames(blur=1.6)
    monkeypatch.setattr(LightGlueMatcher, "match", lambda *_: truth)
    matcher = _matcher(matching__method="auto", matching__auto_min_inliers=150)
    kept, again = matcher.match(first, second, rematch=False), matcher.match(first, second)
    assert (kept.method, kept.tried_lightglue) == (MUTUAL_NEAREST, False)
    assert (again.method, again.tried_lightglue) == (LIGHTGLUE, True)


def test_lightglue_for_sift_is_refused_and_auto_stays_cheap() -> None:
    with pytest.raises(BadInput, match="disk"):
        _matcher(matching__method="lightglue", features__method="sift")
    first, second, _ = _frames(blur=1.6)
    found = _matcher(matching__method="auto", matching__auto_min_inliers=500, features__method="sift")
    assert found.match(first, second).method == MUTUAL_NEAREST


def test_lightglue_runs_with_the_weights_of_the_wheel() -> None:
    first, second, truth = _frames(blur=0.0)
    matches = LightGlueMatcher().match(first, second, (640, 480), 60)
    assert matches.dtype == np.uint32
    assert matches.max(initial=0) < 60
    right = {tuple(row) for row in truth.tolist()}
    assert len(matches) > 10
    assert np.mean([tuple(row) in right for row in matches.tolist()]) > 0.8


def test_weights_are_renamed() -> None:
    assert rename("self_attn.3.Wqkv.weight") == "transformers.3.self_attn.Wqkv.weight"
    assert rename("cross_attn.0.to_qk.bias") == "transformers.0.cross_attn.to_qk.bias"
    assert rename("posenc.Wr.weight") == "posenc.Wr.weight"
