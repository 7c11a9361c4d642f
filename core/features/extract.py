"""From an exported frame to its features: scale down, detect, return to crop pixels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.errors import StageFailed
from core.features.disk import Disk
from core.features.io import FrameFeatures
from core.settings.groups import FeatureSettings


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


Extractor = Callable[[NDArray[np.uint8]], FrameFeatures]


def read_image(path: Path) -> NDArray[np.uint8]:
    """RGB image (height, width, 3); `StageFailed` when it cannot be read."""
    image = cv2.imread(str(path), cv2.IMREAD_COLOR)
    if image is None:
        raise StageFailed(f"cannot read the frame {path.name}", where="features")
    return np.ascontiguousarray(image[:, :, ::-1])


def working_size(width: int, height: int, settings: FeatureSettings) -> tuple[int, int]:
    """(width, height) in which features are detected: never larger than the frame, never below 16 px."""
    scale = min(1.0, settings.max_size_px / max(width, height)) * settings.scale
    return max(min(width, 16), round(width * scale)), max(min(height, 16), round(height * scale))


def make_extractor(settings: FeatureSettings, threads: int = 1) -> Extractor:
    """The detector that the settings name, for frames of any size; networks are loaded once."""
    detect = _sift_detector(settings) if settings.method == "sift" else _disk_detector(settings, Disk(threads=threads))

    def extract(image: NDArray[np.uint8]) -> FrameFeatures:
        height, width = image.shape[:2]
        size = working_size(width, height, settings)
        small = image
        if size != (width, height):
            small = np.asarray(cv2.resize(image, size, interpolation=cv2.INTER_AREA), np.uint8)
        found = detect(small)
        # Positions already count from the corner of the image, so one factor per axis takes them back exactly.
        factors = np.array([width / size[0], height / size[1]])
        keypoints = (found.keypoints * factors).astype(np.float32)
        return FrameFeatures(keypoints, found.scores, found.descriptors)

    return extract


def _disk_detector(settings: FeatureSettings, network: Disk) -> Extractor:
    def detect(image: NDArray[np.uint8]) -> FrameFeatures:
        found = network.detect(image, settings.max_keypoints)
        keypoints = found.pixels + np.float32(0.5)  # whole pixels to COLMAP's convention
        if settings.subpixel:
            keypoints = keypoints + found.offsets
        order = np.argsort(-found.scores, kind="stable")
        descriptors = found.descriptors[order].astype(np.float16)
        return FrameFeatures(keypoints[order].astype(np.float32), found.scores[order], descriptors)

    return detect


def _sift_detector(settings: FeatureSettings) -> Extractor:
    def detect(image: NDArray[np.uint8]) -> FrameFeatures:
        return sift(np.asarray(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), np.uint8), settings.max_keypoints)

    return detect


def inside_mask(features: FrameFeatures, mask: NDArray[np.bool_]) -> FrameFeatures:
    """The features whose pixel is true in `mask` (height, width), in the same order."""
    x, y = np.floor(features.keypoints).astype(np.int64).T
    kept = mask[np.clip(y, 0, mask.shape[0] - 1), np.clip(x, 0, mask.shape[1] - 1)]
    return FrameFeatures(features.keypoints[kept], features.scores[kept], features.descriptors[kept])
