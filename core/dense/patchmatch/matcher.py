"""The loop over scales and sweeps that turns one image and its sources into a depth map."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial

import cv2
import numpy as np
from numpy.typing import ArrayLike, NDArray

from core.dense.cameras import Pinhole
from core.dense.patchmatch.kernels import RADIUS, Patch, Sources, pack, scratch
from core.dense.patchmatch.planes import upsample
from core.dense.patchmatch.smooth import fit_rows
from core.dense.patchmatch.sweep import offer_rows, score_rows, sweep_rows
from core.geometry.pose import Pose

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]
Mask = NDArray[np.bool_]

COLOUR_SIGMA = 30.0
"""Grey levels; the bilateral weight of a sample falls off with its difference to the centre."""

HIGH_PASS_SIGMA_PX, HIGH_PASS_GAIN = 2.0, 3.0
SMOOTH_MARGIN = 0.05
"""A plane fitted to the neighbourhood may cost so much more than the pixel's own."""
FIT_RADIUS = 3
FIT_TOLERANCE = (0.02, 0.005)
"""Relative inverse depth by which neighbours may differ in the two rounds of a fit."""


@dataclass(frozen=True)
class Effort:
    """How hard one scale is searched. `step` is the share of the depth range that refinement spans."""

    sweeps: int
    draws: int
    step: float


def pyramid(grey: U8, levels: int) -> list[U8]:
    """The image and its halvings by 2 x 2 means, finest first."""
    out = [np.ascontiguousarray(grey)]
    for _ in range(levels - 1):
        h, w = out[-1].shape
        even = out[-1][: h // 2 * 2, : w // 2 * 2]
        out.append(np.asarray(cv2.resize(even, (w // 2, h // 2), interpolation=cv2.INTER_AREA), dtype=np.uint8))
    return out


def high_pass(grey: U8) -> U8:
    """What is matched instead of the grey values: their difference to a local mean, amplified.

    A light at the camera's tip puts smooth highlights on bare metal that move with the camera; matched as they are they
    give a consistent but wrong depth. What varies faster than a highlight is paint, scratches and grain.
    """
    values = grey.astype(np.float32)
    detail = (values - cv2.GaussianBlur(values, (0, 0), HIGH_PASS_SIGMA_PX)) * HIGH_PASS_GAIN
    return np.asarray(np.clip(np.rint(128.0 + detail), 0, 255), dtype=np.uint8)


def packed(grey: U8) -> NDArray[np.uint32]:
    """(h * w,) interleaved image for the kernels."""
    out = np.empty(grey.size, np.uint32)
    pack(grey, out)
    return out


def patch_mask(inside: Mask) -> Mask:
    """Pixels whose whole patch lies inside the lens's picture and the image."""
    size = 2 * RADIUS + 1
    eroded = cv2.erode(inside.astype(np.uint8), np.ones((size, size), np.uint8), borderValue=0)
    return np.asarray(eroded > 0)


def relate(
    pinhole: Pinhole,
    reference: Pose,
    sources: Sequence[Pose],
    images: Sequence[NDArray[np.uint32]],
    inverse_depths: Sequence[F32] | None = None,
    consistency: float = 0.0,
) -> Sources:
    """Stack source images of one scale with their warps from the reference."""
    K = pinhole.index_matrix()
    inverse_K = np.linalg.inv(K)
    A, b, back, shift = [], [], [], []
    for pose in sources:
        moved = pose.relative_to(reference)
        R, t = moved.R, moved.t
        A.append(K @ R @ inverse_K)
        b.append(K @ t)
        back.append(K @ R.T @ inverse_K)
        shift.append(-K @ R.T @ t)
    maps = np.zeros((len(sources), 1, 1)) if inverse_depths is None else np.stack(list(inverse_depths))
    grey = np.concatenate(list(images))
    return Sources(_f32(A), _f32(b), grey, _f32(maps), _f32(back), _f32(shift), np.float32(consistency))


def _f32(values: ArrayLike) -> F32:
    return np.ascontiguousarray(values, dtype=np.float32)


@dataclass(frozen=True)
class Matcher:
    """Sweeps over the planes of one reference image at one scale."""

    grey: U8
    """(h, w) what is matched, see `high_pass`."""
    guide: U8
    """(h, w) the picture itself: its edges bound the patches."""
    mask: Mask
    pinhole: Pinhole
    sources: Sources
    limits: tuple[float, float]
    """Smallest and largest inverse depth."""
    best_views: int
    key: int
    """Random key of this view and scale."""
    threads: int = 1

    def score(self, planes: F32) -> NDArray[np.uint8]:
        """Fill channel 3 of (h, w, 4) planes with their costs; returns the (h, w, 2) best sources.

        Pixels outside the mask and without a plane are left as they are.
        """
        pairs = np.zeros((*planes.shape[:2], 2), np.uint8)
        pairs[..., 1] = min(1, len(self.sources.A) - 1)
        weight = _colour_weight()

        def work(y0: int, y1: int) -> None:
            score_rows(planes, pairs, self.grey, self.guide, self.mask, self.sources, self._scratch(), weight, y0, y1)

        self._over_rows(work)
        return pairs

    def sweep(self, planes: F32, pairs: NDArray[np.uint8], number: int, step: float, draws: int) -> None:
        """One red and one black half-sweep over planes and best sources, in place."""
        K = self.pinhole.index_matrix()
        lens = np.array([K[0, 0], K[0, 2], K[1, 2]], np.float32)
        limits = np.array(self.limits, np.float32)
        weight, size = _colour_weight(), np.float32(step)

        def work(colour: int, key: np.uint64, y0: int, y1: int) -> None:
            sweep_rows(
                planes, pairs, self.grey, self.guide, self.mask, self.sources, self._scratch(), weight,
                lens, limits, colour, key, size, draws, y0, y1,
            )  # fmt: skip

        for colour in (0, 1):
            self._over_rows(partial(work, colour, np.uint64(_mix(self.key, 2 * number + colour))))

    def offer(self, planes: F32, pairs: NDArray[np.uint8], others: F32, margin: float = 0.0) -> None:
        """Take each of the (n, h, w, 4) `others` that costs less than the pixel's plane plus `margin`; in place."""
        weight, more = _colour_weight(), np.float32(margin)

        def work(y0: int, y1: int) -> None:
            offer_rows(
                planes, pairs, others, more, self.grey, self.guide, self.mask, self.sources, self._scratch(), weight,
                y0, y1,
            )  # fmt: skip

        self._over_rows(work)

    def smooth(self, planes: F32, pairs: NDArray[np.uint8]) -> None:
        """Take the local plane fit of every pixel where it matches about as well; in place."""
        self.offer(planes, pairs, fit_planes(planes, self.mask, self.threads)[np.newaxis], SMOOTH_MARGIN)

    def _scratch(self) -> Patch:
        return scratch(len(self.sources.A), min(self.best_views, len(self.sources.A)))

    def _over_rows(self, work: Callable[[int, int], object]) -> None:
        over_rows(work, self.grey.shape[0], self.threads)


def over_rows(work: Callable[[int, int], object], height: int, threads: int) -> None:
    """Call `work(y0, y1)` on blocks of rows, side by side when there are threads for it."""
    if threads <= 1:
        work(0, height)
        return
    edges = np.linspace(0, height, 4 * threads + 1).astype(int)
    with ThreadPoolExecutor(threads) as pool:
        list(pool.map(work, edges[:-1].tolist(), edges[1:].tolist()))


def fit_planes(planes: F32, valid: Mask, threads: int = 1) -> F32:
    """(h, w, 4) local plane fits of the valid pixels, see `smooth.fit_rows`; costs are those of `planes`."""
    out = planes.copy()
    wide, narrow = np.float32(FIT_TOLERANCE[0]), np.float32(FIT_TOLERANCE[1])
    over_rows(lambda y0, y1: fit_rows(planes, valid, FIT_RADIUS, wide, narrow, out, y0, y1), len(planes), threads)
    return out


def _colour_weight() -> F32:
    return np.exp(-(np.arange(256.0) ** 2) / (2.0 * COLOUR_SIGMA**2)).astype(np.float32)


def _mix(*parts: int) -> int:
    """One 64-bit key of several small numbers."""
    value = 0
    for part in parts:
        value = ((value ^ part) * 0x9E3779B97F4A7C15 + 0x632BE59BD9B4E019) & 0xFFFFFFFFFFFFFFFF
    return value


def view_key(seed: int, index: int, level: int) -> int:
    """Random key of one view and scale."""
    return _mix(seed + 1, index + 1, level + 1)


def ignore(done: float) -> None:
    """Discard progress."""


def coarse_to_fine(
    matchers: Sequence[Matcher],
    start: F32,
    efforts: Sequence[Effort],
    check: Callable[[float], None] = ignore,
) -> F32:
    """(h, w, 4) planes of the finest scale.

    Args:
        matchers: one a scale, finest first.
        start: (h, w, 4) planes of the coarsest scale.
        efforts: one a scale, finest first.
        check: called between sweeps with the share done; may raise to stop.
    """
    planes = start
    total = sum(effort.sweeps * 4.0**-level for level, effort in enumerate(efforts))
    done = 0.0
    for level in range(len(matchers) - 1, -1, -1):
        matcher, effort = matchers[level], efforts[level]
        if level < len(matchers) - 1:
            planes = upsample(planes, matcher.pinhole.width, matcher.pinhole.height)
        planes[..., 3] = np.float32(np.inf)
        pairs = matcher.score(planes)
        for number in range(effort.sweeps):
            matcher.sweep(planes, pairs, number, effort.step * 0.5**number, effort.draws)
            done += 4.0**-level
            check(done / total)
        matcher.smooth(planes, pairs)
    return planes
