"""What a video may be, as its header states it."""

from __future__ import annotations

import math
from dataclasses import dataclass

MAX_FRAME_PIXELS = 40_000_000
"""Pixels of a picture: more than 8K has (33 million), and some 120 MB of RGB."""


@dataclass(frozen=True)
class VideoLimits:
    """The largest video that is taken; named as the settings of a deployment."""

    max_frame_pixels: int = MAX_FRAME_PIXELS
    max_video_frames: float = math.inf
    max_video_seconds: float = math.inf


PIXELS_ONLY = VideoLimits()
"""For whoever computes on a machine of their own: any length."""
