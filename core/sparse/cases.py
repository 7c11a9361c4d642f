"""One case of the window search: a window of frames in, its best model or the reason why not out."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.settings.groups import MapperSettings
from core.sparse.densify import densify, transfer_poses, triangulate
from core.sparse.initial_pair import rank_initial_pairs
from core.sparse.mapper import (
    ModelStats,
    Progress,
    best_model,
    map_images,
    mapper_options,
    model_stats,
    open_cache,
)
from core.sparse.parallax import MIN_RESIDUAL_PX, rotation_residual_px
from core.sparse.tracks import Tracks, build_tracks, choose_keypoints, thin_cache
from core.sparse.view_graph import Frames, read_frames, within
from core.viewgraph import PairTable, read_table

MIN_MATCHES = 15
"""Inliers below which a pair takes no part; COLMAP's default."""

SHARE_DROP = 0.1
"""A warm case that registers a share of its frames lower by more than this is mapped again from scratch."""

FOCAL_JUMP = 0.03
"""So is one whose focal length moved by a larger share than this,"""

ERROR_RISE = 1.5
"""or whose median reprojection error grew by more than this factor."""


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
    """How a case ended. `model` is None when there is none, then `reason` is a code."""

    frames: int
    models: int
    start_mode: str
    """``scratch``, ``warm``, or ``warm_then_scratch`` when a warm start was tried and was worse."""
    model: Any | None
    stats: ModelStats
    reason: str = ""


def run_case(case: Case, start_model: Any | None = None, progress: Progress | None = None) -> CaseResult:
    """Map the frames [start, end) of a case.

    Args:
        case: see `Case`.
        start_model: model of another case to start from; None maps from scratch.
        progress: see `core.sparse.mapper.Progress`.
    """
    frames = read_frames(case.graph / "database.db", case.start, case.end)
    graph = within(read_table(case.graph / "graph.npz"), case.start, case.end)
    models: list[Any] = []
    mode = "scratch"
    tracks = build_tracks(graph)
    reason = _why_not(graph, frames, tracks, case.settings)
    if not reason:
        full = open_cache(case.graph / "database.db", frames.names, MIN_MATCHES)
        search = _search_cache(case, graph, frames, tracks, full)
        warm = None if start_model is None else _map_warm(case, search, full, start_model, progress)
        if warm is not None and not _is_worse(warm, start_model, len(frames.names)):
            mode, models = "warm", [warm]
        else:
            mode = "scratch" if start_model is None else "warm_then_scratch"
            models = _map_scratch(case, search, full, graph, progress)
            # A wrong model can have more points than a right one, its tracks being broken: only images count here.
            if warm is not None and warm.num_reg_images() > max([m.num_reg_images() for m in models], default=0):
                models = [warm]
    best = best_model(models)
    if best is None:
        return CaseResult(len(frames.names), 0, mode, None, NO_MODEL, reason or "no_initial_pair")
    return CaseResult(len(frames.names), len(models), mode, best, model_stats(best))


NO_MODEL = ModelStats(0, 0, 0.0, 0.0, 0.0)


def _search_cache(case: Case, graph: PairTable, frames: Frames, tracks: Tracks, full: Any) -> Any:
    """The cache that poses are searched on: `full` itself, or one with few keypoints per frame."""
    if case.settings.search_tracks == 0:
        return full
    chosen = choose_keypoints(tracks, frames, case.settings.search_tracks)
    return thin_cache(graph, frames, chosen, MIN_MATCHES)


def _options(case: Case) -> Any:
    tuned = case.settings.bundle_adjustment == "tuned"
    return mapper_options(case.settings, threads=case.threads, seed=case.seed, tuned=tuned)


def _map_scratch(case: Case, search: Any, full: Any, graph: PairTable, progress: Progress | None) -> list[Any]:
    pairs: list[tuple[int, int]] = []
    if case.settings.initial_pair == "graph":
        ranked = rank_initial_pairs(graph, case.settings.init_min_num_inliers)
        pairs = [(a + 1, b + 1) for a, b in ranked]  # image_id = index + 1
    models = map_images(search, _options(case), pairs=pairs, progress=progress)
    if search is full:
        return models
    best = best_model(models)
    # Only the best is worth its points; the others count in the row no more than COLMAP's discarded tries.
    return [] if best is None else [densify(full, best, _options(case))]


def _map_warm(case: Case, search: Any, full: Any, start_model: Any, progress: Progress | None) -> Any | None:
    """Go on from the poses of `start_model` that fall into the window; None when that leads nowhere."""
    model = transfer_poses(search, start_model)
    if model.num_reg_images() < case.settings.min_model_size:
        return None
    if model.num_reg_images() < search.num_images():
        triangulate(search, model, _options(case), adjust=False)
        model = best_model(map_images(search, _options(case), start_model=model, progress=progress))
    return None if model is None else densify(full, model, _options(case))


def _is_worse(model: Any, start_model: Any, n_frames: int) -> bool:
    """Whether a warm model fell clearly behind the one it started from."""
    if 1.0 - model.num_reg_images() / n_frames > SHARE_DROP:
        return True
    focal, before = (next(iter(m.cameras.values())).mean_focal_length() for m in (model, start_model))
    if abs(focal / before - 1.0) > FOCAL_JUMP:
        return True
    errors = [model_stats(m).median_reprojection_error_px for m in (model, start_model)]
    return errors[0] > ERROR_RISE * errors[1]


def _why_not(graph: PairTable, frames: Frames, tracks: Tracks, settings: MapperSettings) -> str:
    """Code of what makes mapping pointless; empty when nothing does."""
    if len(frames.names) < settings.min_model_size:
        return "too_few_frames"
    if not (graph.n_inliers >= settings.init_min_num_inliers).any():
        return "too_few_matches"
    residual = rotation_residual_px(tracks, frames)
    return "no_parallax" if residual is not None and residual < MIN_RESIDUAL_PX else ""
