"""Views of a defect: which could see it, how well, and the visits that its detections make."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from core.mapping.consensus import could_see
from core.mapping.surface import Surface
from core.scene.defect import Sighting
from core.scene.frame import Crop
from core.scene.views import Views
from core.videos import video_of

F64 = NDArray[np.float64]

MAX_SAMPLES = 16
MIN_VISIBLE_SHARE = 0.5
"""A view sees a place when at least this share of its sample points is inside the image and not hidden."""
AWAY_FRAMES = 3
"""A defect that this many registered frames in a row do not show was out of sight;"""
AWAY_S = 0.5
"""for at least so long, what comes after is another visit."""


def views_of_place(
    points: F64,
    normal: F64,
    views: Views,
    surface: Surface,
    tolerance: float,
    place: F64 | None = None,
    crop: Crop | None = None,
) -> list[Sighting]:
    """Views that could see most of a place, best first (earlier first among equals).

    Args:
        points: (n, 3) surface points of the place.
        normal: (3,) unit normal towards the cameras that saw it.
        views: registered images.
        surface: what may hide it.
        tolerance: depth by which the surface may lie before a point, scene units.
        place: (3,) whose pixel is told with every view; needs `crop`.
        crop: from source to exported frames.
    """
    if len(points) > MAX_SAMPLES:
        points = points[np.linspace(0, len(points) - 1, MAX_SAMPLES).round().astype(int)]
    rows = np.arange(len(views.frame_index))
    seen, _ = could_see(points, np.tile(normal, (len(points), 1)), views, rows, surface, tolerance)
    middle = points.mean(axis=0)
    towards = views.centers - middle
    distance = np.linalg.norm(towards, axis=1)
    quality = np.clip(towards @ normal / distance, 0.0, 1.0) / distance**2
    chosen = np.flatnonzero(seen.mean(axis=0) >= MIN_VISIBLE_SHARE)
    best = float(quality[chosen].max(initial=0.0)) or 1.0
    at: list[tuple[float, float] | None] = [None] * len(rows)
    if place is not None and crop is not None:
        xy = views.project(place[None])[0][0] + np.array([crop.x0, crop.y0])
        at = [
            (float(x) / crop.source_width, float(y) / crop.source_height) if np.isfinite(x + y) else None for x, y in xy
        ]
    found = [Sighting(int(views.frame_index[k]), float(quality[k]) / best, at[k]) for k in chosen]
    return sorted(found, key=lambda sighting: (-sighting.quality, sighting.frame_index))


def visits(detected: Sequence[int], visible: Sequence[int], times_s: Mapping[int, float]) -> list[list[int]]:
    """Frames with a detection of a defect, cut where it was out of sight in between, and between two videos.

    Args:
        detected: frame indices with a detection, by time.
        visible: frame indices that could see it.
        times_s: of all registered frames by frame index, on one axis of all videos (`core.videos.moment`).
    """
    seen = set(visible) | set(detected)
    order = sorted(times_s, key=lambda frame: (times_s[frame], frame))
    position = {frame: k for k, frame in enumerate(order)}
    groups: list[list[int]] = []
    for frame in detected:
        before = groups[-1][-1] if groups else frame
        one_video = video_of(times_s[before]) == video_of(times_s[frame])
        if groups and one_video and not _was_away(order[position[before] : position[frame] + 1], seen, times_s):
            groups[-1].append(frame)
        else:
            groups.append([frame])
    return groups


def _was_away(between: Sequence[int], seen: set[int], times_s: Mapping[int, float]) -> bool:
    """Whether a long enough run of these frames does not show the defect."""
    run: list[int] = []
    for frame in between:
        run = [] if frame in seen else [*run, frame]
        if len(run) >= AWAY_FRAMES and times_s[run[-1]] - times_s[run[0]] >= AWAY_S:
            return True
    return False
