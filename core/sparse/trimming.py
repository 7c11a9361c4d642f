"""Cameras and lens from the tracks that agree best: least trimmed squares.

Shading edges and highlights move with the lamp at the probe. They match, verify and get into tracks, and what they
ask for is not noise: it all bends the same way. A lens that is free gives way to it, at hardly any cost in
reprojection error, so no loss function that looks at one residual sees them. What remains is that tracks on the
metal can agree with each other to a fraction of a pixel and these cannot: adjust to the better part of the tracks,
look at all of them again, choose anew, until the choice settles. These are the concentration steps of least trimmed
squares (Rousseeuw 1984; Rousseeuw and Van Driessen 2006), with tracks in place of observations. What that part says
of the noise then admits every track that is no noisier than it should be, and these decide: the reweighting step of
Rousseeuw and Leroy (1987), without which most of what good tracks know is thrown away.

The lens has few terms meanwhile, first one and then two: k3, k4 and a second focal length are what gives way most.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.geometry.lens import REDUCED, LensModel, lens_of
from core.products.adjustment import Trimming
from core.sparse.points import Observations, errors_px, move_points, observe

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

MIN_LENGTH = 4
"""Images of a track that has a say, where there are enough: three can agree by chance."""
PER_IMAGE = 150
"""Kept tracks of an image, where it has as many. Fewer hold a camera less, more bring in worse ones: measured."""
MIN_PER_IMAGE = 40
"""An image with fewer tracks in the better part keeps its best ones beyond it."""

TRIMMED_AS = REDUCED[LensModel.OPENCV_FISHEYE][1:]
"""COLMAP's models that stand in for the default lens in the first and in the second stage of trimming."""
MAX_ROUNDS = 12
"""Largest number of rounds of one stage."""
ADMITTED = 2.5
"""A track is admitted at the end when its error is at most this many times the typical one of the better part."""
ADMITTED_PER_IMAGE = 400
"""Largest number of tracks that are admitted for an image, best first. More take longer and move nothing."""
ADMITTED_ROUNDS = 3
"""Number of rounds of adjustment with the admitted tracks, and of each stage when the lens is held."""
SETTLED = 0.001
"""Rounds end when the focal length changed by less than this share."""
POINT_LOSS_PX = 1.0
"""Scale of the loss by which points follow their cameras."""

Options = Callable[[float], pycolmap.BundleAdjustmentOptions]
"""`BundleAdjustmentOptions` for a scale of Cauchy's loss in px; which parameters are free is the caller's."""


def trim(
    model: pycolmap.Reconstruction, options: Options, lenses: Sequence[str] = TRIMMED_AS, *, hold_lens: bool = False
) -> Trimming:
    """Adjust cameras and lens in place to the better part of the tracks; all points then follow from them.

    Args:
        model: `pycolmap.Reconstruction` with one camera, adjusted.
        options: of the adjustments.
        lenses: COLMAP's model of the lens, stage by stage; the camera comes out as the last one.
        hold_lens: leave the lens as it is. The focal length then says nothing of when the choice has settled.
    """
    before = focal = _focal(model)
    rounds, kept, scale = 0, 0, 0.0
    seen = observe(model)
    errors = errors_px(model, seen)
    first = ADMITTED_ROUNDS if hold_lens else MAX_ROUNDS
    stages = [*((name, first, False) for name in lenses[-1 if hold_lens else 0 :]), (lenses[-1], ADMITTED_ROUNDS, True)]
    for name, most, admit in stages:
        if not hold_lens:
            set_lens(model, name)
        for _ in range(most):
            noise = _noise(errors, seen)
            chosen = agreeing(noise, seen)
            kept, scale = len(chosen), float(np.median(noise[chosen])) if len(chosen) else 0.0
            if kept == 0:
                break
            if admit:
                chosen = admitted(noise, seen, ADMITTED * scale)
                kept = len(chosen)
            part = pycolmap.Reconstruction(model)
            seen.keep(part, chosen)
            solve(part, options(scale))
            _take_cameras(model, part)
            errors = move_points(model, seen, POINT_LOSS_PX)
            rounds += 1
            last, focal = focal, _focal(model)
            if not hold_lens and abs(focal / last - 1.0) < SETTLED:
                break
    return Trimming(rounds=rounds, kept=kept, median_error_px=scale, focal_before_px=before, focal_after_px=focal)


def set_lens(model: pycolmap.Reconstruction, name: str) -> None:
    """Give the one camera of a model another of `core.geometry.lens.PARAMETERS` in place."""
    camera = next(iter(model.cameras.values()))
    params = lens_of(camera).params(name)
    camera.model = getattr(pycolmap.CameraModelId, name)
    camera.params = np.array(params)


def keep_agreeing(model: pycolmap.Reconstruction, per_image: int = PER_IMAGE) -> None:
    """Keep of the points of a model, in place, those that agree best and hold its cameras."""
    seen = observe(model)
    seen.keep(model, agreeing(_noise(errors_px(model, seen), seen), seen, per_image))


def agreeing(noise: F64, seen: Observations, per_image: int = PER_IMAGE) -> I64:
    """Rows of the points of the better half that hold the cameras.

    Best first, a point is taken while one of its images has fewer than `per_image`; beyond the better part of all, and
    short ones after all others, while one has fewer than `MIN_PER_IMAGE`: every camera has to be held.

    Args:
        noise: (n,) error of every point in px; those that have none are left out.
        seen: their observations.
        per_image: points of an image that has as many.
    """
    finite = np.isfinite(noise)
    limit = np.median(noise[finite]) if finite.any() else 0.0
    short = seen.lengths < MIN_LENGTH
    wanted = np.where((noise <= limit) & ~short, per_image, MIN_PER_IMAGE)
    order = np.lexsort((noise, short))
    return seen.first(order[finite[order]], wanted)


def admitted(noise: F64, seen: Observations, limit_px: float) -> I64:
    """Rows of the points with an error up to a limit; every camera is held here too. Arguments as of `agreeing`."""
    order = np.argsort(noise, kind="stable")
    wanted = np.where(noise <= limit_px, ADMITTED_PER_IMAGE, MIN_PER_IMAGE)
    return seen.first(order[np.isfinite(noise[order])], wanted)


def _noise(errors: F64, seen: Observations) -> F64:
    """(n,) mean error in px, of which the fit of the point itself has taken a share: more of a shorter track."""
    observed = 2.0 * seen.lengths
    with np.errstate(divide="ignore", invalid="ignore"):
        noise: F64 = errors * np.sqrt(observed / (observed - 3.0))
    return noise


def whole(model: pycolmap.Reconstruction) -> pycolmap.BundleAdjustmentConfig:
    """`BundleAdjustmentConfig` of everything in a model, its gauge held by two cameras."""
    config = pycolmap.BundleAdjustmentConfig()
    for image_id in sorted(model.reg_image_ids()):
        config.add_image(image_id)
    config.fix_gauge(pycolmap.BundleAdjustmentGauge.TWO_CAMS_FROM_WORLD)
    return config


def solve(model: pycolmap.Reconstruction, options: pycolmap.BundleAdjustmentOptions) -> None:
    """Adjust everything in a model in place."""
    pycolmap.create_default_ceres_bundle_adjuster(options, whole(model), model).solve()


def _take_cameras(model: pycolmap.Reconstruction, source: pycolmap.Reconstruction) -> None:
    for camera_id, camera in source.cameras.items():
        model.camera(camera_id).params = camera.params
    for image_id in sorted(source.reg_image_ids()):
        image = source.image(image_id)
        model.frame(model.image(image_id).frame_id).set_cam_from_world(image.camera_id, image.cam_from_world())


def _focal(model: pycolmap.Reconstruction) -> float:
    return float(next(iter(model.cameras.values())).mean_focal_length())
