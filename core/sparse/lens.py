"""Where the lens model starts: focal length, principal point, and the choice between estimated focal lengths."""

from __future__ import annotations

import math
from collections.abc import Sequence

import pycolmap

from core.flags import Flag, Severity
from core.geometry.lens import PERSPECTIVE, REDUCED, Lens, LensModel, make_lens, scale_to
from core.products.front import CameraProduct, FocalProduct, FocalSource, FramesProduct
from core.settings import Settings
from core.settings.groups import CameraSettings

MIN_REGISTERED, MIN_POINTS = 8, 100
"""Registered images and points below which a start has found nothing."""

REGISTERED_SLACK, POINTS_SLACK = 0.95, 0.9
"""Starts within these shares of the most registered images and points are equals; the smallest error decides."""

AGREE = 0.05
"""Starts that end within this share of the chosen focal length agree with it."""

MIN_AGREEMENT = 0.5
"""Where a smaller share of the starts agrees, the clip does not determine the focal length, unless"""

ALIKE, MIN_ALIKE = 0.01, 2
"""all starts that found a model, so many at least, ended within this share of each other: a start that is far off finds
none, and says nothing of where the others went."""

FOV_RANGE_DEG = (10.0, 240.0)
"""A focal length that gives another horizontal field of view is no lens."""

MAX_K1 = 1.0
"""A radial term as large as this has run away with the focal length: 0.33 makes the equidistant lens rectilinear, and
COLMAP's mapper drops images at 1 (`max_extra_param`)."""

SOLE_FOV_RANGE_DEG = (30.0, 180.0)
"""Of a start that no other agrees with: another field of view has more likely run away than been found."""

UNKNOWN = "lens_unknown"
"""Reason, and code of the flag, of a lens that is not used because the starts do not tell it."""


def focal_from_fov(fov_deg: float, source_width: int, model: str = LensModel.OPENCV_FISHEYE) -> float:
    """Focal length in px of a lens with this horizontal view of the source frame and without distortion.

    That is an equidistant lens (r = f theta), or with a perspective model a pinhole (r = f tan theta).
    """
    half = math.radians(fov_deg / 2.0)
    return source_width / 2.0 / (half if model == LensModel.OPENCV_FISHEYE else math.tan(half))


def fov_from_focal(focal_px: float, source_width: int, model: str = LensModel.OPENCV_FISHEYE) -> float:
    """The inverse of `focal_from_fov`, in degrees."""
    radius = source_width / 2.0 / focal_px
    return 2.0 * math.degrees(radius if model == LensModel.OPENCV_FISHEYE else math.atan(radius))


def of_model(settings: Settings, model: str) -> Settings:
    """The settings of a run with another model of the lens."""
    camera = settings.camera.model_copy(update={"model": model})
    return settings.model_copy(update={"camera": camera})


def estimate_model(model: str) -> str:
    """COLMAP's model of the short spans that the estimate maps: one radial term where the lens has any."""
    reduced = REDUCED[LensModel(model)]
    return reduced[min(1, len(reduced) - 1)]


def principal_point(frames: FramesProduct, settings: CameraSettings) -> tuple[float, float]:
    """(cx, cy) in crop pixels from what stage `frames` chose."""
    x0, y0, x1, y1 = (float(value) for value in frames.crop)
    if settings.principal_point == "crop":
        return (x1 - x0) / 2.0, (y1 - y0) / 2.0
    return float(frames.source_width) / 2.0 - x0, float(frames.source_height) / 2.0 - y0


def start_lens(frames: FramesProduct, settings: CameraSettings, fov_deg: float) -> pycolmap.Camera:
    """`pycolmap.Camera` of the estimate's lens model for one start; its focal length counts as a prior."""
    width, height = _size(frames)
    focal = focal_from_fov(fov_deg, frames.source_width, settings.model)
    model = estimate_model(settings.model)
    return pycolmap.Camera(
        camera_id=1,
        model=model,
        width=width,
        height=height,
        params=Lens(focal, focal, *principal_point(frames, settings)).params(model),
        has_prior_focal_length=True,
    )


def choose_lens(frames: FramesProduct, settings: CameraSettings, starts: Sequence[FocalProduct]) -> CameraProduct:
    """Content of ``camera.json``, with the starts it was chosen from.

    A calibration or a given field of view counts before everything else; without usable starts it is COLMAP's
    default, 1.2 times the longer side of the crop. `reason` says why an estimate was asked for and not used. Where
    starts of a pinhole explain the clip at least as well as those of the settings' model, which has a radial term more,
    the lens is a perspective one; only starts of the chosen kind then speak of its focal length.

    Raises:
        BadInput: the calibration is of a picture of another shape.
    """
    width, height = _size(frames)
    source_width = frames.source_width
    model: str = settings.model
    focal, k1, origin, reason = 1.2 * max(width, height), 0.0, FocalSource.COLMAP, ""
    chosen: FocalProduct | None = None
    others: Sequence[FocalProduct] = ()
    told = _told_lens(frames, settings)
    if told is not None:
        focal, origin = told.focal_px, FocalSource.CALIBRATION
    elif settings.fov_deg is not None:
        focal, origin = focal_from_fov(settings.fov_deg, source_width, model), FocalSource.GIVEN
    elif settings.focal == "estimate":
        starts, others = _of_kind(starts, model), _of_kind(starts, LensModel.PINHOLE)
        chosen = _best_start(starts, source_width, model)
        pinhole = _pinhole(others, source_width, chosen)
        if pinhole is not None:
            chosen, starts, others, model = pinhole, others, starts, str(PERSPECTIVE)
        if chosen is None:
            reason = UNKNOWN if any(_found_a_model(start) for start in starts) else "no_start_found_a_model"
        elif _ran_away_alone(chosen, starts, source_width, model):
            chosen, reason = None, UNKNOWN
        else:
            focal, k1, origin = chosen.focal_px, chosen.k1, FocalSource.ESTIMATED
    agreement = _agreement(starts, focal) if chosen is not None else None
    is_told = origin in (FocalSource.GIVEN, FocalSource.CALIBRATION)
    lens = told or Lens(focal, focal, *principal_point(frames, settings), (k1, 0.0, 0.0, 0.0))
    return CameraProduct(
        model=model,
        width=width,
        height=height,
        params=tuple(lens.params(model)),
        focal_from=origin,
        reason=reason,
        chosen_start_deg=None if chosen is None else chosen.fov_deg,
        agreement=agreement,
        starts=tuple(starts),
        other_starts=tuple(others),
        flags=() if settings.focal != "estimate" or is_told else _warnings(agreement, reason, starts),
    )


def spans_said(camera: CameraProduct) -> list[float]:
    """Focal lengths in px that the chosen start found, one for each of its spans that mapped; none without a choice."""
    chosen = [start for start in camera.starts if start.fov_deg == camera.chosen_start_deg]
    return [focal for start in chosen for focal in _focal_lengths(start)]


def _focal_lengths(start: FocalProduct) -> list[float]:
    """In px, of each span of a start that mapped."""
    return [
        span.focal_px
        for span in start.spans
        if span.registered_images >= MIN_REGISTERED and span.points3D >= MIN_POINTS
    ]


def _told_lens(frames: FramesProduct, settings: CameraSettings) -> Lens | None:
    """The lens of a calibration on the crop, at the size of the video; None without a calibration."""
    if settings.params is None or settings.size_px is None:
        return None
    factor = scale_to(settings.size_px, frames.source_width, frames.source_height)
    x0, y0 = (float(value) for value in frames.crop[:2])
    return make_lens(settings.model, settings.params).scaled(factor).cropped(x0, y0)


def _best_start(starts: Sequence[FocalProduct], source_width: int, model: str) -> FocalProduct | None:
    usable = [
        start
        for start in starts
        if _found_a_model(start)
        and abs(start.k1) < MAX_K1
        and FOV_RANGE_DEG[0] <= fov_from_focal(start.focal_px, source_width, model) <= FOV_RANGE_DEG[1]
    ]
    if not usable:
        return None
    registered = REGISTERED_SLACK * max(start.registered for start in usable)
    usable = [start for start in usable if start.registered >= registered]
    points = POINTS_SLACK * max(start.points3D for start in usable)
    usable = [start for start in usable if start.points3D >= points]
    return min(usable, key=lambda start: (start.mean_reprojection_error_px, start.fov_deg))


def _of_kind(starts: Sequence[FocalProduct], model: str) -> list[FocalProduct]:
    """The starts with this model of the lens."""
    return [start for start in starts if start.model == model]


def _pinhole(starts: Sequence[FocalProduct], source_width: int, fisheye: FocalProduct | None) -> FocalProduct | None:
    """The best start of a pinhole where that is the better explanation; None where it is not.

    It has no radial term, so it explains as much by less where it maps as many images and points with no larger error,
    and all its spans find the same focal length. Where a fisheye explains such a clip too, its radial term and its
    focal length trade, and the latter may be anything.
    """
    best = _best_start(starts, source_width, LensModel.PINHOLE)
    if best is None:
        return None
    focal = [px for start in starts for px in _focal_lengths(start)]
    if not focal or not all(map(_found_a_model, starts)) or max(focal) > (1.0 + AGREE) * min(focal):
        return None
    if fisheye is None:
        return best
    as_much = (
        best.registered >= REGISTERED_SLACK * fisheye.registered
        and best.points3D >= POINTS_SLACK * fisheye.points3D
        and best.mean_reprojection_error_px <= fisheye.mean_reprojection_error_px
    )
    return best if as_much else None


def _found_a_model(start: FocalProduct) -> bool:
    return bool(start.registered >= MIN_REGISTERED and start.points3D >= MIN_POINTS)


def _ran_away_alone(chosen: FocalProduct, starts: Sequence[FocalProduct], source_width: int, model: str) -> bool:
    """Whether no other start agrees with this one, and what it found is hardly a lens."""
    fov = fov_from_focal(chosen.focal_px, source_width, model)
    hardly = not SOLE_FOV_RANGE_DEG[0] <= fov <= SOLE_FOV_RANGE_DEG[1]
    return hardly and len(starts) > 1 and len(_near(starts, chosen.focal_px)) <= 1


def _warnings(agreement: float | None, reason: str, starts: Sequence[FocalProduct]) -> tuple[Flag, ...]:
    """Flags of an estimate; without any usable start nothing agrees."""
    if reason == UNKNOWN:
        return (Flag(UNKNOWN, Severity.WARNING, where="camera"),)
    share = agreement or 0.0
    if share >= MIN_AGREEMENT or (share and _all_alike(starts)):
        return ()
    where = "share of the starts that agree on the focal length"
    return (Flag("focal_uncertain", Severity.WARNING, share, MIN_AGREEMENT, where),)


def _all_alike(starts: Sequence[FocalProduct]) -> bool:
    """Whether every start that found a model found the same focal length."""
    found = [start.focal_px for start in starts if _found_a_model(start)]
    return len(found) >= MIN_ALIKE and max(found) <= (1.0 + ALIKE) * min(found)


def _agreement(starts: Sequence[FocalProduct], focal: float) -> float:
    """Share of all starts that ended near `focal`."""
    return len(_near(starts, focal)) / len(starts)


def _near(starts: Sequence[FocalProduct], focal: float) -> list[FocalProduct]:
    """The starts that ended near `focal`."""
    return [start for start in starts if start.registered and abs(start.focal_px / focal - 1.0) <= AGREE]


def _size(frames: FramesProduct) -> tuple[int, int]:
    x0, y0, x1, y1 = frames.crop
    return x1 - x0, y1 - y0
