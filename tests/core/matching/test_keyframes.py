from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import ArrayLike

from core.features.io import FrameFeatures
from core.matching.keyframes import (
    MAX_STEP,
    MIN_KEYFRAMES,
    Keyframes,
    choose_keyframes,
    keyframe_pairs,
    picture_motion,
    read_keyframes,
    write_keyframes,
)

WIDTH = 320


def along(place: ArrayLike, lost: tuple[int, ...] = ()) -> Callable[[int, int], float | None]:
    """Motion of a picture at these places, as shares of its width; no match reaches over the frames in `lost`."""

    places = np.asarray(place, np.float64)

    def motion(a: int, b: int) -> float | None:
        assert a < b
        return None if any(a < frame <= b for frame in lost) else float(abs(places[b] - places[a]))

    return motion


def features(shift_px: float, seed: int = 3, count: int = 200) -> FrameFeatures:
    """Keypoints that are the same but for a shift; another seed gives others."""
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, WIDTH, (count, 2)) + np.array([shift_px, 0.0])
    descriptors = rng.normal(size=(count, 32))
    descriptors /= np.linalg.norm(descriptors, axis=1, keepdims=True)
    return FrameFeatures(
        xy.astype(np.float32), np.linspace(1, 0.1, count, dtype=np.float32), descriptors.astype(np.float16)
    )


@pytest.mark.parametrize("per_frame", [0.0065, 0.04, 0.3])
def test_every_frame_of_an_ordinary_clip_is_a_keyframe(per_frame: float) -> None:
    found = choose_keyframes(60, along(per_frame * np.arange(60)))
    assert found.frames == tuple(range(60))
    assert found.motion_per_frame == pytest.approx(per_frame)
    assert keyframe_pairs(found.frames) == []


def test_a_slow_clip_has_keyframes_as_far_apart_as_the_step_allows() -> None:
    found = choose_keyframes(201, along(0.0052 * np.arange(201)))
    assert set(np.diff(found.frames)[:-1]) == {5}
    assert found.frames[-1] == 200
    assert max(moved for moved in found.moved if moved is not None) <= MAX_STEP
    assert found.motion_per_frame == pytest.approx(0.0052)


def test_a_clip_with_little_motion_in_all_gets_closer_keyframes() -> None:
    found = choose_keyframes(90, along(0.0004 * np.arange(90)))
    assert MIN_KEYFRAMES <= len(found.frames) < 2 * MIN_KEYFRAMES
    assert len(choose_keyframes(9, along(0.001 * np.arange(9))).frames) == 9


def test_keyframes_lie_where_a_camera_that_stops_moves() -> None:
    place = np.concatenate([0.02 * np.arange(20), np.full(60, 0.38), 0.38 + 0.02 * np.arange(1, 21)])
    found = choose_keyframes(100, along(place))
    still = [frame for frame in found.frames if 21 <= frame < 78]
    assert len(still) <= 1
    assert {*range(19), *range(82, 100)} <= set(found.frames)


def test_a_camera_that_seldom_stops_keeps_all_frames() -> None:
    place = np.concatenate([0.02 * np.arange(40), np.full(20, 0.78), 0.78 + 0.02 * np.arange(1, 41)])
    assert choose_keyframes(100, along(place)).frames == tuple(range(100))


def test_a_lost_match_ends_the_gap() -> None:
    found = choose_keyframes(100, along(0.001 * np.arange(100), lost=(40, 41)))
    assert {39, 40, 41} <= set(found.frames)
    lost = {found.frames[i + 1] for i, moved in enumerate(found.moved) if moved is None}
    assert lost == {40, 41}
    nothing = choose_keyframes(30, lambda a, b: None)
    assert nothing.frames == tuple(range(30))
    assert nothing.motion_per_frame is None


def test_a_clip_that_stands_still_ends() -> None:
    assert choose_keyframes(50, lambda a, b: 0.0).frames == (0, 49)
    assert choose_keyframes(1, lambda a, b: 0.0).frames == (0,)
    assert choose_keyframes(0, lambda a, b: 0.0).frames == ()


def test_the_same_path_at_another_rate_has_keyframes_at_the_same_places() -> None:
    fast = choose_keyframes(480, along(0.0019 * np.arange(480)))
    slow = choose_keyframes(160, along(0.0057 * np.arange(160)))
    assert np.array(fast.frames)[:-1] == pytest.approx(3 * np.array(slow.frames)[:-1])


def test_the_cost_grows_with_the_keyframes_and_not_with_the_frames() -> None:
    asked: list[tuple[int, int]] = []

    def motion(a: int, b: int) -> float:
        asked.append((a, b))
        return 0.0005 * (b - a)

    found = choose_keyframes(3000, motion)
    assert len(asked) <= 50 + 13 * len(found.frames)
    assert len(asked) == len(set(asked))


def test_keyframes_are_paired_at_several_spacings_only_where_they_lie_apart() -> None:
    frames = [*range(20), *range(20, 100, 4)]
    pairs = keyframe_pairs(frames)
    assert pairs == sorted(set(pairs))
    assert min(a for a, _ in pairs) > 10
    assert {(60, 64), (60, 68), (60, 76), (60, 92)} <= set(pairs)


def test_motion_is_the_median_displacement_as_a_share_of_the_width() -> None:
    frames = [features(0.0), features(8.0), features(0.0, seed=4), features(8.0, count=20)]
    motion = picture_motion(WIDTH, lambda frame: frames[frame])
    assert motion(0, 1) == pytest.approx(8.0 / WIDTH, rel=1e-3)
    assert motion(0, 2) is None
    assert motion(1, 3) is None


def test_keyframes_come_back_from_their_file(tmp_path: Path) -> None:
    keyframes = Keyframes((0, 3, 7), (0.01, None))
    write_keyframes(tmp_path, keyframes)
    assert read_keyframes(tmp_path) == keyframes
