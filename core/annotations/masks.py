"""Polygons to pixels: which pixels of an exported frame lie on an annotated blade."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from core.scene.detection import Mask, Polygon
from core.scene.frame import Crop

BLADE_LABEL = "blade"
_SHIFT = 4
"""Bits of subpixel position that OpenCV's filling takes."""


def blade_mask(masks: Sequence[Mask], crop: Crop) -> NDArray[np.bool_] | None:
    """(crop.height, crop.width) mask of the pixels on a blade; None when no blade is annotated.

    Args:
        masks: those of one source frame, as `core.io.annotations.read_masks` gives them.
        crop: the exported part of the frame.
    """
    polygons = [mask.polygon for mask in masks if mask.label.casefold() == BLADE_LABEL]
    return rasterise(polygons, crop) if polygons else None


def rasterise(polygons: Sequence[Polygon], crop: Crop) -> NDArray[np.bool_]:
    """(crop.height, crop.width) union of polygons given in shares of the source frame."""
    image = np.zeros((crop.height, crop.width), np.uint8)
    size = np.array([crop.source_width, crop.source_height], np.float64)
    for polygon in polygons:
        # OpenCV counts from pixel centres; positions here have the centre of the first pixel at 0.5.
        corners = np.asarray(polygon, np.float64) * size - (crop.x0, crop.y0) - 0.5
        fixed = np.round(corners * (1 << _SHIFT)).astype(np.int32)
        cv2.fillPoly(image, [fixed], 1, lineType=cv2.LINE_8, shift=_SHIFT)
    return image.astype(bool)
