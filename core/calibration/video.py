"""Calibration from a video of a board: the views it is made of, and what came out."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from core.calibration.board import Board, CornerFinder, Corners, what_is_seen
from core.calibration.solve import MIN_VIEWS, Solution, solve, too_few
from core.errors import BadInput
from core.geometry.lens import LensModel
from core.video.factory import reopen_video
from core.video.pictures import find_pictures
from core.video.probe import probe_video
from core.video.shown import shown_frames

F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

LOOKED_AT = 150
"""Frames that are searched for the board, evenly spread over the video, at most."""
BLURRED = 0.5
"""A view with less than this share of the median sharpness is left out."""
NEW_VIEW = 0.01
"""A view whose board lies within this share of the picture of that of a chosen one tells nothing new."""
SHOWN_PICTURES = 3
"""Frames that are searched for any other board when this one is in none."""
_PICTURE_RATE = 1.0
"""Frames per second of a folder of pictures, whose times nobody asks for here."""

Progress = Callable[[int, int], None]
"""Called with the frames looked at, and to be looked at."""


@dataclass(frozen=True)
class View:
    """A frame that shows the board."""

    frame: int
    """Counts decoded frames from 0."""
    corners: Corners
    sharpness: float
    outline: F64
    """(8,) where a homography puts the four outer corners of the board, over the picture's size."""


@dataclass(frozen=True)
class VideoCalibration:
    """A calibration from a video, with the frames behind it."""

    solution: Solution
    looked_at: int
    with_board: int
    frames: tuple[int, ...]
    """Of the views used."""
    left_out: tuple[int, ...]
    """Of the views that fit badly."""


def calibrate_video(
    video: Path,
    board: Board,
    model: LensModel,
    *,
    max_views: int = 40,
    progress: Progress = lambda done, total: None,
) -> VideoCalibration:
    """Calibrate the lens that filmed a board.

    Args:
        video: file, folder or zip of pictures.
        board: that it shows.
        model: OPENCV_FISHEYE or OPENCV.
        max_views: sharp and different views that the lens is fitted to, at most.
        progress: see `Progress`.

    Raises:
        BadInput: `no_board` (naming the board that is seen instead, if any), `too_few_views`, `no_calibration`, or
            what is wrong with the video.
    """
    size_px, looked_at, views, others = _find(video, board, progress)
    if not views:
        seen = what_is_seen(others, board)
        hint = f"; {seen}" if seen else ""
        raise BadInput(f"the board is in none of {looked_at} frames{hint}", code="no_board", where="video")
    chosen = choose_views(views, max_views)
    if len(chosen) < MIN_VIEWS:
        raise too_few(
            len(chosen), f"{len(views)} of {looked_at} frames show the board, blurred or unmoved ones among them"
        )
    solution = solve(board, [view.corners for view in chosen], size_px, model)
    used, left_out = (tuple(chosen[row].frame for row in rows) for rows in (solution.used, solution.left_out))
    return VideoCalibration(solution, looked_at, len(views), used, left_out)


def choose_views(views: Sequence[View], most: int) -> list[View]:
    """The sharp views that differ most from each other, in the order of the video.

    Each is the one whose board lies farthest from those of all chosen before; the first is the sharpest.
    """
    limit = BLURRED * float(np.median([view.sharpness for view in views]))
    sharp = [view for view in views if view.sharpness >= limit]
    outlines = np.array([view.outline for view in sharp])
    chosen = [int(np.argmax([view.sharpness for view in sharp]))]
    distance = np.full(len(sharp), np.inf)
    while len(chosen) < most:
        distance = np.minimum(distance, np.abs(outlines - outlines[chosen[-1]]).mean(axis=1))
        farthest = int(np.argmax(distance))
        if distance[farthest] < NEW_VIEW:
            break
        chosen.append(farthest)
    return [sharp[row] for row in sorted(chosen)]


def _find(video: Path, board: Board, progress: Progress) -> tuple[tuple[int, int], int, list[View], list[U8]]:
    """Size of the frames as shown, how many were looked at, those with the board, and a few pictures without it."""
    info = probe_video(video, allow_truncated=True, fps=_rate(video)).info
    wanted = np.unique(np.linspace(0, info.n_frames - 1, LOOKED_AT).round().astype(np.int64))
    few = set(wanted[:: max(1, len(wanted) // SHOWN_PICTURES)].tolist())
    finder, points = CornerFinder(board), board.points()
    views: list[View] = []
    others: list[U8] = []
    size_px, done = (0, 0), 0
    with reopen_video(video, info) as reader:
        for frame in shown_frames(reader.frames(), info):
            index = frame.decoded.index
            if done == len(wanted) or index < wanted[done]:
                continue
            gray = np.asarray(cv2.cvtColor(frame.rgb(), cv2.COLOR_RGB2GRAY), np.uint8)
            size_px = gray.shape[1], gray.shape[0]
            corners = finder.find(gray)
            outline = None if corners is None else _outline(points, corners, size_px)
            if corners is not None and outline is not None:
                views.append(View(index, corners, _sharpness(gray, corners), outline))
            elif index in few:
                others.append(gray)
            done += 1
            progress(done, len(wanted))
    return size_px, done, views, others


def _rate(video: Path) -> float | None:
    """Frames per second of pictures; None for a file, which has times or a rate."""
    pictures = find_pictures(video)
    if pictures is None:
        return None
    pictures.close()
    return _PICTURE_RATE


def _sharpness(gray: U8, corners: Corners) -> float:
    """Spread of the Laplacian over that of the picture, within the box of the corners: independent of the light."""
    low = np.maximum(np.floor(corners.xy.min(axis=0)), 0).astype(np.int64)
    high = np.ceil(corners.xy.max(axis=0)).astype(np.int64) + 1
    part = gray[low[1] : high[1], low[0] : high[0]]
    return float(cv2.Laplacian(part, cv2.CV_64F).std() / max(float(part.std()), 1.0))


def _outline(points: F64, corners: Corners, size_px: tuple[int, int]) -> F64 | None:
    """See `View.outline`; a homography passes over what the lens bends, which is enough to tell views apart.

    None for corners that lie on a line.
    """
    H, _ = cv2.findHomography(points[corners.ids][:, :2], corners.xy)
    if np.shape(H) != (3, 3):  # OpenCV's types leave out that it is None then
        return None
    (x0, y0), (x1, y1) = points[:, :2].min(axis=0), points[:, :2].max(axis=0)
    ends = np.array([[[x0, y0], [x1, y0], [x1, y1], [x0, y1]]])
    placed = cv2.perspectiveTransform(ends, H).reshape(-1, 2) / size_px
    return np.asarray(np.clip(placed, -1.0, 2.0).ravel())
