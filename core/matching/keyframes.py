"""Keyframes: frames between which the picture has moved by a useful share of its width.

A slow clip has no parallax between its neighbouring frames, however many there are. What spans, pairs and starts need
is motion of the picture, so they are counted in keyframes. Where every frame moves far enough, all frames are keyframes
and a step between keyframes is a step between frames.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from core.features.io import FrameFeatures, strongest
from core.json_files import read_json, write_json
from core.matching.mutual_nearest import mutual_nearest, unit_descriptors

ENOUGH_MOTION = 0.006
"""Median motion between neighbouring frames, as a share of the width, from which every frame is a keyframe. The slowest
stretches of clips whose lens and models are known to come out right move by so much."""

PROBES = 50
"""Places of the clip, at most, at which it is measured."""

MAX_STEP = 0.03
"""Motion of the picture between two keyframes of a slower clip, at most: so far apart that a span of 30 spans most of a
clip of a few hundred frames. At 0.9 % a step two spans of an endoscopic clip gave lenses that differ by 1.8 times."""

MIN_KEYFRAMES = 18
"""A clip that moves too little for so many keyframes gets them closer together: a span of fewer maps badly."""

CLOSER = 0.75
"""Factor by which the step shrinks until there are as many."""

MIN_STEP = 0.002
"""Steps below are the noise of keypoints: the clip does not move."""

KEYPOINTS = 400
"""Strongest keypoints per frame that are compared."""

MIN_MATCHES = 30
"""Two frames with fewer matches have lost each other."""

MATCH_RATIO = 0.9
"""Distance of the nearest over that of the second nearest descriptor, at most."""

SPACINGS = (1, 2, 4, 8)
"""Distances, in keyframes, at which keyframes that lie apart are paired."""

MIN_STRIDE = 2
"""Frames per keyframe, on average over a pair, from which it is one that the neighbouring frames do not give."""

_KEYFRAMES = "keyframes.json"

Motion = Callable[[int, int], float | None]
"""Motion of the picture from one frame to another as a share of its width; None when these have lost each other."""


@dataclass(frozen=True)
class Keyframes:
    """Which frames are keyframes, and how far the picture moved between them."""

    frames: tuple[int, ...]
    """Rising, from the first to the last frame of the search."""
    moved: tuple[float | None, ...]
    """One less: motion from each to the next as a share of the width; None where the next has lost the one before."""

    @property
    def motion_per_frame(self) -> float | None:
        """Median over the frames, each with the mean motion between its keyframes; None where nothing is known."""
        steps = np.diff(self.frames)
        rates = [m / s for m, s in zip(self.moved, steps, strict=True) for _ in range(s) if m is not None]
        return float(np.median(rates)) if rates else None


def write_keyframes(folder: Path, keyframes: Keyframes) -> None:
    """Write the keyframes into the result of `motion`."""
    write_json(folder / _KEYFRAMES, asdict(keyframes))


def read_keyframes(folder: Path) -> Keyframes:
    """What `write_keyframes` wrote."""
    found = read_json(folder / _KEYFRAMES)
    return Keyframes(tuple(found["frames"]), tuple(found["moved"]))


def picture_motion(width: int, load: Callable[[int], FrameFeatures]) -> Motion:
    """Median displacement between the matches of two frames.

    Args:
        width: of the frames, px.
        load: features of a frame, at least the strongest.
    """

    def motion(a: int, b: int) -> float | None:
        first, second = (strongest(load(frame), KEYPOINTS) for frame in (a, b))
        matches = mutual_nearest(unit_descriptors(first.descriptors), unit_descriptors(second.descriptors), MATCH_RATIO)
        if len(matches) < MIN_MATCHES:
            return None
        moved = second.keypoints[matches[:, 1]] - first.keypoints[matches[:, 0]]
        return float(np.median(np.linalg.norm(moved, axis=1))) / width

    return motion


def choose_keyframes(n_frames: int, motion: Motion) -> Keyframes:
    """All frames of a clip that moves enough; of a slower one keyframes at most `MAX_STEP` apart.

    They are closer where that leaves fewer than `MIN_KEYFRAMES`.

    Args:
        n_frames: frames of the search, in order.
        motion: see `Motion`; asked a few times per keyframe, with the first frame before the second.
    """
    known: dict[tuple[int, int], float | None] = {}

    def measured(a: int, b: int) -> float | None:
        if (a, b) not in known:
            known[a, b] = motion(a, b)
        return known[a, b]

    places = np.unique(np.linspace(0, max(n_frames - 2, 0), PROBES).round().astype(int)).tolist()
    probed = [measured(place, place + 1) for place in places if place + 1 < n_frames]
    if np.median([np.inf if moved is None else moved for moved in probed] or [0.0]) >= ENOUGH_MOTION:
        return _measured(range(n_frames), measured)
    limit = MAX_STEP
    while True:
        frames = [0] if n_frames else []
        while frames and frames[-1] < n_frames - 1:
            frames.append(_next(frames[-1], n_frames - 1, limit, measured))
        if len(frames) >= min(MIN_KEYFRAMES, n_frames) or limit <= MIN_STEP:
            break
        limit *= CLOSER
    return _measured(frames, measured)


def _measured(frames: Sequence[int], motion: Motion) -> Keyframes:
    return Keyframes(tuple(frames), tuple(motion(a, b) for a, b in pairwise(frames)))


def _next(key: int, last: int, limit: float, motion: Motion) -> int:
    """The farthest frame within the limit, found by doubling the gap and bisecting; the following frame at least."""

    def within(frame: int) -> bool:
        moved = motion(key, frame)
        return moved is not None and moved <= limit

    good, bad, gap = key, last + 1, 1
    while good < last and bad > last:
        ahead = min(key + gap, last)
        good, bad = (ahead, bad) if within(ahead) else (good, ahead)
        gap *= 2
    while good < last and bad - good > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if within(middle) else (good, middle)
    return max(good, key + 1)


def keyframe_pairs(frames: Sequence[int]) -> list[tuple[int, int]]:
    """Pairs of keyframes at `SPACINGS` where they lie `MIN_STRIDE` frames apart or more, sorted.

    Args:
        frames: the keyframes, rising; none are paired where neighbouring frames are keyframes.
    """
    return sorted(
        (frames[i], frames[i + spacing])
        for spacing in SPACINGS
        for i in range(len(frames) - spacing)
        if frames[i + spacing] - frames[i] >= MIN_STRIDE * spacing
    )
