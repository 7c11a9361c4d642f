"""What the tracks say of the lens: whether its principal point is off the start, whether it has radial terms.

One trial adjusts a copy of the model with these free and takes their covariance. A parameter that the tracks ask for
by no more than their scatter stays where it started, an equidistant lens that looks at the middle of the source frame:
as a free one it would take part of its error from the focal length, and with it from every depth.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.checks.stats import model_stats
from core.products.adjustment import LensDecision, PrincipalPoint, RadialTerms
from core.sparse.points import observe
from core.sparse.trimming import whole

F64 = NDArray[np.float64]

MAX_SIGMA_DEG = 0.4
"""The principal point is well determined when both its posterior sigmas, as angles, are below this."""
MIN_SHIFT_SIGMAS = 3.0
"""A shift within this many sigmas says nothing against the start, which then stays; so does the second radial term."""
MIN_FIRST_SIGMAS = 2.0
"""Of the first radial term, alone: left out where it is there it costs the focal length several percent, kept where it
is not there a few tenths. Rendered equidistant lenses had 0.4 to 1.8, one with k1 = 0.02 had 3.7."""
MAX_SHIFT_SHARE = 0.1
"""A principal point farther from its start than this share of the longer image side is not believed."""
MIN_IMAGES = 10
TRIAL_POINTS = 400
"""Points per image of the trial. All of them need gigabytes for their covariance and say little more: their sigmas
come out larger than they are, so the trial is the stricter for it."""


@dataclass(frozen=True)
class Trial:
    """The free parameters of a camera before and after, with what is known of them."""

    missing: LensDecision | None
    """Why there is no covariance; None when there is one."""
    camera: pycolmap.Camera | None = None
    """`pycolmap.Camera` of the trial."""
    start: F64 | None = None
    """Its parameters before."""
    covariance: F64 | None = None
    """(p, p) of all its parameters, 0 for those that were not free; scaled by the residuals and by the correlation
    within tracks."""
    gained: bool = False
    """Whether the median error fell."""


def try_lens(model: pycolmap.Reconstruction, options: pycolmap.BundleAdjustmentOptions) -> Trial:
    """Adjust a copy of a model with one camera; `options` is from `adjustment_options` and says what is free."""
    if model.num_reg_images() < MIN_IMAGES:
        return Trial(LensDecision.FEW_IMAGES)
    trial = pycolmap.Reconstruction(model)
    keep_covering_points(trial, TRIAL_POINTS)
    before = model_stats(trial).median_reprojection_error_px
    adjuster = pycolmap.create_default_ceres_bundle_adjuster(options, whole(trial), trial)
    adjuster.solve()
    camera = next(iter(trial.cameras.values()))
    start = np.array(next(iter(model.cameras.values())).params)
    covariance = pycolmap.estimate_ba_covariance(pycolmap.BACovarianceOptions(), trial, adjuster)
    block = None if covariance is None else covariance.get_other_params_cov(camera.params)
    if block is None or not np.isfinite(block).all():
        return Trial(LensDecision.NO_COVARIANCE, camera, start)
    stats = model_stats(trial)
    # Ceres takes residuals in px as if their sigma were 1; the median length of a 2D normal is 1.1774 sigma.
    variance = (stats.median_reprojection_error_px / 1.1774) ** 2
    # What is wrong with a keypoint is much the same in all images of its track: a track is one observation, not many.
    # Taken as many, two rendered clips of narrow motion moved the point 15 px off, 18 of these sigmas.
    variance *= max(1.0, model_stats(model).mean_track_length)
    free = np.ones(len(start), bool)
    free[camera.principal_point_idxs()] = options.refine_principal_point
    whole_block = np.zeros((len(start), len(start)))
    whole_block[np.ix_(free, free)] = np.asarray(block) * variance
    return Trial(None, camera, start, whole_block, stats.median_reprojection_error_px < before)


def judge_principal_point(trial: Trial) -> PrincipalPoint:
    """Whether the principal point of a trial is well determined and off its start."""
    if trial.camera is None or trial.start is None:
        return PrincipalPoint(decision=_why_unknown(trial))
    camera, center = trial.camera, trial.camera.principal_point_idxs()
    shift = np.array(camera.params)[center] - trial.start[center]
    if trial.covariance is None:
        return PrincipalPoint(decision=_why_unknown(trial), shift_px=_pair(shift))
    sigma = np.sqrt(np.diag(trial.covariance)[center].clip(min=0))
    decision = LensDecision.KEPT
    if (np.degrees(sigma / camera.mean_focal_length()) > MAX_SIGMA_DEG).any():
        decision = LensDecision.UNCERTAIN
    elif (np.abs(shift) < MIN_SHIFT_SIGMAS * sigma).all():
        decision = LensDecision.INSIGNIFICANT
    elif (np.abs(shift) > MAX_SHIFT_SHARE * max(camera.width, camera.height)).any():
        decision = LensDecision.IMPLAUSIBLE
    elif not trial.gained:
        decision = LensDecision.NO_GAIN
    return PrincipalPoint(decision=decision, sigma_px=_pair(sigma), shift_px=_pair(shift))


def judge_radial_terms(trial: Trial) -> RadialTerms:
    """How many of the one or two radial terms of a trial differ from 0."""
    if trial.covariance is None or trial.camera is None:
        return RadialTerms(decision=_why_unknown(trial), number=2)
    radial = trial.camera.extra_params_idxs()
    covariance = trial.covariance[np.ix_(radial, radial)]
    tiny = np.finfo(float).tiny
    if len(radial) == 1:
        alone = float(abs(np.array(trial.camera.params)[radial][0]) / np.sqrt(max(covariance[0, 0], tiny)))
        found = alone >= MIN_FIRST_SIGMAS
        return RadialTerms(decision=_decision(found), number=int(found), first=alone)
    k1, k2 = np.array(trial.camera.params)[radial]
    second = float(abs(k2) / np.sqrt(max(covariance[1, 1], tiny)))
    # The first given that the second is 0: mean and variance of a normal conditioned on its other variable.
    slope = covariance[0, 1] / max(covariance[1, 1], tiny)
    first = float(abs(k1 - slope * k2) / np.sqrt(max(covariance[0, 0] - slope * covariance[0, 1], tiny)))
    number = 2 if second >= MIN_SHIFT_SIGMAS else 1 if first >= MIN_FIRST_SIGMAS else 0
    return RadialTerms(decision=_decision(number > 0), number=number, first=first, second=second)


def keep_covering_points(model: pycolmap.Reconstruction, per_image: int) -> None:
    """Delete points in place, all but the longest tracks that give every image `per_image` of them (if it has them)."""
    seen = observe(model)
    order = np.argsort(-seen.lengths, kind="stable")
    seen.keep(model, seen.first(order, np.full(len(order), per_image)))


def _decision(found: bool) -> LensDecision:
    return LensDecision.SIGNIFICANT if found else LensDecision.INSIGNIFICANT


def _why_unknown(trial: Trial) -> LensDecision:
    """Why a trial without covariance says nothing."""
    return trial.missing or LensDecision.NO_COVARIANCE


def _pair(values: F64) -> tuple[float, float]:
    return float(values[0]), float(values[1])
