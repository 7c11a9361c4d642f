"""Which keypoints lie on an annotated blade."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

BLADE_LABEL = "blade"


def blade_polygons(masks: Sequence[Mapping[str, Any]]) -> list[NDArray[np.float64]]:
    """Outlines (k, 2) of the blade masks of one frame, normalised on the source frame."""
    outlines = [np.asarray(mask["polygon"], np.float64) for mask in masks if mask.get("label") == BLADE_LABEL]
    return [outline for outline in outlines if outline.ndim == 2 and len(outline) >= 3]


def inside_blades(
    keypoints: NDArray[np.float32], polygons: Sequence[NDArray[np.float64]], crop: Mapping[str, int]
) -> NDArray[np.bool_]:
    """Which keypoints (n, 2), in crop pixels, lie inside or on any polygon; all of them without polygons.

    A frame without blade masks keeps everything: a missing annotation does not say that nothing is a blade.
    """
    if not polygons:
        return np.ones(len(keypoints), np.bool_)
    source = keypoints.astype(np.float64) + np.array([crop["x0"], crop["y0"]], np.float64)
    size = np.array([crop["source_width"], crop["source_height"]], np.float64)
    inside = np.zeros(len(keypoints), np.bool_)
    for polygon in polygons:
        outline = np.ascontiguousarray(polygon * size, np.float32)
        inside |= [cv2.pointPolygonTest(outline, (float(x), float(y)), False) >= 0 for x, y in source]
    return inside
