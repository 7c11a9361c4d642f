"""From the winner's window to all frames: the mapper goes on from the fixed winner."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from core.settings.groups import MapperSettings
from core.sparse.densify import densify, transfer_poses, triangulate
from core.sparse.mapper import Progress, map_images, mapper_options, open_cache
from core.sparse.tracks import build_tracks, choose_keypoints, thin_cache
from core.sparse.view_graph import read_frames
from core.viewgraph import database_of, read_graph

if TYPE_CHECKING:
    import pycolmap

MIN_MATCHES = 15
"""Inliers below which a pair takes no part; COLMAP's default."""

EXTEND_TRACKS = 1000
"""Keypoints per image that take part while frames are registered, when the search takes all."""


def register_rest(
    graph: Path,
    winner: pycolmap.Reconstruction,
    n_frames: int,
    settings: MapperSettings,
    *,
    seed: int,
    threads: int = 1,
    progress: Progress | None = None,
) -> pycolmap.Reconstruction:
    """Model of all frames that can be registered onto `winner`, with every verified track triangulated.

    New frames are found on the longest tracks only, the winner's poses held; then all keypoints take part,
    and frames that the few keypoints could not register get a second try.

    Args:
        graph: result folder of stage `graph`.
        winner: model with image_id = index + 1; not changed.
        n_frames: frames in the database.
        settings: thresholds of the mapper.
        seed: of its random choices.
        threads: of its solvers.
        progress: see `core.sparse.mapper.Progress`.
    """
    frames = read_frames(database_of(graph), 0, n_frames)
    table = read_graph(graph)
    tracks = build_tracks(table)
    chosen = choose_keypoints(tracks, frames, settings.search_tracks or EXTEND_TRACKS)
    thin = thin_cache(table, frames, chosen, MIN_MATCHES)
    model = transfer_poses(thin, winner)
    options = mapper_options(settings, threads=threads, seed=seed, tuned=True)
    triangulate(thin, model, options)
    if model.num_reg_images() < len(frames.names):
        options.fix_existing_frames = True
        model = _grown(model, map_images(thin, options, start_model=model, progress=progress))
        options.fix_existing_frames = False
    full = open_cache(database_of(graph), (), MIN_MATCHES)
    dense = densify(full, model, tracks, frames, options)
    if dense.num_reg_images() < len(frames.names):
        dense = _grown(dense, map_images(full, options, start_model=dense, progress=progress))
    return dense


def _grown(start: pycolmap.Reconstruction, models: Sequence[pycolmap.Reconstruction]) -> pycolmap.Reconstruction:
    """What mapping on from `start` gave, or `start` where it lost images: a weak model can come apart."""
    return max([*models, start], key=lambda model: int(model.num_reg_images()))
