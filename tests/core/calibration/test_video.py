from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from bench.boards import difference_px, true_camera, write_pictures
from core.calibration.board import Corners, parse_board
from core.calibration.files import read_calibration, write_calibration
from core.calibration.solve import MIN_VIEWS, solve
from core.calibration.video import VideoCalibration, View, calibrate_video, choose_views
from core.errors import BadInput
from core.geometry.lens import LensModel
from tests.core.making_films import ffmpeg

pytestmark = pytest.mark.slow

SIZE = (400, 300)
BOARD = parse_board("charuco:7x5:10:7:DICT_4X4_50")
CHESSBOARD = parse_board("chessboard:6x5:10")
VIEWS = 12


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Views of the ChArUco board through the fisheye."""
    folder = tmp_path_factory.mktemp("board")
    write_pictures(folder, BOARD, true_camera(LensModel.OPENCV_FISHEYE, SIZE), VIEWS)
    return folder


@pytest.fixture(scope="module")
def few(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Too few views of the same."""
    folder = tmp_path_factory.mktemp("few")
    write_pictures(folder, BOARD, true_camera(LensModel.OPENCV_FISHEYE, SIZE), 3)
    return folder


@pytest.fixture(scope="module")
def found(pictures: Path) -> VideoCalibration:
    return calibrate_video(pictures, BOARD, LensModel.OPENCV_FISHEYE)


def test_a_fisheye_is_found_again_from_pictures_of_a_board(found: VideoCalibration, pictures: Path) -> None:
    assert found.looked_at == VIEWS
    assert len(found.frames) >= MIN_VIEWS
    assert found.solution.rms_px < 0.3
    truth = true_camera(LensModel.OPENCV_FISHEYE, SIZE)
    assert difference_px(found.solution.calibration, truth, pictures, BOARD).max() < 0.3


def test_a_written_calibration_is_read_by_us_and_by_opencv(found: VideoCalibration, tmp_path: Path) -> None:
    calibration = found.solution.calibration
    path = tmp_path / "lens.yml"
    write_calibration(path, calibration, {"rms_px": 0.25, "board": "charuco:7x5:10:7:DICT_4X4_50"})
    again = read_calibration(path)
    assert (again.model, again.size_px) == (calibration.model, SIZE)
    assert again.params == pytest.approx(calibration.params, rel=1e-15, abs=1e-12)
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
    assert storage.getNode("camera_matrix").mat()[0, 2] == pytest.approx(calibration.params[2] - 0.5)
    assert storage.getNode("distortion_coefficients").mat().ravel() == pytest.approx(calibration.params[4:])
    assert storage.getNode("board").string() == "charuco:7x5:10:7:DICT_4X4_50"


@pytest.mark.tool("ffmpeg")
def test_a_film_of_a_board_gives_what_its_pictures_give(
    found: VideoCalibration, pictures: Path, tmp_path: Path
) -> None:
    words = ("-framerate", "5", "-i", pictures / "%04d.png", "-c:v", "ffv1")
    again = calibrate_video(ffmpeg(tmp_path / "board.mkv", *words), BOARD, LensModel.OPENCV_FISHEYE)
    assert again.looked_at == VIEWS
    assert again.solution.calibration.params[:4] == pytest.approx(found.solution.calibration.params[:4], abs=0.5)


def test_a_perspective_lens_is_found_again(tmp_path: Path) -> None:
    truth = true_camera(LensModel.OPENCV, SIZE)
    write_pictures(tmp_path, BOARD, truth, 20)
    solution = calibrate_video(tmp_path, BOARD, LensModel.OPENCV).solution
    assert solution.rms_px < 0.3
    off = difference_px(solution.calibration, truth, tmp_path, BOARD)
    # Measured: 0.12 px in the median, 0.25 px at 95 %. At the rim of the hull, where hardly any corner was, it is 0.31.
    assert np.percentile(off, 95) < 0.3
    assert off.max() < 0.5


@pytest.mark.parametrize(
    ("board", "words"),
    [
        ("charuco:7x5:10:7:DICT_6X6_50", "markers of DICT_4X4_... are seen"),
        ("chessboard:9x6:10", "none of 3 frames"),
    ],
)
def test_another_board_than_the_one_named_is_said(few: Path, board: str, words: str) -> None:
    with pytest.raises(BadInput, match=words) as caught:
        calibrate_video(few, parse_board(board), LensModel.OPENCV_FISHEYE)
    assert caught.value.code == "no_board"


def test_a_chessboard_of_another_size_is_named(tmp_path: Path) -> None:
    write_pictures(tmp_path, CHESSBOARD, true_camera(LensModel.OPENCV, SIZE), 4)
    with pytest.raises(BadInput, match="a chessboard of 6x5 inner corners is seen"):
        calibrate_video(tmp_path, parse_board("chessboard:7x5:10"), LensModel.OPENCV)


def test_too_few_views_are_refused(few: Path) -> None:
    with pytest.raises(BadInput, match="6 are needed") as caught:
        calibrate_video(few, BOARD, LensModel.OPENCV_FISHEYE)
    assert caught.value.code == "too_few_views"


def seen_by(truth: NDArray[np.float64], count: int, spread: float, seed: int = 0) -> list[Corners]:
    """Corners of the chessboard through OpenCV's fisheye with (fx, fy, cx, cy, k1..k4), in views over a share of it."""
    rng = np.random.default_rng(seed)
    points = CHESSBOARD.points()
    K = np.array([[truth[0], 0, truth[2]], [0, truth[1], truth[3]], [0, 0, 1.0]])
    views = []
    for _ in range(count):
        turn = np.radians(rng.uniform(-30, 30, 3))
        shift = np.append(rng.uniform(-spread, spread, 2) * [60, 40], 70.0)
        middle = cv2.Rodrigues(turn)[0] @ points.mean(axis=0)
        xy, _ = cv2.fisheye.projectPoints(points[None], turn, shift - middle, K, truth[4:])
        views.append(Corners(np.arange(len(points)), xy.reshape(-1, 2) + rng.normal(0, 0.05, (len(points), 2))))
    return views


LENS = np.array([210.0, 210.0, 200.0, 150.0, 0.02, 0.0, 0.0, 0.0])


def test_views_that_fit_badly_are_left_out() -> None:
    views = seen_by(LENS, 12, 1.0)
    bent = views[5].xy + np.random.default_rng(1).normal(0, 3.0, views[5].xy.shape)
    views[5] = Corners(views[5].ids, bent)
    solution = solve(CHESSBOARD, views, SIZE, LensModel.OPENCV_FISHEYE)
    assert solution.left_out == (5,)
    assert solution.calibration.params[:2] == pytest.approx(LENS[:2], abs=0.5)
    assert solution.rms_px == pytest.approx(0.05 * np.sqrt(2), rel=0.1)


def test_corners_that_fit_badly_are_left_out_of_good_views() -> None:
    views = seen_by(LENS, 12, 1.0)
    shifted = views[2].xy.copy()
    shifted[[3, 11]] += [0.9, -0.6]
    views[2] = Corners(views[2].ids, shifted)
    solution = solve(CHESSBOARD, views, SIZE, LensModel.OPENCV_FISHEYE)
    all_corners = sum(len(view.ids) for view in views)
    assert solution.left_out == ()
    assert 2 <= solution.corners_left_out <= 6, "they draw the pose, and with it their neighbours"
    assert solution.n_corners == all_corners - solution.corners_left_out
    assert solution.rms_px == pytest.approx(0.05 * np.sqrt(2), rel=0.1)


def test_a_view_keeps_a_corner_without_which_it_holds_no_pose() -> None:
    views = seen_by(LENS, 12, 1.0)
    eight = np.array([0, 1, 2, 6, 7, 8, 12, 13])
    assert CHESSBOARD.held_by(eight)
    assert not CHESSBOARD.held_by(eight[1:]), "too few"
    assert not CHESSBOARD.held_by(np.arange(12)), "two rows"
    xy = views[2].xy[eight]
    xy[4] += [0.6, 0.0]
    views[2] = Corners(eight, xy)
    solution = solve(CHESSBOARD, views, SIZE, LensModel.OPENCV_FISHEYE)
    assert (solution.left_out, solution.corners_left_out) == ((), 0)


def test_views_in_the_middle_only_raise_a_warning() -> None:
    wide, narrow = (
        solve(CHESSBOARD, seen_by(LENS, 12, spread), SIZE, LensModel.OPENCV_FISHEYE) for spread in (1.0, 0.1)
    )
    assert wide.warnings == ()
    assert narrow.covered < wide.covered
    assert "of the picture" in narrow.warnings[0]


def test_blurred_views_and_views_like_others_are_not_chosen() -> None:
    def view(frame: int, at: float, sharpness: float = 1.0) -> View:
        return View(frame, Corners(np.zeros(0, np.int64), np.zeros((0, 2))), sharpness, np.full(8, at))

    views = [view(0, 0.1), view(1, 0.1001), view(2, 0.9), view(3, 0.5, sharpness=0.1), view(4, 0.6)]
    assert [one.frame for one in choose_views(views, 9)] == [0, 2, 4]
    assert [one.frame for one in choose_views(views, 2)] == [0, 2]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "chessboard",
        "chessboard:9:10",
        "chessboard:9x6:0",
        "chessboard:9x6:nan",
        "chessboard:2x6:10",
        "charuco:11x8:15:11",
        "charuco:11x8:15:16:DICT_5X5_100",
        "charuco:11x8:15:11:DICT_9X9_100",
        "charuco:40x40:15:11:DICT_5X5_100",
        "circles:9x6:10",
    ],
)
def test_what_is_no_board_is_refused(text: str) -> None:
    with pytest.raises(BadInput) as caught:
        parse_board(text)
    assert caught.value.code == "bad_board"


def test_boards_as_they_are_named() -> None:
    assert parse_board("chessboard:9x6:10").points()[[0, 8, 9, 53]].tolist() == [
        [10, 10, 0],
        [90, 10, 0],
        [10, 20, 0],
        [90, 60, 0],
    ]
    board = parse_board("charuco:11x8:15:11:DICT_5X5_100")
    assert np.asarray(board.charuco().getChessboardCorners()) == pytest.approx(board.points())
