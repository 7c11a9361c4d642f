"""Stage `motion`: the keyframes, by how far the picture moves."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import torch

from core.features.io import FrameFeatures, feature_files, read_features, strongest
from core.io.frames import read_frames
from core.matching.keyframes import KEYPOINTS, choose_keyframes, picture_motion, write_keyframes
from core.products.front import FramesProduct, MotionProduct
from core.stage import StageTask


def run(task: StageTask) -> MotionProduct:
    """Write ``keyframes.json``: frames between which the picture moved by a useful share of its width."""
    torch.set_num_threads(task.threads)
    frames = task.products.of(FramesProduct, "frames")
    n_search = frames.n_search
    files = feature_files(folder for _, folder in task.fan_in("features"))

    @lru_cache(maxsize=256)
    def load(index: int) -> FrameFeatures:
        return strongest(read_features(files[index]), KEYPOINTS)

    x0, _, x1, _ = frames.crop
    motion = picture_motion(x1 - x0, load)

    videos = read_frames(task.input("frames")).videos

    def reported(a: int, b: int) -> float | None:
        task.report(a, n_search, f"frames {a} and {b}")
        # Frames of two videos have nothing to do with each other, however alike they look.
        return motion(a, b) if videos[a] == videos[b] else None

    found = choose_keyframes(n_search, reported)
    write_keyframes(task.out, found)
    task.report(1, 1)
    per_frame = found.motion_per_frame
    return MotionProduct(
        n_keyframes=len(found.frames),
        median_step=float(np.median(np.diff(found.frames))) if len(found.frames) > 1 else 0.0,
        motion_per_frame=None if per_frame is None else round(per_frame, 6),
    )
