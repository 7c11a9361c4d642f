"""A lens from views of a board, by OpenCV's calibration of its fisheye or its perspective model.

Fisheye: Kannala and Brandt (2006) as in cv2.fisheye; perspective: Zhang (2000) with k1, k2, p1, p2.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from core.calibration.board import Board, Corners
from core.calibration.model import Calibration, calibration_of
from core.errors import BadInput
from core.geometry.lens import Lens, LensModel

F64 = NDArray[np.float64]

MIN_VIEWS = 6
"""Views that are needed, before and after those that fit badly are left out."""
OUTLIER, OUTLIER_PX = 2.5, 0.3
"""A view is left out when its error is more than so many times the median view's, and more than so many px."""
CORNER_OUTLIER, CORNER_OUTLIER_PX = 4.0, 0.2
"""A corner is left out when its error is more than so many times the median corner's, and more than so many px.

OpenCV places most corners of a ChArUco board within 0.06 px of the true ones, and some 1 % of them up to 1 px off."""
FOCAL_STARTS = (1.0 / np.pi, 0.45, 0.65, 0.95)
"""Focal lengths that the fisheye's search starts from, over the longer side: 180, 127, 88 and 60 degrees."""

GRID = (8, 6)
"""Cells of the picture that coverage is counted in, across and down."""
MIN_COVERED = 0.6
MIN_REACH = 0.8
MAX_RMS_PX = 1.0
_CRITERIA = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 200, 1e-9)


@dataclass(frozen=True)
class Solution:
    """A calibration, and what speaks for it and against it."""

    calibration: Calibration
    used: tuple[int, ...]
    """Rows of the views that it follows from."""
    left_out: tuple[int, ...]
    """Rows of the views that fit badly."""
    n_corners: int
    """Corners of the used views that it follows from."""
    corners_left_out: int
    """Those of the same views that fit badly."""
    rms_px: float
    """Root of the mean squared distance of a corner, of those it follows from, from where the lens shows it."""
    covered: float
    """Share of the cells of the picture in which there is a corner of a used view."""
    reach: float
    """Distance of the farthest corner from the middle, over half the diagonal."""
    fov_deg: tuple[float | None, float | None]
    """Across and down; None where the lens turns back before the border."""
    warnings: tuple[str, ...]
    """Why it should not be trusted, in words; empty when nothing speaks against it."""


def solve(board: Board, views: Sequence[Corners], size_px: tuple[int, int], model: LensModel) -> Solution:
    """Calibrate, leaving out the views that fit badly, and then the corners that do.

    Args:
        board: that the views show.
        views: corners of at least `MIN_VIEWS` pictures.
        size_px: width and height of the pictures.
        model: OPENCV_FISHEYE or OPENCV.

    Raises:
        BadInput: `too_few_views`, or `no_calibration` when no lens fits.
    """
    kept = dict(enumerate(views))
    points = board.points()
    while True:
        if len(kept) < MIN_VIEWS:
            raise too_few(
                len(kept), f"the others of {len(views)} fit no common lens; is the board flat, and the one named?"
            )
        placed = [points[view.ids] for view in kept.values()]
        lens, errors = _fit(placed, [view.xy for view in kept.values()], size_px, model)
        each = np.array([_rms(error) for error in errors])
        good = each <= max(OUTLIER_PX, OUTLIER * float(np.median(each)))
        if not good.all():
            kept = {row: view for (row, view), fits in zip(kept.items(), good, strict=True) if fits}
            continue
        fitting = _fitting_corners(board, kept, errors)
        if _n_corners(fitting) == _n_corners(kept):
            return _judged(lens, views, kept, _rms(np.concatenate(errors)), size_px)
        kept = fitting


def _n_corners(views: Mapping[int, Corners]) -> int:
    return sum(len(view.ids) for view in views.values())


def _fitting_corners(board: Board, views: Mapping[int, Corners], errors: Sequence[F64]) -> dict[int, Corners]:
    """The views without the corners that fit badly; one that these leave too few is as it was."""
    off = [np.linalg.norm(error, axis=1) for error in errors]
    limit = max(CORNER_OUTLIER_PX, CORNER_OUTLIER * float(np.median(np.concatenate(off))))
    fitting = {}
    for (row, view), own in zip(views.items(), off, strict=True):
        rest = Corners(view.ids[own <= limit], view.xy[own <= limit])
        fitting[row] = rest if board.held_by(rest.ids) else view
    return fitting


def too_few(count: int, why: str) -> BadInput:
    """The error of a video with too few usable views."""
    return BadInput(f"{count} usable views of the board, {MIN_VIEWS} are needed: {why}", code="too_few_views")


def _rms(errors: F64) -> float:
    """Root of the mean squared length of (n, 2) errors."""
    return float(np.sqrt((errors**2).sum(axis=1).mean()))


def _fit(
    points: Sequence[F64], seen: Sequence[F64], size_px: tuple[int, int], model: LensModel
) -> tuple[Lens, list[F64]]:
    """The lens of all views, and the errors (n, 2) of each in px."""
    found = (
        _fit_fisheye(points, seen, size_px)
        if model == LensModel.OPENCV_FISHEYE
        else _fit_perspective(points, seen, size_px)
    )
    if found is None:
        raise BadInput(
            "no lens fits the views; is the board flat, and the one named?", code="no_calibration", where="video"
        )
    return found


def _fit_fisheye(points: Sequence[F64], seen: Sequence[F64], size_px: tuple[int, int]) -> tuple[Lens, list[F64]] | None:
    """OpenCV's search from several focal lengths; the fit of the smallest error counts."""
    flags = cv2.CALIB_RECOMPUTE_EXTRINSIC | cv2.CALIB_FIX_SKEW | cv2.CALIB_USE_INTRINSIC_GUESS
    boards, pictures = [p.reshape(1, -1, 3) for p in points], [xy.reshape(1, -1, 2) for xy in seen]
    fits = []
    for share in FOCAL_STARTS:
        focal = share * max(size_px)
        K = np.array([[focal, 0, size_px[0] / 2 - 0.5], [0, focal, size_px[1] / 2 - 0.5], [0, 0, 1]])
        try:
            rms, K, D, turns, shifts = cv2.fisheye.calibrate(
                boards, pictures, size_px, K, np.zeros((4, 1)), flags=flags, criteria=_CRITERIA
            )
        except cv2.error:  # a start from which the search leaves what can be projected
            continue
        if np.isfinite(rms):
            fits.append((float(rms), K, np.asarray(D, np.float64).ravel(), turns, shifts))
    if not fits:
        return None
    _, K, D, turns, shifts = min(fits, key=lambda fit: fit[0])
    errors = [
        cv2.fisheye.projectPoints(board, turn, shift, K, D)[0].reshape(-1, 2) - xy
        for board, turn, shift, xy in zip(boards, turns, shifts, seen, strict=True)
    ]
    k1, k2, k3, k4 = (float(value) for value in D)
    return _lens(np.asarray(K, np.float64), radial=(k1, k2, k3, k4)), errors


def _fit_perspective(
    points: Sequence[F64], seen: Sequence[F64], size_px: tuple[int, int]
) -> tuple[Lens, list[F64]] | None:
    boards, pictures = [p.astype(np.float32) for p in points], [xy.astype(np.float32) for xy in seen]
    try:
        _, K, D, turns, shifts = cv2.calibrateCamera(
            boards, pictures, size_px, np.eye(3), np.zeros(5), flags=cv2.CALIB_FIX_K3, criteria=_CRITERIA
        )
    except cv2.error:
        return None
    errors = [
        cv2.projectPoints(board, turn, shift, K, D)[0].reshape(-1, 2) - xy
        for board, turn, shift, xy in zip(points, turns, shifts, seen, strict=True)
    ]
    k1, k2, p1, p2 = (float(value) for value in np.ravel(D)[:4])
    return _lens(np.asarray(K, np.float64), radial=(k1, k2, 0.0, 0.0), tangential=(p1, p2), fisheye=False), errors


def _lens(
    K: F64,
    radial: tuple[float, float, float, float],
    tangential: tuple[float, float] = (0.0, 0.0),
    fisheye: bool = True,
) -> Lens:
    """A lens from OpenCV's camera matrix, whose pixel centres are at whole numbers."""
    return Lens(float(K[0, 0]), float(K[1, 1]), float(K[0, 2]) + 0.5, float(K[1, 2]) + 0.5, radial, tangential, fisheye)


def _judged(
    lens: Lens, views: Sequence[Corners], used: Mapping[int, Corners], rms_px: float, size_px: tuple[int, int]
) -> Solution:
    """What the used views cover of the picture, and whether that is enough."""
    size = np.array(size_px, np.float64)
    xy = np.concatenate([view.xy for view in used.values()]) + 0.5
    cells = np.clip((xy / size * GRID).astype(np.int64), 0, np.array(GRID) - 1)
    covered = len(np.unique(cells, axis=0)) / (GRID[0] * GRID[1])
    reach = float(np.linalg.norm(xy - size / 2, axis=1).max() / np.linalg.norm(size / 2))
    warnings = []
    if covered < MIN_COVERED:
        warnings.append(
            f"corners cover {covered:.0%} of the picture, {MIN_COVERED:.0%} are needed: move the board everywhere"
        )
    if reach < MIN_REACH:
        warnings.append(f"no corner is farther out than {reach:.0%} of the half diagonal, {MIN_REACH:.0%} are needed")
    if rms_px > MAX_RMS_PX:
        warnings.append(
            f"the error of {rms_px:.2f} px is above {MAX_RMS_PX:g} px: blurred views, or a board that is not flat"
        )
    fov = _fov_deg(lens.fx, lens.cx, size_px[0], lens), _fov_deg(lens.fy, lens.cy, size_px[1], lens)
    if None in fov:
        warnings.append("the lens turns back before the border of the picture, which no corner came near")
    calibration = calibration_of(lens, size_px, "the lens found")
    left_out = tuple(sorted(set(range(len(views))) - set(used)))
    corners_left_out = _n_corners({row: views[row] for row in used}) - len(xy)
    return Solution(
        calibration, tuple(used), left_out, len(xy), corners_left_out, rms_px, covered, reach, fov, tuple(warnings)
    )


def _fov_deg(focal: float, centre: float, length: int, lens: Lens) -> float | None:
    """Field of view through the principal point along one side of the picture."""
    sides = [lens.angle_at(part / focal) for part in (centre, length - centre)]
    return None if None in sides else float(np.degrees(sum(side for side in sides if side is not None)))
