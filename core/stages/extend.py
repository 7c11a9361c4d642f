"""Stage `extend` (`extend@N` of a further model): the other frames, the last bundle adjustment, the checks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import cv2
import numpy as np
from numpy.typing import NDArray

from core.checks.lens import check_left, check_shift
from core.checks.model import check_model, is_wrong
from core.checks.stats import ModelStats, model_stats
from core.errors import StageFailed
from core.flags import Flag
from core.geometry.lens import Lens, lens_of
from core.io.frames import images_folder, write_registered
from core.io.sparse import read_model, write_model
from core.products.adjustment import Adjustment
from core.products.front import CameraProduct, FramesProduct
from core.products.search import ExtendProduct
from core.scene.case import GRAPHS
from core.sparse.adjust import Adjusted, Align, adjust
from core.sparse.extend import MIN_MATCHES, register_rest
from core.sparse.joining import Attempt, join_rest
from core.sparse.keypoint_alignment import align_keypoints
from core.sparse.lens import spans_said
from core.sparse.mapper import mapper_options, open_cache
from core.sparse.weakly_connected import drop_weak_ends, drop_weak_images
from core.stage import StageTask
from core.video.still import read_still
from core.viewgraph import PairTable, database_of, read_graph

if TYPE_CHECKING:
    import pycolmap


def run(task: StageTask) -> ExtendProduct:
    """Write the final model, the list of its frames and what speaks against it."""
    graph, frames = task.input(*GRAPHS), task.products.of(FramesProduct, "frames")
    n_frames, n_search = frames.n_frames, frames.n_search
    settings = task.settings.model
    model = read_model(task.input("pieces" if task.submodel else "confirm"), task.submodel)
    table = read_graph(graph)

    def is_rejected(candidate: pycolmap.Reconstruction) -> bool:
        return settings.veto and is_wrong(candidate, table, n_frames, n_search)

    if settings.register_rest and not task.submodel:
        grown = register_rest(
            graph,
            model,
            n_frames,
            task.settings.mapper,
            seed=task.settings.seed,
            progress=lambda registered, offered: task.report(0.5 * registered, offered, f"{registered} registered"),
        )
        if not is_rejected(grown) or is_rejected(model):
            model = grown
    attempts: list[Attempt] = []
    if settings.join and not task.submodel:
        model, attempts = join_rest(
            graph,
            model,
            table,
            n_frames,
            task.settings.mapper,
            seed=task.settings.seed,
            is_wrong=is_rejected,
        )
    model, dropped = drop_weak_ends(model, n_search) if settings.drop_loose else (model, [])
    adjustment: Adjustment | None = None
    left: Flag | None = None
    said_px = spans_said(task.products.of(CameraProduct, "reverify", "camera"))
    if settings.final_adjustment:
        adjusted = _adjust(task, model, hold_lens=not task.settings.mapper.refine_lens)
        left = check_left(_lens(adjusted.model).focal_px, said_px)
        if left is not None and check_left(_lens(model).focal_px, said_px) is None:
            # The clip does not determine the lens: focal length and distortion trade, and the tracks that agree best
            # agree on a wrong pair of them. The lens of the search has more to speak for it; the flag stays.
            adjusted = _adjust(task, model, hold_lens=True)
        model, adjustment = adjusted.model, adjusted.adjustment
    if settings.drop_loose:
        # Counted here, after the filters: until then mismatches hold what nothing holds.
        model, weak_images = drop_weak_images(model)
        dropped = sorted(dropped + weak_images)
    write_model(task.out, model)
    write_registered(task.out, [int(image_id) - 1 for image_id in sorted(model.reg_image_ids())])
    # Of a further model nobody asks how much of the video it covers.
    offered = model.num_reg_images() if task.submodel else n_frames
    left = left or check_left(_lens(model).focal_px, said_px)
    stats = model_stats(model)
    checks = _checks(model, stats, adjustment, table, offered, n_search, left)
    return _product(model, stats, adjustment, checks, attempts, dropped)


def _lens(model: pycolmap.Reconstruction) -> Lens:
    return lens_of(next(iter(model.cameras.values())))


def _adjust(task: StageTask, model: pycolmap.Reconstruction, *, hold_lens: bool) -> Adjusted:
    names = {model.image(image_id).name for image_id in model.reg_image_ids()}
    return adjust(
        model,
        open_cache(database_of(task.input(*GRAPHS)), names, MIN_MATCHES),
        mapper_options(task.settings.mapper, threads=1, seed=task.settings.seed, tuned=False),
        refine_principal_point=task.settings.model.refine_principal_point == "auto",
        align=_aligner(task) if task.settings.model.align_keypoints else None,
        trim_tracks=task.settings.model.trim_tracks,
        judge_radial=task.settings.model.radial_terms == "auto",
        hold_lens=hold_lens,
        loss_scale_px=task.settings.model.loss_scale_px,
        threads=task.settings.compute.threads or 1,  # 0 asks for a result that repeats to the last bit
        progress=lambda share, message: task.report(0.5 + 0.5 * share, 1, message),
    )


def _aligner(task: StageTask) -> Align:
    frames = task.input("frames")
    still = read_still(frames)

    def read(name: str) -> NDArray[np.uint8]:
        picture = cv2.imread(str(images_folder(frames) / name), cv2.IMREAD_GRAYSCALE)
        if picture is None:
            raise StageFailed(f"frame {name} cannot be read", where=name)
        return np.asarray(picture, np.uint8)

    return lambda model, drop: align_keypoints(model, read, still, drop=drop, threads=task.threads)


def _checks(
    model: pycolmap.Reconstruction,
    stats: ModelStats,
    adjustment: Adjustment | None,
    table: PairTable,
    n_frames: int,
    n_search: int,
    left: Flag | None,
) -> list[Flag]:
    flags = check_model(model, stats, table, n_frames, n_search)
    if adjustment is not None and adjustment.trimming is not None:
        flags += filter(None, [check_shift(adjustment.trimming.shift)])
    return [*flags, *filter(None, [left])]


def _product(
    model: pycolmap.Reconstruction,
    stats: ModelStats,
    adjustment: Adjustment | None,
    checks: Sequence[Flag],
    attempts: Sequence[Attempt],
    dropped: Sequence[int],
) -> ExtendProduct:
    camera, lens = next(iter(model.cameras.values())), _lens(model)
    return ExtendProduct(
        registered_images=stats.registered_images,
        points3D=stats.points3D,
        mean_reprojection_error_px=stats.mean_reprojection_error_px,
        median_reprojection_error_px=stats.median_reprojection_error_px,
        track_length=stats.mean_track_length,
        lens_model=camera.model_name,
        lens_params=tuple(lens.params(camera.model_name)),
        focal_px=lens.focal_px,
        principal_point_px=(lens.cx, lens.cy),
        principal_point_refined=adjustment is not None and adjustment.principal_point.refined,
        adjustment=adjustment,
        checks=tuple(checks),
        joined=tuple(attempt.to_dict() for attempt in attempts),
        loose_frames=tuple(dropped),
    )
