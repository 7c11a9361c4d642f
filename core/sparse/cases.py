"""One case of the window search: a window of frames in, its best model or the reason why not out."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from core.checks.stats import ModelStats, model_stats
from core.scene.case import CaseReason, ConfirmedModel, StartMode
from core.settings.groups import MapperSettings
from core.sparse.densify import densify, free_distortion, transfer_poses, triangulate
from core.sparse.initial_pair import rank_initial_pairs
from core.sparse.mapper import Progress, best_model, map_images, mapper_options, open_cache
from core.sparse.parallax import MIN_RESIDUAL_PX, rotation_residual_px
from core.sparse.tracks import Tracks, build_tracks, choose_keypoints, thin_cache
from core.sparse.view_graph import Frames, read_frames, within
from core.viewgraph import PairTable, database_of, read_graph

if TYPE_CHECKING:
    import pycolmap

CONFIRM_TRACKS = 1000
"""Keypoints per image that take part when the search takes all; on these COLMAP's own settings are affordable."""

CLEARLY_WEAKER = 0.97
"""The searched model is kept only if the confirmed one has a smaller share of its images or points than this."""


def confirm(case: Case, progress: Progress | None = None) -> pycolmap.Reconstruction | None:
    """Map the window from scratch with COLMAP's bundle adjustment; None when that gives no model."""
    settings = case.settings.model_copy(
        update={
            "bundle_adjustment": "colmap",
            "search_tracks": case.settings.search_tracks or CONFIRM_TRACKS,
        }
    )
    return run_case(replace(case, settings=settings), None, progress).model


def choose(searched: ModelStats, confirmed: ModelStats | None) -> ConfirmedModel:
    """The confirmed model, unless it is clearly weaker than the searched one."""
    if confirmed is None:
        return ConfirmedModel.SEARCHED
    weaker = (
        confirmed.registered_images < CLEARLY_WEAKER * searched.registered_images
        or confirmed.points3D < CLEARLY_WEAKER * searched.points3D
    )
    return ConfirmedModel.SEARCHED if weaker else ConfirmedModel.CONFIRMED


def confirmed_or_searched(
    case: Case,
    searched: pycolmap.Reconstruction,
    progress: Progress | None = None,
    is_wrong: Callable[[pycolmap.Reconstruction], bool] | None = None,
) -> tuple[pycolmap.Reconstruction, ConfirmedModel]:
    """The model to go on with and which one it is; a confirmed model that `is_wrong` rejects is not gone on with."""
    confirmed = confirm(case, progress)
    if confirmed is None or choose(model_stats(searched), model_stats(confirmed)) == ConfirmedModel.SEARCHED:
        return searched, ConfirmedModel.SEARCHED
    if is_wrong is not None and is_wrong(confirmed):
        return searched, ConfirmedModel.SEARCHED
    return confirmed, ConfirmedModel.CONFIRMED


MIN_MATCHES = 15
"""Inliers below which a pair takes no part; COLMAP's default."""

SHARE_DROP = 0.1
"""A warm case that registers a share of its frames lower by more than this is mapped again from scratch."""

FOCAL_JUMP = 0.03
"""A warm case whose focal length moved by a larger share than this is mapped again from scratch."""

ERROR_RISE = 1.5
"""A warm case whose median reprojection error grew by more than this factor is mapped again from scratch."""


@dataclass(frozen=True)
class Case:
    """What a case works on."""

    graph: Path
    """Result folder of stage `graph`: ``database.db`` and ``graph.npz``."""
    start: int
    end: int
    settings: MapperSettings
    seed: int
    threads: int = 1


@dataclass(frozen=True)
class CaseResult:
    """How a case ended. `model` is None when there is none, then `reason` says why."""

    frames: int
    models: int
    start_mode: StartMode
    model: pycolmap.Reconstruction | None
    stats: ModelStats
    reason: CaseReason | None = None


def run_case(
    case: Case, start_model: pycolmap.Reconstruction | None = None, progress: Progress | None = None
) -> CaseResult:
    """Map the frames [start, end) of a case.

    Args:
        case: see `Case`.
        start_model: model of another case to start from; None maps from scratch.
        progress: see `core.sparse.mapper.Progress`.
    """
    frames = read_frames(database_of(case.graph), case.start, case.end)
    table = within(read_graph(case.graph), case.start, case.end)
    tracks = build_tracks(table)
    n_frames = len(frames.names)
    reason = _why_not(table, frames, tracks, case.settings)
    if reason:
        return CaseResult(n_frames, 0, StartMode.SCRATCH, None, NO_MODEL, reason)
    window = _Window(case, frames, table, tracks, progress)
    warm = None if start_model is None else window.map_warm(start_model)
    if warm is not None and start_model is not None and not _is_worse(warm, start_model, n_frames):
        return CaseResult(n_frames, 1, StartMode.WARM, warm, model_stats(warm))
    mode = StartMode.SCRATCH if start_model is None else StartMode.WARM_THEN_SCRATCH
    n_models, best = window.map_scratch()
    # A wrong model can have more points than a right one, its tracks being broken: only images count here.
    if warm is not None and (best is None or warm.num_reg_images() > best.num_reg_images()):
        n_models, best = 1, warm
    if best is None:
        return CaseResult(n_frames, 0, mode, None, NO_MODEL, CaseReason.NO_INITIAL_PAIR)
    return CaseResult(n_frames, n_models, mode, best, model_stats(best))


NO_MODEL = ModelStats(0, 0, 0.0, 0.0, 0.0)


class _Window:
    """The caches of one window: all keypoints, and those that poses are searched on."""

    def __init__(self, case: Case, frames: Frames, table: PairTable, tracks: Tracks, progress: Progress | None) -> None:
        self._settings, self._frames, self._progress = case.settings, frames, progress
        self._table, self._tracks = table, tracks
        tuned = case.settings.bundle_adjustment == "tuned"
        self._options = mapper_options(case.settings, threads=case.threads, seed=case.seed, tuned=tuned)
        self._full = open_cache(database_of(case.graph), frames.names, MIN_MATCHES)
        self._search = self._full
        if case.settings.search_tracks:
            chosen = choose_keypoints(tracks, frames, case.settings.search_tracks)
            self._search = thin_cache(table, frames, chosen, MIN_MATCHES)

    def map_scratch(self) -> tuple[int, pycolmap.Reconstruction | None]:
        """How many models there are, and the best of them with all its points."""
        pairs: list[tuple[int, int]] = []
        if self._settings.initial_pair == "graph":
            ranked = rank_initial_pairs(self._table, self._settings.init_min_num_inliers)
            pairs = [(a + 1, b + 1) for a, b in ranked]  # image_id = index + 1
        models = map_images(self._search, self._options, pairs=pairs, progress=self._progress)
        best = best_model(models)
        return len(models), None if best is None else self._whole(best)

    def map_warm(self, start_model: pycolmap.Reconstruction) -> pycolmap.Reconstruction | None:
        """Go on from the poses of `start_model` that fall into the window; None when that leads nowhere."""
        model = transfer_poses(self._search, start_model)
        if model.num_reg_images() < self._settings.min_model_size:
            return None
        if model.num_reg_images() < self._search.num_images():
            triangulate(self._search, model, self._options)
            grown = map_images(self._search, self._options, start_model=model, progress=self._progress)
            return self._whole(grown[0]) if grown else None
        return densify(self._full, model, self._tracks, self._frames, self._options)

    def _whole(self, model: pycolmap.Reconstruction) -> pycolmap.Reconstruction:
        """A model of the search with everything that was held or left out."""
        if self._settings.refine_lens and not self._settings.refine_distortion:
            model = free_distortion(self._search, model, self._options)
        if self._search is self._full:
            return model
        return densify(self._full, model, self._tracks, self._frames, self._options)


def _is_worse(model: pycolmap.Reconstruction, start_model: pycolmap.Reconstruction, n_frames: int) -> bool:
    """Whether a warm model fell clearly behind the one it started from."""
    if 1.0 - model.num_reg_images() / n_frames > SHARE_DROP:
        return True
    focal, before = (next(iter(m.cameras.values())).mean_focal_length() for m in (model, start_model))
    if abs(focal / before - 1.0) > FOCAL_JUMP:
        return True
    errors = [model_stats(m).median_reprojection_error_px for m in (model, start_model)]
    return errors[0] > ERROR_RISE * errors[1]


def _why_not(table: PairTable, frames: Frames, tracks: Tracks, settings: MapperSettings) -> CaseReason | None:
    """What makes mapping pointless; None when nothing does."""
    if len(frames.names) < settings.min_model_size:
        return CaseReason.TOO_FEW_FRAMES
    if not (table.n_inliers >= settings.init_min_num_inliers).any():
        return CaseReason.TOO_FEW_MATCHES
    residual = rotation_residual_px(tracks, frames)
    return CaseReason.NO_PARALLAX if residual is not None and residual < MIN_RESIDUAL_PX else None
