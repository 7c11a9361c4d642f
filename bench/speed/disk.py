"""DISK against kornia's, same weights, same frames, same threads."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch
from kornia.feature import DISK

from bench.speed.finished import FinishedRun
from bench.speed.timing import Row, Table, interleaved
from core.features.disk import Disk
from core.features.extract import read_image
from core.features.weights import load_weights
from core.weight_files import DISK_WEIGHTS

COUNT = 5000


def compare(run: FinishedRun, *, threads: int, repeat: int, n_frames: int = 3) -> Table:
    """Detect on frames spread over the clip; the first run of each side is for warming up."""
    torch.set_num_threads(threads)
    images = run.images()
    chosen = [read_image(images[i]) for i in np.linspace(0, len(images) - 1, n_frames).astype(int)]
    theirs = DISK().eval()
    theirs.load_state_dict(load_weights(DISK_WEIGHTS, "extractor"))
    ours = Disk(threads=threads)

    def kornia(image: Any) -> Any:
        tensor = torch.from_numpy(image).permute(2, 0, 1)[None].float() / 255
        with torch.inference_mode():
            return theirs(tensor, COUNT, pad_if_not_divisible=True)[0]

    warm = [(ours.detect(image, COUNT), kornia(image)) for image in chosen]
    times = interleaved(
        {
            "ours": lambda: [ours.detect(image, COUNT) for image in chosen],
            "kornia": lambda: [kornia(image) for image in chosen],
        },
        repeat,
    )
    differences = [_difference(mine, other) for mine, other in warm]
    height, width = chosen[0].shape[:2]
    return Table(
        "disk",
        f"{n_frames} frames of {width}x{height}, {COUNT} keypoints, {threads} threads, median of {repeat}",
        (
            Row("this project", times["ours"].median / n_frames, "s a frame"),
            Row("kornia DISK", times["kornia"].median / n_frames, "s a frame"),
            Row("ratio", times["kornia"].median / times["ours"].median, "x", "at least 2.5"),
            Row("keypoints that both find", min(share for share, _ in differences), "share", "1"),
            Row("largest descriptor difference", max(gap for _, gap in differences), "", "1e-5"),
        ),
    )


def _difference(mine: Any, other: Any) -> tuple[float, float]:
    """Share of kornia's keypoints found at the same pixel, and the largest difference of their descriptors."""
    rows = {tuple(pixel): row for row, pixel in enumerate(mine.pixels.tolist())}
    pixels = other.keypoints.round().long().tolist()
    both = [(rows[tuple(pixel)], row) for row, pixel in enumerate(pixels) if tuple(pixel) in rows]
    mine_rows, other_rows = np.array(both).T
    gap = np.abs(mine.descriptors[mine_rows] - other.descriptors.numpy()[other_rows]).max()
    return len(both) / max(len(pixels), len(rows)), float(gap)
