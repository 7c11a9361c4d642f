"""One picture per defect that shows why it is there: the best frame that detected it, and its place close up."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.outputs import evidence_name
from core.scene.defect import DefectRecord
from core.scene.detection import DetectionRow

U8 = NDArray[np.uint8]

HEIGHT_PX = 480
CLOSE_UP = 4.0
"""The close-up's side over the longer side of the box."""
MIN_SIDE_SHARE = 0.12
"""It shows at least this share of the frame's height."""
_BOX = (255, 196, 0)
_PLACE = (255, 64, 64)
_BAR_PX = 34


@dataclass(frozen=True)
class Evidence:
    """What is drawn of a defect."""

    defect: int
    frame_index: int
    caption: str
    boxes: tuple[tuple[float, float, float, float], ...]
    """Its boxes in that frame, normalised."""
    place: tuple[float, float] | None
    """Where its fused place appears, normalised."""

    @property
    def file_name(self) -> str:
        """Name of its picture."""
        return evidence_name(self.defect)


def evidence_of(records: Sequence[DefectRecord], rows: Sequence[DetectionRow]) -> list[Evidence]:
    """Of every defect with a view in which it was detected, in their order."""
    found = []
    for record in records:
        best = next((view for view in record.frames if view.detected), None)
        if best is None:
            continue
        own = [row for row in rows if row.defect_id == record.id and row.frame_index == best.frame_index]
        boxes = tuple(row.box for row in own)
        found.append(Evidence(record.id, best.frame_index, _caption(record), boxes, best.at))
    return [one for one in found if one.boxes]


def _caption(record: DefectRecord) -> str:
    seen = record.persistence
    sure = "" if record.confidence is None else f", confidence {record.confidence.value:.2f}"
    text = f"D{record.id} {record.label}{sure}, in {seen.k} of {seen.n} frames that could show it"
    # OpenCV's font knows printable ASCII only.
    return "".join(c if 32 <= ord(c) < 127 else "?" for c in text)


def draw_evidence(rgb: U8, one: Evidence) -> U8:
    """(h, w, 3) the frame beside a close-up of the place, with a caption.

    Args:
        rgb: (h, w, 3) uncropped frame.
        one: what to show on it.
    """
    frame = _scaled(rgb, HEIGHT_PX / rgb.shape[0])
    _mark(frame, one, (0.0, 0.0), (frame.shape[1], frame.shape[0]), 1)
    x, y, side = _window(rgb.shape[1], rgb.shape[0], one)
    cut = rgb[y : y + side, x : x + side]
    close = np.asarray(cv2.resize(cut, (HEIGHT_PX, HEIGHT_PX), interpolation=cv2.INTER_CUBIC), np.uint8)
    zoom = HEIGHT_PX / side
    _mark(close, one, (x * zoom, y * zoom), (rgb.shape[1] * zoom, rgb.shape[0] * zoom), 2)
    both = np.hstack([frame, np.full((HEIGHT_PX, 4, 3), 255, np.uint8), close])
    bar = np.full((_BAR_PX, both.shape[1], 3), 24, np.uint8)
    cv2.putText(bar, one.caption, (10, 23), cv2.FONT_HERSHEY_SIMPLEX, 0.55, (235, 235, 235), 1, cv2.LINE_AA)
    return np.vstack([both, bar])


def _scaled(rgb: U8, factor: float) -> U8:
    size = (max(1, round(rgb.shape[1] * factor)), HEIGHT_PX)
    return np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA if factor < 1 else cv2.INTER_CUBIC), np.uint8)


def _window(width: int, height: int, one: Evidence) -> tuple[int, int, int]:
    """Left, top and side of the close-up, px, inside the frame."""
    boxes = np.array(one.boxes) * [width, height, width, height]
    longest = float((boxes[:, 2:] - boxes[:, :2]).max())
    side = int(np.clip(CLOSE_UP * longest, MIN_SIDE_SHARE * height, min(width, height)))
    middle = (boxes[:, :2].mean(axis=0) + boxes[:, 2:].mean(axis=0)) / 2
    left = int(np.clip(middle[0] - side / 2, 0, width - side))
    top = int(np.clip(middle[1] - side / 2, 0, height - side))
    return left, top, side


def _mark(picture: U8, one: Evidence, origin: tuple[float, float], size: tuple[float, float], thickness: int) -> None:
    """Boxes and a cross, in a picture that shows the frame at `size` px from `origin` on."""
    for x1, y1, x2, y2 in one.boxes:
        first = (round(x1 * size[0] - origin[0]), round(y1 * size[1] - origin[1]))
        second = (round(x2 * size[0] - origin[0]), round(y2 * size[1] - origin[1]))
        cv2.rectangle(picture, first, second, _BOX, thickness, cv2.LINE_AA)
    if one.place is not None:
        at = (round(one.place[0] * size[0] - origin[0]), round(one.place[1] * size[1] - origin[1]))
        cv2.drawMarker(picture, at, _PLACE, cv2.MARKER_CROSS, 8 * thickness, thickness, cv2.LINE_AA)
