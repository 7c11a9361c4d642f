"""Pictures of a calibration board through a known lens, and how well the lens is found again from them.

`bladeatlas-bench boards` renders 20 views through a fisheye and 20 through a perspective lens, calibrates from each,
and prints the reprojection error and the distance from the true lens over the part of the picture that has corners.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.calibration.board import Board, BoardKind, CornerFinder, parse_board
from core.calibration.model import Calibration
from core.calibration.video import calibrate_video
from core.geometry.lens import LensModel
from core.geometry.pose import transform

F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]

SIZE_PX = (960, 720)
LENSES: Mapping[LensModel, tuple[float, ...]] = {
    LensModel.OPENCV_FISHEYE: (520.0, 521.0, 486.0, 352.0, 0.03, -0.012, 0.006, -0.002),
    LensModel.OPENCV: (610.0, 611.0, 488.0, 366.0, -0.24, 0.07, 0.0006, -0.0004),
}
BOARDS = ("charuco:11x8:15:11:DICT_5X5_100", "chessboard:9x6:10")
_TEXTURE_PX = 48
"""Side of a square in the flat picture of a board."""
_FINER = 2
"""Samples of a pixel across and down."""


def flat_picture(board: Board) -> tuple[U8, F64]:
    """A board seen straight on with a white rim, and (2, 3) from board coordinates to its array indices."""
    if board.kind == BoardKind.CHARUCO:
        inside = board.charuco().generateImage((_TEXTURE_PX * board.columns, _TEXTURE_PX * board.rows))
    else:
        squares = np.indices((board.rows + 1, board.columns + 1)).sum(axis=0) % 2
        inside = np.kron(255 * squares, np.ones((_TEXTURE_PX, _TEXTURE_PX))).astype(np.uint8)
    picture = np.pad(inside, _TEXTURE_PX, constant_values=255)
    scale = _TEXTURE_PX / board.square
    return np.asarray(picture, np.uint8), np.array([[scale, 0, _TEXTURE_PX - 0.5], [0, scale, _TEXTURE_PX - 0.5]])


def poses(board: Board, camera: pycolmap.Camera, count: int, seed: int) -> list[tuple[F64, F64]]:
    """Rotations and translations (camera from board) of views spread over the picture, tilted by 20 to 40 degrees."""
    rng = np.random.default_rng(seed)
    points = board.points()
    middle, extent = points.mean(axis=0), float(np.ptp(points, axis=0).max()) + 2 * board.square
    columns = int(np.ceil(np.sqrt(count * camera.width / camera.height)))
    lines = int(np.ceil(count / columns))
    found = []
    for number in range(count):
        cell = np.array([number % columns + 0.5, number // columns + 0.5]) / [columns, lines]
        # Cells are pulled in a little: what lies half outside is no view of a chessboard.
        at = (0.5 + 0.62 * (cell - 0.5)) * [camera.width, camera.height]
        ray = np.append(np.asarray(camera.cam_from_img(at)).ravel(), 1.0)
        distance = extent * camera.mean_focal_length() / (camera.width * rng.uniform(0.42, 0.55))
        # Views straight on say nothing of the focal length.
        tilt = rng.uniform(20, 40, 2) * rng.choice([-1.0, 1.0], 2)
        turn = np.asarray(cv2.Rodrigues(np.radians([*tilt, rng.uniform(-35, 35)]))[0], np.float64)
        found.append((turn, distance * ray / np.linalg.norm(ray) - turn @ middle))
    return found


def sample_rays(camera: pycolmap.Camera) -> F64:
    """(n, 3) rays of the samples of all pixels, `_FINER` across and down in each."""
    v, u = np.mgrid[0 : _FINER * camera.height, 0 : _FINER * camera.width]
    pixels = (np.column_stack([u.ravel(), v.ravel()]) + 0.5) / _FINER
    return np.column_stack([np.asarray(camera.cam_from_img(pixels)), np.ones(len(pixels))])


def picture(board: Board, camera: pycolmap.Camera, rays: F64, pose: tuple[F64, F64]) -> U8:
    """(h, w) what the lens shows of a board: the ray of every sample is cut with the plane of the board."""
    R, t = pose
    texture, index = flat_picture(board)
    with np.errstate(divide="ignore", invalid="ignore"):
        depth = (R[:, 2] @ t) / (rays @ R[:, 2])
        on_board = (depth[:, None] * rays - t) @ R
    on_board[~(depth > 0)] = -1e6
    places = np.nan_to_num(transform(on_board[:, :2], index[:, :2], index[:, 2]), nan=-1e6).astype(np.float32)
    shape = (_FINER * camera.height, _FINER * camera.width)
    fine = cv2.remap(
        texture,
        places[:, 0].reshape(shape),
        places[:, 1].reshape(shape),
        cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=(90.0,),
    )
    return np.asarray(cv2.resize(fine, (camera.width, camera.height), interpolation=cv2.INTER_AREA), np.uint8)


def write_pictures(folder: Path, board: Board, camera: pycolmap.Camera, count: int = 20, seed: int = 0) -> None:
    """Write views of a board as numbered PNG files."""
    rng = np.random.default_rng(seed + 1)
    rays = sample_rays(camera)
    for number, pose in enumerate(poses(board, camera, count, seed)):
        noisy = picture(board, camera, rays, pose) + rng.normal(0.0, 2.0, (camera.height, camera.width))
        cv2.imwrite(str(folder / f"{number:04d}.png"), np.clip(noisy, 0, 255).astype(np.uint8))


def true_camera(model: LensModel, size_px: tuple[int, int] = SIZE_PX) -> pycolmap.Camera:
    """The lens that pictures are rendered through, at any size of the picture."""
    factor = size_px[0] / SIZE_PX[0]
    params = [value * (factor if at < 4 else 1.0) for at, value in enumerate(LENSES[model])]
    return pycolmap.Camera(model=str(model), width=size_px[0], height=size_px[1], params=params)


def difference_px(found: Calibration, truth: pycolmap.Camera, folder: Path, board: Board) -> F64:
    """(n,) distance between where both lenses show a ray, over a grid within the hull of the corners of a folder.

    One rotation between the two is free: the poses of the views take it up, and so does everything that is measured
    through a lens. A shift of the principal point is one to first order.
    """
    finder = CornerFinder(board)
    grays = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in sorted(folder.glob("*.png"))]
    corners = [finder.find(np.asarray(gray, np.uint8)) for gray in grays if gray is not None]
    hull = cv2.convexHull(np.concatenate([one.xy + 0.5 for one in corners if one is not None]).astype(np.float32))
    v, u = np.mgrid[0 : truth.height : 8, 0 : truth.width : 8] + 0.5
    pixels = np.column_stack([u.ravel(), v.ravel()])
    pixels = pixels[[cv2.pointPolygonTest(hull, (float(x), float(y)), False) >= 0 for x, y in pixels]]
    rays = np.column_stack([np.asarray(truth.cam_from_img(pixels)), np.ones(len(pixels))])
    lens = pycolmap.Camera(
        model=str(found.model), width=found.size_px[0], height=found.size_px[1], params=list(found.params)
    )
    back = np.column_stack([np.asarray(lens.cam_from_img(pixels)), np.ones(len(pixels))])
    unit = [one / np.linalg.norm(one, axis=1, keepdims=True) for one in (back, rays)]
    turn = Rotation.align_vectors(unit[0], unit[1])[0]
    return np.asarray(np.linalg.norm(np.asarray(lens.img_from_cam(turn.apply(rays))) - pixels, axis=1))


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Arguments of `bladeatlas-bench boards`."""
    parser.add_argument("--views", type=int, default=20, metavar="N", help="views of each board (20)")


def command(arguments: argparse.Namespace) -> None:
    """Print one line for each lens and board."""
    print("lens | board | views used | rms px | off the true lens px, median / 95 % / largest | corners cover")
    for model in LENSES:
        camera = true_camera(model)
        for name in BOARDS:
            board = parse_board(name)
            with tempfile.TemporaryDirectory() as folder:
                write_pictures(Path(folder), board, camera, arguments.views)
                solution = calibrate_video(Path(folder), board, model).solution
                off = difference_px(solution.calibration, camera, Path(folder), board)
            shares = " / ".join(f"{value:.3f}" for value in (*np.percentile(off, [50, 95]), off.max()))
            print(
                f"{model} | {name} | {len(solution.used)} | {solution.rms_px:.3f} | {shares} | {solution.covered:.0%}"
            )
