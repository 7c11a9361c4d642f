"""Result folders of stage `frames` for tests: a camera that slides along a textured wall."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from core.video.still import write_mask

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
    wall = cv2.GaussianBlur(wall, (5, 5), 1.2)
    (folder / "images").mkdir(parents=True)
    rows = []
    for index, (role, time) in enumerate(zip(roles, times, strict=True)):
        left = int(step_px * time)
        cv2.imwrite(str(folder / "images" / f"{index:04d}.jpg"), wall[: SIZE[1], left : left + SIZE[0]])
        rows.append(
            {"index": index, "source_index": 2 * index, "pts": index, "time_s": time, "sha256": "", "role": role}
        )
    (folder / "frames.json").write_text(json.dumps(rows), encoding="utf-8")
    crop = {"x0": 10, "y0": 20, "x1": 10 + SIZE[0], "y1": 20 + SIZE[1], "source_width": 250, "source_height": 200}
    (folder / "crop.json").write_text(json.dumps(crop), encoding="utf-8")
    write_mask(folder / "still.png", np.zeros((crop["y1"] - crop["y0"], crop["x1"] - crop["x0"]), bool))
    (folder / "damaged.json").write_text(json.dumps(list(damaged)), encoding="utf-8")
    return folder
