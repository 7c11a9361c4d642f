"""Where the lens model starts: focal length, principal point, and the choice between estimated focal lengths."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pycolmap

from core.flags import Flag, FlagFields, Severity
from core.settings.groups import CameraSettings
from core.stage import Facts

MODEL = "OPENCV_FISHEYE"
ESTIMATE_MODEL = "SIMPLE_RADIAL_FISHEYE"
"""Of the short spans that the estimate maps, see `core.sparse.focal`."""

MIN_REGISTERED, MIN_POINTS = 8, 100
"""Registered images and points below which a start has found nothing."""

REGISTERED_SLACK, POINTS_SLACK = 0.95, 0.9
"""Starts within these shares of the most registered images and points are equals; the smallest error decides."""

AGREE = 0.05
"""Starts that end within this share of the chosen focal length agree with it."""

MIN_AGREEMENT = 0.5
"""Where a smaller share of the starts agrees, the clip does not determine the focal length."""

FOV_RANGE_DEG = (10.0, 240.0)
"""A focal length that gives another horizontal field of view is no lens."""

MAX_K1 = 1.0
"""A radial term as large as this has run away with the focal length: 0.33 makes the equidistant lens rectilinear, and
COLMAP's mapper drops images at 1 (`max_extra_param`)."""

SOLE_FOV_RANGE_DEG = (30.0, 180.0)
"""Of a start that no other agrees with: another field of view has more likely run away than been found."""

UNKNOWN = "lens_unknown"
"""Reason, and code of the flag, of a lens that is not used because the starts do not tell it."""


def focal_from_fov(fov_deg: float, source_width: int) -> float:
    """Focal length in px of an equidistant lens (r = f theta) with this horizontal view of the source frame."""
    return source_width / 2.0 / math.radians(fov_deg / 2.0)


def fov_from_focal(focal_px: float, source_width: int) -> float:
    """The inverse of `focal_from_fov`, in degrees."""
    return 2.0 * math.degrees(source_width / 2.0 / focal_px)


def principal_point(frames: Facts, settings: CameraSettings) -> tuple[float, float]:
    """(cx, cy) in crop pixels from the facts of stage `frames`."""
    x0, y0, x1, y1 = (float(value) for value in frames["crop"])
    if settings.principal_point == "crop":
        return (x1 - x0) / 2.0, (y1 - y0) / 2.0
    return float(frames["source_width"]) / 2.0 - x0, float(frames["source_height"]) / 2.0 - y0


def start_lens(frames: Facts, settings: CameraSettings, fov_deg: float) -> pycolmap.Camera:
    """`pycolmap.Camera` of the estimate's lens model for one start; its focal length counts as a prior."""
    width, height = _size(frames)
    cx, cy = principal_point(frames, settings)
    focal = focal_from_fov(fov_deg, int(frames["source_width"]))
    return pycolmap.Camera(
        camera_id=1,
        model=ESTIMATE_MODEL,
        width=width,
        height=height,
        params=[focal, cx, cy, 0.0],
        has_prior_focal_length=True,
    )


def choose_lens(frames: Facts, settings: CameraSettings, starts: Sequence[Facts]) -> Facts:
    """Content of ``camera.json``, with the starts it was chosen from.

    A given field of view counts before everything else; without usable starts it is COLMAP's default, 1.2 times
    the longer side of the crop. `reason` says why an estimate was asked for and not used.
    """
    width, height = _size(frames)
    source_width = int(frames["source_width"])
    focal, k1, origin, reason = 1.2 * max(width, height), 0.0, "colmap", ""
    chosen: Facts | None = None
    if settings.fov_deg is not None:
        focal, origin = focal_from_fov(settings.fov_deg, source_width), "given"
    elif settings.focal == "estimate":
        chosen = _best_start(starts, source_width)
        if chosen is None:
            reason = UNKNOWN if any(_found_a_model(start) for start in starts) else "no_start_found_a_model"
        elif _ran_away_alone(chosen, starts, source_width):
            chosen, reason = None, UNKNOWN
        else:
            focal, k1, origin = float(chosen["focal_px"]), float(chosen["k1"]), "estimated"
    agreement = _agreement(starts, focal) if chosen is not None else None
    return {
        "model": MODEL,
        "width": width,
        "height": height,
        "params": [focal, focal, *principal_point(frames, settings), k1, 0.0, 0.0, 0.0],
        "focal_from": origin,
        "reason": reason,
        "chosen_start_deg": None if chosen is None else chosen["fov_deg"],
        "agreement": agreement,
        "starts": [dict(start) for start in starts],
        "flags": [] if settings.focal != "estimate" or origin == "given" else _doubts(agreement, reason),
    }


def spans_said(camera: Facts) -> list[float]:
    """Focal lengths in px that the chosen start found, one for each of its spans that mapped; none without a choice."""
    chosen = [start for start in camera["starts"] if start["fov_deg"] == camera["chosen_start_deg"]]
    return [
        float(span["focal_px"])
        for start in chosen
        for span in start.get("spans", ())
        if span["registered_images"] >= MIN_REGISTERED and span["points3D"] >= MIN_POINTS
    ]


def _best_start(starts: Sequence[Facts], source_width: int) -> Facts | None:
    usable = [
        start
        for start in starts
        if _found_a_model(start)
        and abs(start["k1"]) < MAX_K1
        and FOV_RANGE_DEG[0] <= fov_from_focal(float(start["focal_px"]), source_width) <= FOV_RANGE_DEG[1]
    ]
    if not usable:
        return None
    registered = REGISTERED_SLACK * max(start["registered"] for start in usable)
    usable = [start for start in usable if start["registered"] >= registered]
    points = POINTS_SLACK * max(start["points3D"] for start in usable)
    usable = [start for start in usable if start["points3D"] >= points]
    return min(usable, key=lambda start: (start["mean_reprojection_error_px"], start["fov_deg"]))


def _found_a_model(start: Facts) -> bool:
    return bool(start["registered"] >= MIN_REGISTERED and start["points3D"] >= MIN_POINTS)


def _ran_away_alone(chosen: Facts, starts: Sequence[Facts], source_width: int) -> bool:
    """Whether no other start agrees with this one, and what it found is hardly a lens."""
    fov = fov_from_focal(float(chosen["focal_px"]), source_width)
    hardly = not SOLE_FOV_RANGE_DEG[0] <= fov <= SOLE_FOV_RANGE_DEG[1]
    return hardly and len(starts) > 1 and len(_near(starts, float(chosen["focal_px"]))) <= 1


def _doubts(agreement: float | None, reason: str) -> list[FlagFields]:
    """Flags of an estimate; without any usable start nothing agrees."""
    if reason == UNKNOWN:
        return [Flag(UNKNOWN, Severity.WARNING, where="camera").to_dict()]
    share = agreement or 0.0
    if share >= MIN_AGREEMENT:
        return []
    where = "share of the starts that agree on the focal length"
    return [Flag("focal_uncertain", Severity.WARNING, share, MIN_AGREEMENT, where).to_dict()]


def _agreement(starts: Sequence[Facts], focal: float) -> float:
    """Share of all starts that ended near `focal`."""
    return len(_near(starts, focal)) / len(starts)


def _near(starts: Sequence[Facts], focal: float) -> list[Facts]:
    """The starts that ended near `focal`."""
    return [start for start in starts if start["registered"] and abs(start["focal_px"] / focal - 1.0) <= AGREE]


def _size(frames: Facts) -> tuple[int, int]:
    x0, y0, x1, y1 = (int(value) for value in frames["crop"])
    return x1 - x0, y1 - y0
