"""SIFT (Lowe, IJCV 2004) as COLMAP extracts it on the CPU."""

from __future__ import annotations

import cv2  # noqa: F401  (before pycolmap: the other order aborts in PNG writing)
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.features.io import FrameFeatures


def sift(grey: NDArray[np.uint8], count: int) -> FrameFeatures:
    """At most `count` keypoints of a grey image (height, width).

    Returns:
        Keypoints with pixel centres at (0.5, 0.5) and the descriptors (n, 128) u8 of COLMAP's database. COLMAP
        prefers large features, so the score is the feature's scale in pixels.
    """
    options = pycolmap.FeatureExtractionOptions()
    options.num_threads = 1
    options.use_gpu = False
    options.sift.max_num_features = count
    extractor = pycolmap.FeatureExtractor.create(options, pycolmap.Device.cpu)
    found, descriptors = extractor.extract(pycolmap.Bitmap.from_array(np.ascontiguousarray(grey)))
    rows = np.array([(point.x, point.y, point.compute_scale()) for point in found], np.float32).reshape(-1, 3)
    order = np.argsort(-rows[:, 2], kind="stable")[:count]
    return FrameFeatures(
        np.ascontiguousarray(rows[order, :2]), rows[order, 2], np.asarray(descriptors.data, np.uint8)[order]
    )
