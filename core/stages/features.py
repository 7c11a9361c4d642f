"""Stage `features`: keypoints and descriptors of a chunk of frames, one file per frame."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch
from numpy.typing import NDArray

from core.annotations.masks import blade_mask
from core.features.extract import inside_mask, make_extractor, read_image
from core.features.io import feature_name, write_features
from core.io.annotations import read_masks
from core.io.frames import image_path, read_crop, read_damaged, read_frames
from core.products.front import FeaturesProduct
from core.stage import StageTask
from core.video.still import read_still


def run(task: StageTask) -> FeaturesProduct:
    """Detect features in frames [start, end)."""
    torch.set_num_threads(task.threads)
    start, end = int(task.args["start"]), int(task.args["end"])
    settings = task.settings.features
    frames = task.input("frames")
    extract = make_extractor(settings, task.threads)
    mask_of = _blade_masks(task, frames) if settings.blade_masks_only else None
    moving = ~read_still(frames)
    damaged = set(read_damaged(frames))
    counts = []
    for done, index in enumerate(range(start, end)):
        task.report(done, end - start, f"frame {index}")
        features = extract(read_image(image_path(frames, index)))
        mask = mask_of(index) if mask_of else None
        usable = np.zeros_like(moving) if index in damaged else moving
        features = inside_mask(features, usable if mask is None else usable & mask)
        write_features(task.out / feature_name(index), features)
        counts.append(len(features))
    task.report(1, 1)
    return FeaturesProduct(
        n_images=len(counts),
        min_keypoints=min(counts, default=0),
        mean_keypoints=round(sum(counts) / len(counts), 3) if counts else 0.0,
    )


def _blade_masks(task: StageTask, frames: Path) -> Callable[[int], NDArray[np.bool_] | None]:
    """Mask of the blades on a frame; None for a frame without annotated blades, which keeps everything."""
    used, crop = read_frames(frames), read_crop(frames)
    masks = read_masks(task.input("annotations"))
    return lambda index: blade_mask(masks.get(used[index].source, ()), crop)
