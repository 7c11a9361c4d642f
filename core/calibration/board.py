"""Boards that lenses are calibrated with: how a user names one, and where its corners are in a picture."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import cv2
import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
U8 = NDArray[np.uint8]

MIN_CORNERS = 8
"""Corners of a ChArUco board that a view needs; fewer do not hold its pose."""
MIN_LINES = 3
"""Rows, and columns, that these have to be of."""
MIN_MARKERS = 4
"""Markers from which on they are taken for a board's."""
DICTIONARIES = tuple(
    name
    for name in dir(cv2.aruco)
    if re.fullmatch(r"DICT_(\dX\d_\d+|APRILTAG_\w+h\d+|ARUCO_ORIGINAL|ARUCO_MIP_36h12)", name)
)
"""OpenCV's, by name."""
LARGEST_DICTIONARIES = tuple(name for name in DICTIONARIES if re.search(r"_1000$|ORIGINAL$|APRILTAG", name))
"""Those whose first markers the smaller dictionaries of the same size hold."""
_FORMS = "chessboard:COLUMNSxROWS:SQUARE (inner corners) or charuco:COLUMNSxROWS:SQUARE:MARKER:DICTIONARY (squares)"
_PLACE = "--board"


class BoardKind(StrEnum):
    """Kinds of boards."""

    CHESSBOARD = "chessboard"
    CHARUCO = "charuco"


@dataclass(frozen=True)
class Board:
    """A flat board. Lengths are in any one unit: a lens does not depend on it."""

    kind: BoardKind
    columns: int
    """Inner corners of a chessboard in a row, squares of a ChArUco board."""
    rows: int
    square: float
    marker: float = 0.0
    """Side of the markers of a ChArUco board."""
    dictionary: str = ""

    def points(self) -> F64:
        """(n, 3) inner corners on the plane z = 0, row by row."""
        inner = (self.columns, self.rows) if self.kind == BoardKind.CHESSBOARD else (self.columns - 1, self.rows - 1)
        x, y = np.meshgrid(np.arange(1.0, inner[0] + 1), np.arange(1.0, inner[1] + 1))
        return self.square * np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)

    def held_by(self, ids: I64) -> bool:
        """Whether the corners (n,) of a view, rows of `points`, hold its pose: those of two rows or columns do not."""
        inner = self.columns if self.kind == BoardKind.CHESSBOARD else self.columns - 1
        spread = min(len(np.unique(ids // inner)), len(np.unique(ids % inner)))
        return len(ids) >= MIN_CORNERS and spread >= MIN_LINES

    def charuco(self) -> cv2.aruco.CharucoBoard:
        """OpenCV's object of a ChArUco board."""
        return cv2.aruco.CharucoBoard((self.columns, self.rows), self.square, self.marker, _dictionary(self.dictionary))


@dataclass(frozen=True)
class Corners:
    """The corners of a board that a picture shows."""

    ids: NDArray[np.int64]
    """(n,) rows of `Board.points`."""
    xy: F64
    """(n, 2) px, pixel centres at whole numbers as in OpenCV."""


def parse_board(text: str) -> Board:
    """The board that a user names.

    Args:
        text: ``chessboard:9x6:10`` has 9 x 6 inner corners and squares of 10 mm; ``charuco:11x8:15:11:DICT_5X5_100``
            has 11 x 8 squares of 15 mm with markers of 11 mm out of OpenCV's dictionary of that name.

    Raises:
        BadInput: `bad_board`.
    """
    kind, *rest = text.strip().split(":")
    fields = {BoardKind.CHESSBOARD: 2, BoardKind.CHARUCO: 4}
    size = re.fullmatch(r"(\d{1,3})x(\d{1,3})", rest[0]) if rest else None
    if kind not in fields or size is None or len(rest) != fields[BoardKind(kind)]:
        raise _bad(f"'{text}' is no board: {_FORMS}")
    columns, rows = int(size[1]), int(size[2])
    try:
        lengths = [float(value) for value in rest[1:3]]
    except ValueError:
        raise _bad(f"'{text}' is no board: {_FORMS}") from None
    if not (np.isfinite(lengths).all() and min(lengths) > 0):
        raise _bad("the sides of squares and markers are lengths above 0")
    if kind == BoardKind.CHESSBOARD:
        if min(columns, rows) < 3 or max(columns, rows) > 100:
            raise _bad(f"a chessboard of {columns}x{rows} inner corners is not used; 3x3 to 100x100 are")
        return Board(BoardKind.CHESSBOARD, columns, rows, lengths[0])
    square, marker = lengths
    if min(columns, rows) < 3 or max(columns, rows) > 100:
        raise _bad(f"a ChArUco board of {columns}x{rows} squares is not used; 3x3 to 100x100 are")
    if marker >= square:
        raise _bad(f"markers of {marker:g} do not fit into squares of {square:g}")
    if rest[3] not in DICTIONARIES:
        raise _bad(f"unknown dictionary '{rest[3]}'; known: {', '.join(DICTIONARIES)}")
    needed, held = columns * rows // 2, len(_dictionary(rest[3]).bytesList)
    if needed > held:
        raise _bad(f"a board of {columns}x{rows} squares has {needed} markers; {rest[3]} holds {held}")
    return Board(BoardKind.CHARUCO, columns, rows, square, marker, rest[3])


class CornerFinder:
    """Finds the corners of one board in grey pictures."""

    def __init__(self, board: Board) -> None:
        """Prepare OpenCV's detector of a ChArUco board, or nothing for a chessboard."""
        self._board = board
        self._detector = None if board.kind == BoardKind.CHESSBOARD else cv2.aruco.CharucoDetector(board.charuco())

    def find(self, gray: U8) -> Corners | None:
        """The corners in a (h, w) picture; None where the board, or enough of it, is not seen."""
        if self._detector is None:
            return self._chessboard(gray)
        xy, ids, _, _ = self._detector.detectBoard(gray)
        order = np.asarray([] if ids is None else ids, np.int64).ravel()
        return Corners(order, np.asarray(xy, np.float64).reshape(-1, 2)) if self._board.held_by(order) else None

    def _chessboard(self, gray: U8) -> Corners | None:
        size = (self._board.columns, self._board.rows)
        found, xy = cv2.findChessboardCornersSB(gray, size, flags=cv2.CALIB_CB_NORMALIZE_IMAGE)
        if not found:
            return None
        return Corners(np.arange(size[0] * size[1]), np.asarray(xy, np.float64).reshape(-1, 2))


def what_is_seen(pictures: Sequence[U8], board: Board) -> str:
    """In words, which other board pictures show in which `board` is not found; empty when none is recognised."""
    if board.kind == BoardKind.CHESSBOARD:
        for gray in pictures:
            found, _, meta = cv2.findChessboardCornersSBWithMeta(gray, (3, 3), flags=cv2.CALIB_CB_LARGER)
            if found:
                rows, columns = np.asarray(meta).shape[:2]
                return f"a chessboard of {columns}x{rows} inner corners is seen"
    own = [board.dictionary] if board.dictionary else []
    best, seen = "", 0
    for name in [*own, *LARGEST_DICTIONARIES]:
        detector = cv2.aruco.ArucoDetector(_dictionary(name))
        n_markers = max((len(detector.detectMarkers(gray)[0]) for gray in pictures), default=0)
        if n_markers > seen:
            best, seen = name, n_markers
    if seen < MIN_MARKERS:
        return ""
    if best == board.dictionary:
        return f"markers of {best} are seen, but not in the squares of this board (older boards begin with a marker)"
    return f"markers of {best.replace('1000', '...')} are seen"


def _dictionary(name: str) -> cv2.aruco.Dictionary:
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))


def _bad(message: str) -> BadInput:
    return BadInput(message, code="bad_board", where=_PLACE)
