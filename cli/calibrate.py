"""`bladeatlas calibrate`: the lens from a video of a board, written as a file that `--calibration` reads."""

from __future__ import annotations

import argparse

from cli.terminal import say, say_json
from core.calibration.board import parse_board
from core.calibration.files import write_calibration
from core.calibration.solve import GRID, MIN_VIEWS
from core.calibration.video import VideoCalibration, calibrate_video
from core.errors import BadInput
from core.geometry.lens import LensModel

_MODELS = {"fisheye": LensModel.OPENCV_FISHEYE, "pinhole": LensModel.OPENCV}


def command(parsed: argparse.Namespace) -> int:
    """Calibrate, write the file, and say what it can be trusted for."""
    board = parse_board(parsed.board)
    if parsed.views < MIN_VIEWS:
        raise BadInput(f"{parsed.views} views; at least {MIN_VIEWS} are needed", where="--views")
    if not parsed.out.parent.is_dir():
        raise BadInput(f"there is no folder '{parsed.out.parent}'", where="--out")
    found = calibrate_video(parsed.video, board, _MODELS[parsed.model], max_views=parsed.views)
    solution = found.solution
    notes: dict[str, str | int | float] = {
        "board": parsed.board,
        "views_used": len(found.frames),
        "rms_px": round(solution.rms_px, 4),
        "covered": round(solution.covered, 4),
    }
    write_calibration(parsed.out, solution.calibration, notes)
    if parsed.json:
        say_json({"schema_version": 1, "out": str(parsed.out), **_record(found)}, indent=1)
    else:
        say(f"{parsed.out}: {solution.calibration.model}", *(f"  {line}" for line in _lines(found)))
    return 0


def _record(found: VideoCalibration) -> dict[str, object]:
    solution = found.solution
    return {
        **solution.calibration.options(),
        "frames_looked_at": found.looked_at,
        "frames_with_board": found.with_board,
        "frames_used": list(found.frames),
        "frames_left_out": list(found.left_out),
        "corners": solution.n_corners,
        "corners_left_out": solution.corners_left_out,
        "rms_px": solution.rms_px,
        "covered": solution.covered,
        "reach": solution.reach,
        "fov_deg": list(solution.fov_deg),
        "doubts": list(solution.warnings),
    }


def _lines(found: VideoCalibration) -> list[str]:
    solution = found.solution
    lens = solution.calibration.lens
    seen = f"{found.with_board} of {found.looked_at} frames looked at show the board"
    left_out = f", {len(found.left_out)} left out that fit badly" if found.left_out else ""
    fov = " x ".join("unknown" if angle is None else f"{angle:.1f}" for angle in solution.fov_deg)
    cells = f"{GRID[0]}x{GRID[1]} cells"
    corners_left_out = f", {solution.corners_left_out} left out that fit badly" if solution.corners_left_out else ""
    return [
        f"views used: {len(found.frames)} ({seen}{left_out})",
        f"error: {solution.rms_px:.3f} px (root mean square of {solution.n_corners} corners{corners_left_out})",
        f"focal length: {lens.fx:.2f}, {lens.fy:.2f} px; principal point: {lens.cx:.2f}, {lens.cy:.2f} px",
        f"field of view: {fov} degrees",
        f"corners: in {solution.covered:.0%} of {cells}, out to {solution.reach:.0%} of the half diagonal",
        *(f"warning: not to be trusted: {warning}" for warning in solution.warnings),
    ]
