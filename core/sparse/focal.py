"""The focal length, found from the video: map small spans from a start value and let the mapper refine it.

The lens is modelled with one radial term here (with the default model SIMPLE_RADIAL_FISHEYE: an equidistant lens and
k1): a short span does not determine more, and k1 to k4 beside a free focal length would trade against it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from itertools import groupby

import numpy as np
import pycolmap

from core.checks.stats import model_stats
from core.features.io import FrameFeatures, strongest
from core.geometry.lens import lens_of
from core.matched_pair import MatchedPair
from core.matching.auto import PairMatcher
from core.matching.mutual_nearest import mutual_nearest, unit_descriptors
from core.products.front import FocalProduct, FocalSpan
from core.scene.frame import image_name
from core.settings import Settings
from core.sparse.initial_pair import rank_initial_pairs
from core.sparse.lens import MAX_K1
from core.sparse.mapper import best_model, map_images, mapper_options
from core.sparse.parallax import MIN_RESIDUAL_PX, rotation_residual_px
from core.sparse.tracks import build_tracks, thin_cache
from core.sparse.view_graph import Frames, within
from core.verification import Verifier
from core.viewgraph import PairTable, make_table

KEYPOINTS = 1000
"""Strongest keypoints per frame that take part."""

GAPS = (1, 2, 4, 7)
"""Differences of the matched pairs in keyframes: wide ones fix the focal length, narrow ones hold the chain."""

WIDER_GAPS = (10, 14)
"""Further differences, tried where a span comes apart: its motion shows too little depth over the others."""

ENOUGH_SHARE = 0.8
"""A span of which a smaller share maps is tried again with the wider pairs too."""

PROBE_GAP, PROBE_KEYPOINTS, PROBES = 4, 400, 8
"""Spans are chosen by one pair of frames each: this far apart, with so many keypoints; so many per section."""

ENOUGH_MATCHES, ENOUGH_MOTION_PX = 150, 40.0
"""Matches and median motion of the probed pair beyond which a span is no better."""

Load = Callable[[int], FrameFeatures]
Report = Callable[[float, str], None]


@dataclass(frozen=True)
class SpanFocal:
    """What one span says. A span without a model has 0 registered images and the start's focal length."""

    start: int
    """Its first frame."""
    end: int
    """One more than its last frame."""
    frames: int
    """Keyframes in it: those that are mapped."""
    focal_px: float
    k1: float
    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    mean_reprojection_error_px: float

    @property
    def is_lens(self) -> bool:
        """Whether the radial term is one that a lens may have."""
        return abs(self.k1) < MAX_K1

    @property
    def is_whole(self) -> bool:
        """Whether enough of the span maps."""
        return self.registered_images >= ENOUGH_SHARE * self.frames


def choose_spans(
    keyframes: Sequence[int], length: int, count: int, load: Load, videos: Sequence[int] | None = None
) -> list[tuple[int, ...]]:
    """The keyframes of spans of `length` of them, the liveliest of each of `count` equal sections of the clip.

    Lively is a pair of keyframes in the middle of the span that matches well and moved far in the image. A span lies in
    one video: where a section has none so long, the span is the longer part of the liveliest.

    Args:
        keyframes: rising frame indices.
        length: keyframes of a span, at most.
        count: sections.
        load: features of a frame.
        videos: number of the video of every frame; None = all are of one.
    """
    n_frames = len(keyframes)
    length = min(length, n_frames)
    sections = max(1, min(count, n_frames // length if length else 1))
    spans: list[tuple[int, ...]] = []
    for section in range(sections):
        first = section * n_frames // sections
        last = max(first, (section + 1) * n_frames // sections - length)
        starts = sorted({int(start) for start in np.linspace(first, last, PROBES)})
        parts = [_in_one_video(keyframes[start : start + length], videos) for start in starts]
        longest = max(len(part) for part in parts)
        best = max(
            (i for i, part in enumerate(parts) if len(part) == longest),
            key=lambda i: _liveliness(starts[i] + length // 2, keyframes, load),
        )
        spans.append(tuple(parts[best]))
    return spans


def _in_one_video(span: Sequence[int], videos: Sequence[int] | None) -> Sequence[int]:
    """The longest stretch of a span that lies in one video, the first of equals."""
    if videos is None:
        return span
    return max((list(group) for _, group in groupby(span, key=lambda frame: videos[frame])), key=len, default=[])


def find_focal(
    span: Sequence[int], camera: pycolmap.Camera, settings: Settings, load: Load, report: Report
) -> SpanFocal:
    """Map one span from `camera` (of the model `core.sparse.lens.estimate_model`) and refine its focal length and k1.

    A span that comes apart, or whose lens runs away, is mapped again with wider pairs too. What maps more of it counts,
    a lens that has not run away before one that has.

    Args:
        span: its keyframes, rising.
        camera: `pycolmap.Camera` with the start value.
        settings: of the run, with what the stage `focal` declares.
        load: features of a frame.
        report: progress in [0, 1].
    """
    searched = _Span(span, camera, settings, load, report)
    found = searched.map(GAPS)
    if (found.is_whole and found.is_lens) or len(span) <= WIDER_GAPS[0]:
        return found
    wider = searched.map(GAPS + WIDER_GAPS)
    return max(found, wider, key=lambda one: (one.is_lens, one.registered_images))


class _Span:
    """A span of keyframes and the pairs of it that have been matched."""

    def __init__(
        self, span: Sequence[int], camera: pycolmap.Camera, settings: Settings, load: Load, report: Report
    ) -> None:
        self._indices, self._camera, self._settings, self._report = tuple(span), camera, settings, report
        self._features = {index: strongest(load(index), KEYPOINTS) for index in self._indices}
        matching = settings.matching.model_copy(update={"method": "mutual_nearest"})
        self._matcher = PairMatcher(matching, Verifier(camera, settings.verification, settings.seed))
        self._matched: dict[tuple[int, int], MatchedPair] = {}

    def map(self, gaps: Sequence[int]) -> SpanFocal:
        """What the pairs at these differences say."""
        camera, settings, indices = self._camera, self._settings, self._indices
        bounds = indices[0], indices[-1] + 1, len(indices)
        nothing = SpanFocal(*bounds, camera.mean_focal_length(), 0.0, 0, 0, 0.0)
        table = self._match(gaps)
        keypoints = tuple(self._features[index].keypoints.astype(np.float64) for index in indices)
        frames = Frames(indices, tuple(image_name(index) for index in indices), keypoints, camera)
        residual = rotation_residual_px(build_tracks(table), frames)
        if residual is None or residual < MIN_RESIDUAL_PX:
            return nothing
        everything = {frame: np.arange(len(xy)) for frame, xy in zip(indices, keypoints, strict=True)}
        cache = thin_cache(table, frames, everything, settings.verification.min_inliers)
        ranked = rank_initial_pairs(table, settings.mapper.init_min_num_inliers)
        # One radial term is little enough to be free from the start.
        mapper = settings.mapper.model_copy(update={"refine_distortion": True, "refine_lens": True})
        options = mapper_options(mapper, threads=1, seed=settings.seed, tuned=True)
        options.multiple_models = False
        # COLMAP's own search of a first pair would try every one, at many times the cost, where wider pairs help more.
        models = map_images(cache, options, pairs=[(a + 1, b + 1) for a, b in ranked], search=False)
        model = best_model(models)
        if model is None:
            return nothing
        adjustment = pycolmap.BundleAdjustmentOptions()
        adjustment.print_summary = False
        adjustment.ceres.solver_options.num_threads = 1  # more would not repeat to the last bit
        pycolmap.bundle_adjustment(model, adjustment)
        stats, lens = model_stats(model), model.cameras[camera.camera_id]
        return SpanFocal(
            *bounds,
            float(lens.mean_focal_length()),
            lens_of(lens).radial[0],
            stats.registered_images,
            stats.points3D,
            stats.mean_reprojection_error_px,
        )

    def _match(self, gaps: Sequence[int]) -> PairTable:
        """The verified pairs at these differences, those known already as they are."""
        places = range(len(self._indices))
        pairs = [(self._indices[i], self._indices[i + gap]) for i in places for gap in gaps if i + gap in places]
        for row, (a, b) in enumerate(pairs):
            self._report(row / len(pairs), f"frames {a} and {b}")
            if (a, b) not in self._matched:
                self._matched[a, b] = self._matcher.match(self._features[a], self._features[b])
        table = make_table(pairs, [self._matched[pair] for pair in pairs])
        return within(table, self._indices[0], self._indices[-1] + 1)


def _liveliness(middle: int, keyframes: Sequence[int], load: Load) -> float:
    last = len(keyframes) - 1
    a = max(0, min(middle - PROBE_GAP // 2, last - PROBE_GAP))
    first, second = (strongest(load(keyframes[min(i, last)]), PROBE_KEYPOINTS) for i in (a, a + PROBE_GAP))
    if len(first) == 0 or len(second) == 0:
        return 0.0
    matches = mutual_nearest(unit_descriptors(first.descriptors), unit_descriptors(second.descriptors), 0.9)
    if len(matches) == 0:
        return 0.0
    moved = first.keypoints[matches[:, 0]] - second.keypoints[matches[:, 1]]
    motion = float(np.median(np.linalg.norm(moved, axis=1)))
    return min(1.0, len(matches) / ENOUGH_MATCHES) * min(motion, ENOUGH_MOTION_PX)


def joined(fov_deg: float, model: str, spans: Sequence[SpanFocal]) -> FocalProduct:
    """What the spans of one start say together; the focal length is the mean in logarithm, weighted by points."""
    weights = np.array([span.points3D for span in spans], dtype=np.float64)
    total = float(weights.sum())
    if total == 0.0:
        focal, k1, error = float(np.mean([span.focal_px for span in spans])), 0.0, 0.0
    else:
        weights /= total
        focal = float(np.exp(weights @ np.log([span.focal_px for span in spans])))
        k1 = float(weights @ np.array([span.k1 for span in spans]))
        error = float(weights @ np.array([span.mean_reprojection_error_px for span in spans]))
    return FocalProduct(
        fov_deg=fov_deg,
        focal_px=focal,
        k1=k1,
        registered=sum(span.registered_images for span in spans),
        points3D=int(total),
        mean_reprojection_error_px=error,
        model=model,
        frames=sum(span.frames for span in spans),
        spans=tuple(FocalSpan(**asdict(span)) for span in spans),
    )
