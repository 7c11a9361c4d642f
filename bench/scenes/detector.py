"""What a detector would say of a scene: jittered boxes of most of what is visible, and now and then an invention."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.scenes.spec import Scene

F64 = NDArray[np.float64]

MIN_PIXELS = 24
"""A defect that fewer pixels show is not visible."""
MIN_SIDE_PX = 4.0
JITTER = 0.06
"""Standard deviation of a box's edges over its sides."""


@dataclass(frozen=True)
class Visible:
    """A defect as one frame shows it."""

    number: int
    kind: str
    box_px: F64
    """(4,) x1, y1, x2, y2 on the frame."""
    outline_px: F64
    """(k, 2) corners of its mask."""


def visible_defects(labels: NDArray[np.int32], kinds: dict[int, str]) -> list[Visible]:
    """From the (h, w) defect numbers of a frame."""
    found = []
    for number, kind in kinds.items():
        mask = (labels == number).astype(np.uint8)
        if int(mask.sum()) < MIN_PIXELS:
            continue
        rows, columns = np.nonzero(mask)
        box = np.array([columns.min(), rows.min(), columns.max() + 1, rows.max() + 1], np.float64)
        if min(box[2] - box[0], box[3] - box[1]) < MIN_SIDE_PX:
            continue
        outlines, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
        outline = max(outlines, key=cv2.contourArea).reshape(-1, 2) + 0.5
        found.append(Visible(number, kind, box, outline))
    return found


class Detector:
    """Gives the entry of the annotation file for one frame after the other; the same seed gives the same answers."""

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._rng = np.random.default_rng(scene.seed + 4)

    def entry(self, visible: Sequence[Visible]) -> dict[str, Any]:
        """Detections of a frame: normalised boxes, labels, scores; polygons where the scene's detector gives them."""
        detections = []
        for one in visible:
            if self._rng.random() < self._scene.missed:
                continue
            x1, y1, x2, y2 = one.box_px
            sides = np.array([x2 - x1, y2 - y1] * 2)
            box = one.box_px + self._rng.normal(scale=JITTER, size=4) * sides
            detections.append(self._detection(box, one.kind, float(self._rng.uniform(0.55, 0.97)), one.outline_px))
        for _ in range(int(self._rng.poisson(self._scene.false_boxes))):
            detections.append(self._invented())
        return {"detections": detections, "masks": []}

    def _detection(self, box_px: F64, label: str, score: float, outline: F64 | None) -> dict[str, Any]:
        lens = self._scene.lens
        size = np.array([lens.width, lens.height] * 2, np.float64)
        box = np.clip(box_px / size, 0.0, 1.0)
        found: dict[str, Any] = {"bbox": [round(float(v), 5) for v in box], "label": label, "score": round(score, 3)}
        if self._scene.masks and outline is not None and len(outline) >= 3:
            found["polygon"] = [[round(float(x), 5), round(float(y), 5)] for x, y in outline / size[:2]]
        return found

    def _invented(self) -> dict[str, Any]:
        """A box where nothing is, of an ordinary size."""
        lens = self._scene.lens
        x0, y0, x1, y1 = self._scene.roi
        center = self._rng.uniform((x0 + 0.06, y0 + 0.06), (x1 - 0.06, y1 - 0.06)) * (lens.width, lens.height)
        half = self._rng.uniform(0.015, 0.04, 2) * lens.width
        label = ("burn", "crack", "dent", "nick", "coating_loss")[int(self._rng.integers(5))]
        box = np.concatenate([center - half, center + half])
        return self._detection(box, label, float(self._rng.uniform(0.5, 0.9)), None)
