"""Geometric consistency: depth maps corrected by, and filtered against, those of the source views."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from core.dense.maps import DenseScene, DepthMap, read_map
from core.dense.patchmatch.jit import kernel
from core.dense.patchmatch.kernels import Sources, forward_backward
from core.dense.patchmatch.matcher import Matcher, fit_planes, ignore
from core.dense.patchmatch.planes import from_normals
from core.dense.patchmatch.transfer import planes_from_source
from core.dense.stereo import PhotometricStereo, planes_to_map
from core.dense.views import DenseView
from core.settings.groups import DenseSettings

f32 = np.float32
F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]


@kernel
def count_consistent(planes: F32, sources: Sources, cosines: F32, max_error: np.float32, out: U8) -> None:
    """Count, for every pixel with a plane, the sources that see the same place.

    A source agrees when its own depth leads back to within `max_error` px of the pixel and the two rays meet under
    an angle whose cosine is at most `cosines`[0].

    Args:
        planes: (h, w, 4); pixels with w <= 0 get 0.
        sources: `kernels.Sources` with depth maps.
        cosines: (1 + 3 S + 3,) float32: the largest cosine, then f, cx, cy, then the centres of the sources in the
            reference's camera frame.
        out: (h, w) uint8 counts.
    """
    H, W = planes.shape[:2]
    A, b = sources.A, sources.b
    S = A.shape[0]
    f, cx, cy = cosines[1], cosines[2], cosines[3]
    for v in range(H):
        for u in range(W):
            w = planes[v, u, 0]
            n = 0
            if w > f32(0):
                rx, ry = (f32(u) - cx) / f, (f32(v) - cy) / f
                px, py, pz = rx / w, ry / w, f32(1) / w
                for s in range(S):
                    Z = A[s, 2, 0] * f32(u) + A[s, 2, 1] * f32(v) + A[s, 2, 2] + b[s, 2] * w
                    if f32(1e-3) >= Z:
                        continue
                    x = (A[s, 0, 0] * f32(u) + A[s, 0, 1] * f32(v) + A[s, 0, 2] + b[s, 0] * w) / Z
                    y = (A[s, 1, 0] * f32(u) + A[s, 1, 1] * f32(v) + A[s, 1, 2] + b[s, 1] * w) / Z
                    if x < f32(0) or y < f32(0) or x > f32(W - 1) or y > f32(H - 1):
                        continue
                    if forward_backward(s, x, y, f32(u), f32(v), sources) > max_error:
                        continue
                    ox, oy, oz = px - cosines[4 + 3 * s], py - cosines[5 + 3 * s], pz - cosines[6 + 3 * s]
                    dot = px * ox + py * oy + pz * oz
                    length = np.sqrt((px * px + py * py + pz * pz) * (ox * ox + oy * oy + oz * oz))
                    if dot <= cosines[0] * length:
                        n += 1
            out[v, u] = n


CONSISTENCY_WEIGHT = 0.2
"""Cost of one px of forward-backward error (COLMAP 0.3; 0.1 - 0.3 in the literature)."""
MAX_ERROR_PX = 1.0
"""Forward-backward error of an agreeing source (COLMAP's filter)."""
DRAWS = 3
STEP = 0.01


class GeometricFilter:
    """Depth maps with geometric consistency.

    Args:
        scene: result of `undistort`.
        settings: of the dense stage.
        maps: path of the photometric depth map of every view, by image name.
        seed: of the random choices.
        threads: rows are split over so many threads.
    """

    def __init__(
        self, scene: DenseScene, settings: DenseSettings, maps: dict[str, Path], seed: int, threads: int = 1
    ) -> None:
        self._scene, self._settings, self._maps = scene, settings, maps
        # Only the finest scale takes part here.
        self._stereo = PhotometricStereo(scene, settings.model_copy(update={"levels": 1}), seed, threads)
        self._planes = lru_cache(maxsize=16)(self._load)

    def _load(self, name: str) -> F32:
        """(h, w, 4) planes of a view; zeros for a view without a depth map."""
        pinhole = self._scene.pinhole
        if name not in self._maps:
            return np.zeros((pinhole.height, pinhole.width, 4), np.float32)
        found = read_map(self._maps[name])
        return from_normals(found.depth, found.normal, pinhole.index_matrix())

    def depth_map(self, view: DenseView, check: Callable[[float], None] = ignore) -> DepthMap:
        """The corrected and filtered depth map of one view."""
        settings, pinhole = self._settings, self._scene.pinhole
        planes = self._planes(view.name).copy()
        inverse = [np.ascontiguousarray(self._planes(name)[..., 0]) for name in view.sources]
        matcher = self._stereo.matcher(view, 0, inverse, CONSISTENCY_WEIGHT)
        if settings.geometric_passes:
            self._correct(view, matcher, planes, check)
        self._stereo.matcher(view, 0).score(planes)
        agreeing = self._agreeing(view, planes, matcher.sources)
        cost = planes[..., 3]
        keep = matcher.mask & (planes[..., 0] > 0) & (cost <= 1.0 - settings.min_ncc)
        keep &= agreeing >= min(settings.min_consistent, len(view.sources))
        return planes_to_map(fit_planes(planes, keep), pinhole, keep)

    def _correct(self, view: DenseView, matcher: Matcher, planes: F32, check: Callable[[float], None]) -> None:
        """Try the planes of the source views, then sweep with the consistency cost; in place."""
        passes = self._settings.geometric_passes
        planes[..., 3] = np.float32(np.inf)
        pairs = matcher.score(planes)
        poses, pinhole = self._scene.poses, self._scene.pinhole
        others = [
            planes_from_source(self._planes(name), pinhole, poses[view.name], poses[name], matcher.limits)
            for name in view.sources
            if name in self._maps
        ]
        if others:
            matcher.offer(planes, pairs, np.stack(others))
        for number in range(passes):
            matcher.sweep(planes, pairs, 100 + number, STEP * 0.5**number, DRAWS)
            check((number + 1) / (passes + 1))
        matcher.smooth(planes, pairs)

    def _agreeing(self, view: DenseView, planes: F32, sources: Sources) -> NDArray[np.uint8]:
        """(h, w) number of sources that agree."""
        K = self._scene.pinhole.index_matrix()
        reference = self._scene.poses[view.name]
        centers = [reference.R @ self._scene.poses[name].center + reference.t for name in view.sources]
        cosine = np.cos(np.radians(self._settings.min_triangulation_deg))
        packed = np.array([cosine, K[0, 0], K[0, 2], K[1, 2], *np.ravel(centers)], np.float32)
        out = np.zeros(planes.shape[:2], np.uint8)
        count_consistent(planes, sources, packed, np.float32(MAX_ERROR_PX), out)
        return out
