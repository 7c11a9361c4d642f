"""The final bundle adjustment: converged, points filtered and completed again until nothing changes.

The bundle adjustments of the search stop early, which is right for a search and not for a result. COLMAP's
global refinement (`IncrementalMapper.iterative_global_refinement`) is followed in its order: complete and
merge tracks, adjust, filter, repeat. It differs in that it always runs to convergence, may let large
residuals count less (Cauchy's loss: mismatches of up to 4 px pass the filters), may align keypoints with each other
(`core.sparse.keypoint_alignment`), may take cameras and lens from the better part of the tracks
(`core.sparse.trimming`), and may free the principal point.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.checks.stats import model_stats
from core.geometry.lens import REDUCED, LensModel
from core.products.adjustment import Adjustment, Alignment, LensDecision, PrincipalPoint, RadialTerms, Trimming
from core.sparse.lens_trial import (
    TRIAL_POINTS,
    judge_principal_point,
    judge_radial_terms,
    try_lens,
)
from core.sparse.points import move_points, observe
from core.sparse.trimming import (
    POINT_LOSS_PX,
    keep_agreeing,
    set_lens,
    solve,
    trim,
)

F64 = NDArray[np.float64]

MAX_ROUNDS = 3
"""Further ones trade the same observations to and fro and hardly move a camera."""
STABLE_CHANGE = 0.002
"""Rounds end when fewer observations than this share were filtered or completed (COLMAP's search: 0.0005)."""

FUNCTION_TOLERANCE = 1e-5
"""On 60 frames of a rendered clip 1e-7 takes half as long again; the median camera error changes by 0.1 micrometre."""
MAX_ITERATIONS = 100

ROBUST_ITERATIONS = 25
"""The robust loss follows squares that converged: what it moves it moves early, and it converges slowly."""

HOPELESS_PX = 50.0
"""Observations farther off than this are dropped before the first adjustment."""

ALIGNMENTS = 2
"""The first finds its warps by a model of keypoints that are not aligned."""

Progress = Callable[[float, str], None]
Align = Callable[[pycolmap.Reconstruction, bool], Alignment]
"""Aligns the keypoints of a model in place; whether observations that do not align are dropped."""


@dataclass(frozen=True)
class Adjusted:
    """A model after its final adjustment."""

    model: pycolmap.Reconstruction
    """`pycolmap.Reconstruction`"""
    adjustment: Adjustment
    """What was done to it."""


def adjust(
    model: pycolmap.Reconstruction,
    cache: pycolmap.DatabaseCache,
    options: pycolmap.IncrementalPipelineOptions,
    *,
    refine_principal_point: bool,
    align: Align | None = None,
    trim_tracks: bool = False,
    judge_radial: bool = False,
    hold_lens: bool = False,
    loss_scale_px: float = 1.0,
    threads: int = 1,
    progress: Progress = lambda share, message: None,
) -> Adjusted:
    """Adjust a copy of `model` to convergence.

    Args:
        model: with the image ids and keypoint indices of `cache`.
        cache: `pycolmap.DatabaseCache` of the same images; its correspondences complete the tracks.
        options: from `core.sparse.mapper.mapper_options`.
        refine_principal_point: free it when it is well determined.
        align: moves keypoints before cameras follow from them; None leaves them.
        trim_tracks: take cameras and lens from the tracks that agree best.
        judge_radial: do without radial terms that these tracks do not ask for.
        hold_lens: refine no parameter of the camera; the two that ask the tracks for the lens are then not asked.
        loss_scale_px: residuals above this count less; 0 counts them all by their squares.
        threads: of Ceres; more than one is nearly but not exactly repeatable.
        progress: called with the share done.
    """
    work = pycolmap.Reconstruction(model)
    before = model_stats(work).mean_reprojection_error_px
    lens = LensModel(next(iter(work.cameras.values())).model_name)
    reduced = REDUCED[lens]
    options_of = partial(adjustment_options, threads=threads, hold_lens=hold_lens)
    schedule = [options_of(False, 0.0)]
    if loss_scale_px > 0:
        # Squares first: they converge in a fifth of the time and leave little to do.
        schedule.append(options_of(False, loss_scale_px))
    # Keypoints that move next need no model that fits them where they are.
    most = MAX_ROUNDS if align is None else len(schedule)
    rounds, stable = _refine(work, cache, options, schedule, most, lambda r: progress(0.5 * r, "bundle adjustment"))
    progress(0.5, "keypoints and tracks")
    # A model without radial terms has one stand-in, for both stages of trimming.
    stages: Sequence[str] = (lens,) if hold_lens else reduced[1:] or reduced
    trimmer = partial(trim, options=partial(options_of, False), hold_lens=hold_lens) if trim_tracks else None
    trimming, alignment = _settle(work, schedule[-1], align, trimmer, stages)
    progress(0.7, "lens")
    point, radial = PrincipalPoint(decision=LensDecision.OFF), _not_judged(len(reduced) - 1)
    if not hold_lens:
        trial_options = options_of(refine_principal_point, loss_scale_px)
        point, radial = _judge_lens(work, trial_options, trimming is not None, judge_radial and len(reduced) > 1)
        radial = replace(radial, number=min(radial.number, len(reduced) - 1))
    stages = stages if hold_lens else (reduced[radial.number],)
    if trimming is not None and (point.refined or reduced[radial.number] != reduced[-1]):
        more = trim(work, partial(options_of, point.refined), stages)
        before_px = more.focal_before_px if radial.number == 0 else trimming.focal_before_px
        trimming = replace(more, rounds=trimming.rounds + more.rounds, focal_before_px=before_px)
    elif point.refined:
        free = options_of(True, loss_scale_px)
        further, stable = _refine(
            work, cache, options, [free], MAX_ROUNDS, lambda r: progress(0.7 + 0.3 * r, "adjustment")
        )
        rounds += further
    if trimming is not None:
        progress(0.9, "points")
        set_lens(work, lens)
        _retrack(work, cache, options, align)
        if radial.number or hold_lens:
            # Radial terms trade against the focal length: the completed tracks say more of both, and of the poses.
            more = trim(work, partial(options_of, False), stages, hold_lens=hold_lens)
            trimming = replace(more, rounds=trimming.rounds + more.rounds, focal_before_px=trimming.focal_before_px)
            set_lens(work, lens)
        _filter(work, cache, options)
    after = model_stats(work).mean_reprojection_error_px
    adjustment = Adjustment(
        rounds=rounds,
        stable=stable,
        error_before_px=before,
        error_after_px=after,
        principal_point=point,
        radial_terms=radial,
        alignment=alignment,
        trimming=trimming,
    )
    return Adjusted(work, adjustment)


def _not_judged(number: int) -> RadialTerms:
    return RadialTerms(decision=LensDecision.OFF, number=number)


def _settle(
    work: pycolmap.Reconstruction,
    options: pycolmap.BundleAdjustmentOptions,
    align: Align | None,
    trimmer: Callable[..., Trimming] | None,
    stages: Sequence[str],
) -> tuple[Trimming | None, Alignment | None]:
    """Align keypoints and adjust in turns, in place; what the last choice of tracks and the first alignment did.

    `trimmer` is `trim` of a model and the lenses of its stages, None where all tracks have a say.
    """
    trimming: Trimming | None = None
    alignment: Alignment | None = None
    for turn in range(ALIGNMENTS if align is not None else 1):
        if align is not None:
            done = align(work, True)
            alignment = alignment or done
        if trimmer is not None:
            found = trimmer(work, lenses=stages if turn == 0 else stages[-1:])
            trimming = found if trimming is None else replace(found, rounds=trimming.rounds + found.rounds)
        elif align is not None:
            solve(work, options)
    return trimming, alignment


def _judge_lens(
    model: pycolmap.Reconstruction, options: pycolmap.BundleAdjustmentOptions, trimmed: bool, judge_radial: bool
) -> tuple[PrincipalPoint, RadialTerms]:
    """Which parts of the lens to free, by a trial on a copy.

    Args:
        model: with cameras that have converged.
        options: of the trial; the principal point is judged when they free it.
        trimmed: the tracks that agree best are asked, not all.
        judge_radial: judge the radial terms too, which takes trimmed tracks.
    """
    point, radial = PrincipalPoint(decision=LensDecision.OFF), _not_judged(2)
    judge_radial = judge_radial and trimmed
    if options.refine_principal_point or judge_radial:
        said = pycolmap.Reconstruction(model)
        if trimmed:
            keep_agreeing(said, TRIAL_POINTS)
        trial = try_lens(said, options)
        point = judge_principal_point(trial) if options.refine_principal_point else point
        radial = judge_radial_terms(trial) if judge_radial else radial
    return point, radial


def adjustment_options(
    principal_point: bool, loss_scale_px: float, threads: int, hold_lens: bool = False
) -> pycolmap.BundleAdjustmentOptions:
    """`BundleAdjustmentOptions` that run until converged; with `hold_lens` no parameter of the camera is free."""
    options = pycolmap.BundleAdjustmentOptions()
    options.print_summary = False
    options.refine_principal_point = principal_point
    if hold_lens:
        options.refine_focal_length = options.refine_extra_params = False
    if loss_scale_px > 0:
        options.ceres.loss_function_type = pycolmap.LossFunctionType.CAUCHY
        options.ceres.loss_function_scale = loss_scale_px
    solver = options.ceres.solver_options
    solver.max_num_iterations = ROBUST_ITERATIONS if loss_scale_px > 0 else MAX_ITERATIONS
    solver.function_tolerance = FUNCTION_TOLERANCE
    solver.num_threads = threads
    return options


def _refine(
    model: pycolmap.Reconstruction,
    cache: pycolmap.DatabaseCache,
    options: pycolmap.IncrementalPipelineOptions,
    schedule: Sequence[pycolmap.BundleAdjustmentOptions],
    most: int,
    progress: Callable[[float], None],
) -> tuple[int, bool]:
    """Rounds of completing, adjusting and filtering in place; how many, and whether the last changed nothing.

    Each entry of `schedule` adjusts one round; the last goes on until nothing changes, for `most` rounds in all.
    """
    triangulation, mapping = options.get_triangulation(), options.get_mapper()
    mapper = pycolmap.IncrementalMapper(cache)
    mapper.begin_reconstruction(model)
    # A point at infinity stalls the solver; others may be off now because their camera is.
    hopeless = options.get_mapper()
    hopeless.filter_max_reproj_error = HOPELESS_PX
    mapper.filter_points(hopeless)
    # Poses and lens follow from the tracks that cover every image; the other points follow from them.
    mapping.ba_global_ignore_redundant_points3D = True
    rounds, stable = 0, False
    while (rounds < len(schedule) or (rounds < most and not stable)) and model.num_points3D():
        progress(rounds / most)
        changed = mapper.complete_and_merge_tracks(triangulation)
        changed += mapper.retriangulate(triangulation)
        mapper.adjust_global_bundle(mapping, schedule[min(rounds, len(schedule) - 1)])
        changed += mapper.filter_points(mapping)
        stable = changed < STABLE_CHANGE * max(1, model.compute_num_observations())
        rounds += 1
    mapper.end_reconstruction(False)
    return rounds, stable


def _retrack(
    model: pycolmap.Reconstruction,
    cache: pycolmap.DatabaseCache,
    options: pycolmap.IncrementalPipelineOptions,
    align: Align | None,
) -> None:
    """Complete the tracks in place and move their points, with cameras that stay as they are."""
    triangulation, mapping = options.get_triangulation(), options.get_mapper()
    mapper = pycolmap.IncrementalMapper(cache)
    mapper.begin_reconstruction(model)
    mapper.filter_points(mapping)
    mapper.complete_and_merge_tracks(triangulation)
    mapper.retriangulate(triangulation)
    if align is not None:
        align(model, False)
    move_points(model, observe(model), POINT_LOSS_PX)
    mapper.end_reconstruction(False)


def _filter(
    model: pycolmap.Reconstruction, cache: pycolmap.DatabaseCache, options: pycolmap.IncrementalPipelineOptions
) -> None:
    """Drop the observations and points that do not fit, in place."""
    mapper = pycolmap.IncrementalMapper(cache)
    mapper.begin_reconstruction(model)
    mapper.filter_points(options.get_mapper())
    mapper.end_reconstruction(False)
