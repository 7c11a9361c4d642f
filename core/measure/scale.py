"""The scale of a model: what the user told of lengths, and one scale out of several sources."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import sqrt

import numpy as np
from numpy.typing import NDArray

from core.flags import Flag, Severity
from core.mapping.scene import Scene
from core.measure.outline import MIN_COSINE
from core.scene.frame import RunFrames
from core.scene.size import Scale, ScaleSource
from core.settings.scale import ScaleSettings

F64 = NDArray[np.float64]

POINTING_PX = 1.0
"""Standard deviation of a pixel that a person pointed at."""
AGREE_SIGMAS = 2.0
"""Two scales agree within this many standard deviations of their difference."""
SAME_TIME_S = 1e-3
"""A frame is the one told when its time is at least this near."""


@dataclass(frozen=True)
class FoundScale:
    """The scale of a model, and what there is to say of it."""

    scale: Scale | None
    """None where none was told, or it cannot be used."""
    flags: tuple[Flag, ...] = ()


def find_scale(settings: ScaleSettings, scene: Scene, frames: RunFrames, more: Sequence[Scale] = ()) -> FoundScale:
    """The scale of a model out of what was told.

    Args:
        settings: a known length between two pixels of a frame, when there is one.
        scene: of the model.
        frames: of the run.
        more: scales from other sources, e.g. the radius of the row.
    """
    if settings.points is None or settings.length_mm is None:
        return join_scales(more)
    found = _between_points(settings, settings.points, settings.length_mm, scene, frames)
    if isinstance(found, Scale):
        return join_scales([found, *more])
    severity = Severity.INFO if more or scene.model else Severity.WARNING
    joined = join_scales(more)
    return FoundScale(joined.scale, (Flag("scale_unknown", severity, where=found), *joined.flags))


def join_scales(scales: Sequence[Scale]) -> FoundScale:
    """One scale out of several: the mean by inverse variances.

    Two that differ by more than `AGREE_SIGMAS` standard deviations of their difference raise `scale_disagrees`. Where
    they scatter more than their deviations say, that of the mean grows with the scatter (Birge's ratio, Phys. Rev. 40,
    1932).
    """
    if not scales:
        return FoundScale(None)
    if len(scales) == 1:
        return FoundScale(scales[0])
    values, sigmas = np.array([one.value for one in scales]), np.array([one.sigma for one in scales])
    weights = 1.0 / sigmas**2
    value = float((weights * values).sum() / weights.sum())
    ratio = sqrt(float((weights * (values - value) ** 2).sum()) / (len(scales) - 1))
    source = "+".join(one.source for one in scales)
    joined = Scale(value, max(1.0, ratio) / sqrt(float(weights.sum())), source)
    worst, pair = max(
        (abs(a.value - b.value) / sqrt(a.sigma**2 + b.sigma**2), (a, b)) for a, b in combinations(scales, 2)
    )
    if worst <= AGREE_SIGMAS:
        return FoundScale(joined)
    where = " and ".join(f"{one.source} {one.value:.4g}" for one in pair)
    return FoundScale(joined, (Flag("scale_disagrees", Severity.WARNING, worst, AGREE_SIGMAS, where),))


def _between_points(
    settings: ScaleSettings,
    points: tuple[float, float, float, float],
    length_mm: float,
    scene: Scene,
    frames: RunFrames,
) -> Scale | str:
    """From a straight length between two places of the surface, or why there is none."""
    view, time_s = _view_at(settings, scene, frames)
    if view is None:
        nearest = "" if time_s is None else f"; the nearest that is lies at {time_s:.4f} s"
        return f"no frame at {settings.time_s:g} s is registered in this model{nearest}"
    xy = np.array(points, np.float64).reshape(2, 2) - (scene.crop.x0, scene.crop.y0)
    rays = scene.views.rays(xy, scene.views.R[view])
    origins = np.broadcast_to(scene.views.centers[view], rays.shape)
    hits = scene.surface.cast(origins, rays)
    if not hits.hit.all():
        return "there is no surface under the pixels told"
    places = origins + hits.distance[:, None] * rays
    between = places[1] - places[0]
    length = float(np.linalg.norm(between))
    if length <= 2.0 * scene.spacing:
        return "the pixels told show one place"
    # Of a pixel: across the line of sight by the pointing, along it by the slope of the surface, and by the surface.
    along = np.abs(rays @ (between / length))
    cosine = np.clip(np.abs(hits.cosine), MIN_COSINE, 1.0)
    across = POINTING_PX * hits.distance / scene.focal_px
    off = across * (np.sqrt(1.0 - along**2) + along * np.sqrt(1.0 - cosine**2) / cosine)
    off = np.hypot(off, scene.spacing)
    told = settings.length_sigma_mm if settings.length_sigma_mm is not None else 0.01 * length_mm
    share = sqrt(float((off**2).sum()) / length**2 + (told / length_mm) ** 2)
    value = length_mm / length
    return Scale(value, share * value, ScaleSource.POINTS)


def _view_at(settings: ScaleSettings, scene: Scene, frames: RunFrames) -> tuple[int | None, float | None]:
    """Row of the registered view that the time names, None without one; and the time of the nearest."""
    own = [frame for frame in frames if frame.video == settings.video and scene.views.row(frame.index) is not None]
    if not own:
        return None, None
    nearest = min(own, key=lambda frame: abs(frame.time_s - settings.time_s))
    off = abs(nearest.time_s - settings.time_s)
    return (scene.views.row(nearest.index) if off <= SAME_TIME_S else None), nearest.time_s
