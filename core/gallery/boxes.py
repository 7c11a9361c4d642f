"""Boxes drawn on original, uncropped frames, and the choice of frames when there are too many."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.gallery.palette import RGB
from core.scene.detection import DetectionRow, Outcome
from core.scene.frame import SourceFrame

U8 = NDArray[np.uint8]
Plate = tuple[int, int, int, int]

_DASH_PX = 7
_INK: RGB = (40, 44, 48)
_PLACE: RGB = (255, 120, 90)
_MAX_LABEL = 28


def frame_file(source: SourceFrame) -> str:
    """Name of the picture of a frame of a video."""
    of_video = f"{source.video}_" if source.video else ""
    return f"frame_{of_video}{source.source_index:06d}.jpg"


@dataclass(frozen=True)
class FrameBoxes:
    """One frame of a video and the detections on it."""

    source: SourceFrame
    time_s: float
    rows: tuple[DetectionRow, ...]

    @property
    def file_name(self) -> str:
        """Name of its picture."""
        return frame_file(self.source)

    @property
    def best_score(self) -> float:
        """Highest score of its detections; 0 where none has one."""
        return max((row.score or 0.0 for row in self.rows), default=0.0)


def group_by_frame(rows: Sequence[DetectionRow], sources: Mapping[int, SourceFrame | None]) -> list[FrameBoxes]:
    """Frames with detections in the order of the videos; `sources` is by detection id, None = no frame."""
    groups: dict[SourceFrame, list[DetectionRow]] = {}
    for row in rows:
        source = sources[row.id]
        if source is not None:
            groups.setdefault(source, []).append(row)
    return [FrameBoxes(source, own[0].time_s, tuple(own)) for source, own in sorted(groups.items())]


def choose_frames(frames: Sequence[FrameBoxes], limit: int) -> list[FrameBoxes]:
    """At most `limit` frames, in the order of the videos.

    The best-scored frame of every defect and then of every label come first, then all others by their best
    score; the earlier of two equal frames is taken.
    """
    if len(frames) <= limit:
        return list(frames)
    ranked = sorted(frames, key=lambda frame: (-frame.best_score, frame.source))
    chosen: dict[SourceFrame, FrameBoxes] = {}
    for name in ("defect_id", "label"):
        best: dict[object, tuple[float, FrameBoxes]] = {}
        for frame in frames:
            for row in frame.rows:
                key, score = getattr(row, name), row.score or 0.0
                if key is not None and (key not in best or score > best[key][0]):
                    best[key] = (score, frame)
        for _, frame in sorted(best.values(), key=lambda entry: -entry[0]):
            chosen.setdefault(frame.source, frame)
    for frame in ranked:
        chosen.setdefault(frame.source, frame)
    return sorted(list(chosen.values())[:limit], key=lambda frame: frame.source)


def draw_boxes(rgb: U8, rows: Sequence[DetectionRow], colors: Mapping[str, RGB]) -> U8:
    """A copy of the frame with its boxes: solid where the detection is mapped, dashed where it is not.

    Args:
        rgb: (h, w, 3) uncropped frame.
        rows: boxes normalised on this frame.
        colors: by label.
    """
    picture = np.ascontiguousarray(rgb).copy()
    height, width = picture.shape[:2]
    thickness = max(2, round(width / 480))
    for row in rows:
        left, top = int(row.box_x1 * width), int(row.box_y1 * height)
        right, bottom = int(row.box_x2 * width), int(row.box_y2 * height)
        color = colors[row.label]
        if row.outcome == Outcome.MAPPED:
            cv2.rectangle(picture, (left, top), (right, bottom), color, thickness, cv2.LINE_AA)
        else:
            _dashed_rectangle(picture, (left, top, right, bottom), color, max(1, thickness - 1))
        _tag(picture, _tag_text(row), (left, top), color)
    return picture


def draw_place(rgb: U8, number: int, place: tuple[float, float]) -> U8:
    """A copy of the frame with a cross where a defect lies that has no box on it; `place` is normalised."""
    picture = np.ascontiguousarray(rgb).copy()
    height, width = picture.shape[:2]
    at = (int(place[0] * width), int(place[1] * height))
    side = max(8, width // 40)
    cv2.drawMarker(picture, at, _PLACE, cv2.MARKER_CROSS, side, max(1, width // 480), cv2.LINE_AA)
    _tag(picture, f"D{number}", (at[0] + side // 2, at[1] - side // 2), _PLACE)
    return picture


def _tag_text(row: DetectionRow) -> str:
    label = row.label if len(row.label) <= _MAX_LABEL else row.label[: _MAX_LABEL - 1] + "~"
    score = f" {row.score:.2f}" if row.score is not None else ""
    place = f"D{row.defect_id} " if row.defect_id is not None else ""
    # OpenCV's font knows printable ASCII only.
    return "".join(c if 32 <= ord(c) < 127 else "?" for c in f"{place}{label}{score}")


def _dashed_rectangle(picture: U8, box: tuple[int, int, int, int], color: RGB, thickness: int) -> None:
    left, top, right, bottom = box
    for y in (top, bottom):
        for x in range(left, right, 2 * _DASH_PX):
            cv2.line(picture, (x, y), (min(x + _DASH_PX, right), y), color, thickness)
    for x in (left, right):
        for y in range(top, bottom, 2 * _DASH_PX):
            cv2.line(picture, (x, y), (x, min(y + _DASH_PX, bottom)), color, thickness)


def _tag(picture: U8, text: str, corner: tuple[int, int], color: RGB) -> None:
    """Dark text on a plate of the label's colour, above the corner or inside the picture's rim."""
    height, width = picture.shape[:2]
    scale = max(0.4, width / 2000)
    (wide, high), base = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 1)
    x = int(np.clip(corner[0], 0, max(0, width - wide - 6)))
    y = corner[1] - 3 if corner[1] - high - base - 4 >= 0 else corner[1] + high + base + 4
    y = int(np.clip(y, high + base + 2, height - 2))
    cv2.rectangle(picture, (x, y - high - base - 1), (x + wide + 6, y + 1), color, cv2.FILLED)
    cv2.putText(picture, text, (x + 3, y - base + 1), cv2.FONT_HERSHEY_SIMPLEX, scale, (20, 22, 24), 1, cv2.LINE_AA)


def draw_defect_numbers(rgb: U8, defect: NDArray[np.int32]) -> U8:
    """A copy of a rendering with a numbered mark beside every defect seen in it, no mark upon another.

    Args:
        rgb: (h, w, 3)
        defect: (h, w) defect number of each pixel, -1 none.
    """
    picture = np.ascontiguousarray(rgb).copy()
    width = defect.shape[1]
    scale = max(0.35, width / 2200)
    taken: list[Plate] = []
    for number in np.unique(defect[defect >= 0]):
        rows, columns = np.nonzero(defect == number)
        at = (int(np.median(columns)), int(np.median(rows)))
        text = f"D{number}"
        size, _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, 1)
        plate = _free_plate(at, (size[0] + 10, size[1] + 12), defect.shape, taken)
        taken.append(plate)
        left, top, right, bottom = plate
        cv2.line(picture, at, ((left + right) // 2, (top + bottom) // 2), _INK, 1, cv2.LINE_AA)
        cv2.rectangle(picture, (left, top), (right, bottom), (255, 255, 255), cv2.FILLED)
        cv2.rectangle(picture, (left, top), (right, bottom), _INK, 1)
        start = (left + 5, bottom - 6)
        cv2.putText(picture, text, start, cv2.FONT_HERSHEY_SIMPLEX, scale, (150, 0, 0), 1, cv2.LINE_AA)
    return picture


def _free_plate(at: tuple[int, int], size: tuple[int, int], shape: tuple[int, ...], taken: Sequence[Plate]) -> Plate:
    """The first plate around a place, going round it and outwards, that covers no other; inside the picture."""
    height, width = shape[:2]
    plate = (0, 0, size[0], size[1])
    for reach in (0.045, 0.07, 0.1):
        for angle in np.radians([-45, -135, 45, 135, -90, 90, 0, 180]):
            x = at[0] + reach * width * np.cos(angle) - size[0] / 2
            y = at[1] + reach * width * np.sin(angle) - size[1] / 2
            left = int(np.clip(x, 2, max(2, width - size[0] - 2)))
            top = int(np.clip(y, 2, max(2, height - size[1] - 2)))
            plate = (left, top, left + size[0], top + size[1])
            if not any(_touch(plate, other) for other in taken):
                return plate
    return plate


def _touch(a: Plate, b: Plate) -> bool:
    return a[0] <= b[2] and b[0] <= a[2] and a[1] <= b[3] and b[1] <= a[3]
