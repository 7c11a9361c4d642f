"""Is the lens found one that exists, and one that the tracks agree on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from core.flags import Flag, Severity
from core.geometry.lens import Lens

MIN_FOV_DEG = 15.0
MAX_FOV_DEG = 200.0
MAX_SHIFT = 0.06
"""A focal length that the last choice of tracks still moves by more than this share may have further to go."""
MAX_LEFT = 0.25
"""A focal length farther than this share from what a part of the clip said when it was sought follows from neither.

Right ones were up to 0.18 away: parts of a clip with hardly any texture are all wrong by so much until keypoints are
aligned. Wrong ones were 0.31 to 0.8 away.
"""
MAX_ASPECT = 1.03
"""Pixels are square: a larger ratio of the two focal lengths (or its inverse) comes from a model that is bent."""


def check_shift(shift: float) -> Flag | None:
    """`lens_unsettled` when the focal length still moves by more than 6 % with the choice of tracks.

    Args:
        shift: relative change of the focal length, from `core.sparse.trimming`.
    """
    if abs(shift) <= MAX_SHIFT:
        return None
    return Flag("lens_unsettled", Severity.WARNING, abs(shift), MAX_SHIFT, "relative change of the focal length")


def check_left(focal_px: float, said_px: Sequence[float]) -> Flag | None:
    """`lens_unsettled` when the final focal length is more than 25 % off what a part of the clip said.

    Args:
        focal_px: of the final model.
        said_px: focal lengths that the search for the lens found, of each of its spans; none where it was told.
    """
    left = max((abs(focal_px / said - 1.0) for said in said_px), default=0.0)
    if left <= MAX_LEFT:
        return None
    return Flag("lens_unsettled", Severity.WARNING, left, MAX_LEFT, "focal length against what spans of the clip said")


def check_lens(width: int, height: int, lens: Lens) -> list[Flag]:
    """Flags of a lens.

    Args:
        width: of the image, px.
        height: of the image, px.
        lens: of that image.

    Returns:
        `distortion_implausible` when the image's farthest corner lies beyond the fold;
        `focal_implausible` when the field of view across the width is outside 15-200 degrees;
        `focal_lengths_differ` when fx / fy is outside 0.97-1.03.
    """
    fx, fy, cx, cy = lens.fx, lens.fy, lens.cx, lens.cy
    flags = []
    corner = np.hypot(max(cx, width - cx) / fx, max(cy, height - cy) / fy)
    if lens.angle_at(float(corner)) is None:
        flags.append(Flag("distortion_implausible", Severity.WARNING, float(np.abs(lens.radial).max()), None, "camera"))
    sides = [lens.angle_at(float(side / fx)) for side in (cx, width - cx)]
    # Where the polynomial folds, its linear part still tells the field of view.
    found = [side / fx if angle is None else angle for side, angle in zip((cx, width - cx), sides, strict=True)]
    fov = float(np.degrees(sum(found)))
    if fov < MIN_FOV_DEG or fov > MAX_FOV_DEG:
        threshold = MIN_FOV_DEG if fov < MIN_FOV_DEG else MAX_FOV_DEG
        flags.append(
            Flag("focal_implausible", Severity.WARNING, fov, threshold, "field of view across the crop, degrees")
        )
    aspect = float(fx / fy)
    if not 1.0 / MAX_ASPECT <= aspect <= MAX_ASPECT:
        flags.append(Flag("focal_lengths_differ", Severity.WARNING, aspect, MAX_ASPECT, "fx / fy"))
    return flags
