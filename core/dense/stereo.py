"""Photometric depth maps: one view at a time from the undistorted scene."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from core.dense.cameras import Pinhole
from core.dense.maps import DenseScene, DepthMap
from core.dense.patchmatch.initial import initial_planes
from core.dense.patchmatch.matcher import (
    Effort,
    Matcher,
    coarse_to_fine,
    high_pass,
    ignore,
    packed,
    patch_mask,
    pyramid,
    relate,
    view_key,
)
from core.dense.patchmatch.planes import to_normals
from core.dense.views import DenseView
from core.settings.groups import DenseSettings

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]


@dataclass(frozen=True)
class _Image:
    """One image at all scales, finest first: as it is, as it is matched, and interleaved."""

    guides: list[U8]
    greys: list[U8]
    packed: list[NDArray[np.uint32]]


class PhotometricStereo:
    """Depth maps from photometric cost alone; keeps the images of a chunk's views at hand.

    Args:
        scene: result of `undistort`.
        settings: `levels`, `iterations`, `best_views`.
        seed: of the random choices; a view's result depends on it and on the view only.
        threads: rows are split over so many threads; the result does not depend on it.
    """

    def __init__(self, scene: DenseScene, settings: DenseSettings, seed: int, threads: int = 1) -> None:
        self._scene, self._settings, self._seed, self._threads = scene, settings, seed, threads
        self.pinholes = [scene.pinhole]
        while len(self.pinholes) < settings.levels and min(self.pinholes[-1].width, self.pinholes[-1].height) >= 128:
            self.pinholes.append(self.pinholes[-1].halved())
        inside = pyramid(scene.mask().astype(np.uint8) * 255, len(self.pinholes))
        self._masks = [patch_mask(level == 255) for level in inside]
        self._images = lru_cache(maxsize=24)(self._load)

    def _load(self, name: str) -> _Image:
        guides = pyramid(self._scene.grey(name), len(self.pinholes))
        greys = [high_pass(guide) for guide in guides]
        return _Image(guides, greys, [packed(grey) for grey in greys])

    def matcher(
        self, view: DenseView, level: int, inverse_depths: list[F32] | None = None, consistency: float = 0.0
    ) -> Matcher:
        """The matcher of one view at one scale (0 = finest)."""
        poses = self._scene.poses
        sources = relate(
            self.pinholes[level],
            poses[view.name],
            [poses[name] for name in view.sources],
            [self._images(name).packed[level] for name in view.sources],
            inverse_depths,
            consistency,
        )
        image = self._images(view.name)
        limits = (1.0 / view.depth_max, 1.0 / view.depth_min)
        key = view_key(self._seed, view.index, level)
        mask, pinhole = self._masks[level], self.pinholes[level]
        return Matcher(
            image.greys[level],
            image.guides[level],
            mask,
            pinhole,
            sources,
            limits,
            self._settings.best_views,
            key,
            self._threads,
        )

    def efforts(self) -> list[Effort]:
        """Search effort per scale, finest first: most of the search happens where it is cheap."""
        n = self._settings.iterations
        coarse = [Effort(n + 1, 6, 0.5) if i == len(self.pinholes) - 1 else Effort(n, 4, 0.05)
                  for i in range(1, len(self.pinholes))]  # fmt: skip
        finest = Effort(max(1, n - 1), 4, 0.02) if coarse else Effort(n + 2, 6, 0.5)
        return [finest, *coarse]

    def planes(self, view: DenseView, check: Callable[[float], None] = ignore) -> F32:
        """(h, w, 4) planes of one view with their costs."""
        coarsest: Pinhole = self.pinholes[-1]
        matchers = [self.matcher(view, level) for level in range(len(self.pinholes))]
        rng = np.random.default_rng(view_key(self._seed, view.index, 99))
        start = initial_planes(
            self._scene.points[view.name], self._scene.poses[view.name], coarsest, matchers[0].limits, rng
        )
        return coarse_to_fine(matchers, start, self.efforts(), check)

    def depth_map(self, view: DenseView, check: Callable[[float], None] = ignore) -> DepthMap:
        """Depth map of one view: every pixel whose patch lies inside the image has a depth."""
        return planes_to_map(self.planes(view, check), self.pinholes[0], self._masks[0])


def planes_to_map(planes: F32, pinhole: Pinhole, valid: NDArray[np.bool_]) -> DepthMap:
    """Depth, normals and cost of planes where `valid`."""
    good = valid & (planes[..., 0] > 0) & np.isfinite(planes[..., 3])
    depth = np.where(good, 1.0 / np.where(good, planes[..., 0], 1.0), 0.0).astype(np.float32)
    normal = to_normals(planes, pinhole.index_matrix())
    normal[~good] = 0.0
    return DepthMap(depth, normal, np.where(good, planes[..., 3], 2.0).astype(np.float32))
