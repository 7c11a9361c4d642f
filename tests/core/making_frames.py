"""Result folders of stage `frames` for tests: a camera that slides along a textured wall."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from core.io.frames import write_frames
from core.scene.frame import Crop, Frame, Role, RunFrames
from core.video.still import write_still

SIZE = (200, 160)


def frames_folder(
    folder: Path,
    roles: Sequence[str],
    times_s: Sequence[float] | None = None,
    step_px: int = 6,
    damaged: Sequence[int] = (),
) -> Path:
    """Write images, ``frames.json`` and ``crop.json``; frame i shows the wall from `step_px` x its time."""
    times = list(times_s) if times_s is not None else [float(i) for i in range(len(roles))]
    rng = np.random.default_rng(0)
    wide = SIZE[0] + int(step_px * max(times)) + 8
    wall = np.kron(rng.integers(0, 256, (SIZE[1] // 5 + 1, wide // 5 + 1, 3)), np.ones((5, 5, 1))).astype(np.uint8)
    wall = np.asarray(cv2.GaussianBlur(wall, (5, 5), 1.2), np.uint8)
    (folder / "images").mkdir(parents=True)
    rows = []
    for index, (role, time) in enumerate(zip(roles, times, strict=True)):
        left = int(step_px * time)
        cv2.imwrite(str(folder / "images" / f"{index:04d}.jpg"), wall[: SIZE[1], left : left + SIZE[0]])
        rows.append(Frame(index, 2 * index, index, time, "", Role(role)))
    crop = Crop(10, 20, 10 + SIZE[0], 20 + SIZE[1], 250, 200)
    write_frames(folder, RunFrames(tuple(rows)), crop, damaged)
    write_still(folder, np.zeros((crop.height, crop.width), bool))
    return folder
