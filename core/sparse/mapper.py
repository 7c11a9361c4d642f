"""COLMAP's incremental mapper as plain functions: options, images in, models out, best by score.

A cache (`pycolmap.DatabaseCache`) holds the keypoints and the verified correspondences of the images that
take part; every function below works on exactly its images. With ``threads=1`` and a fixed seed a repeated
call gives bit-identical models (COLMAP issues #3402, #3544).
"""

from __future__ import annotations

import copy
import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import pycolmap

from core.checks.stats import model_stats
from core.settings.groups import MapperSettings
from core.viewgraph import open_database

Progress = Callable[[int, int], None]
"""Called with (registered images, images offered); may raise to stop the mapping."""

WHOLE_SHARE = 0.9
"""A model with at least this share of the images is taken as whole: no other initial pair is tried."""

ENOUGH_SHARE = 0.5
"""Below this share of the images, COLMAP's own search of an initial pair follows the given ones."""

PAIR_ANGLE_DEG = 1.0
"""Least median triangulation angle of a given initial pair, which was ranked by its angle already."""


def open_cache(database: Path, names: Iterable[str] = (), min_num_matches: int = 15) -> pycolmap.DatabaseCache:
    """`DatabaseCache` of the named images (all when empty) and their verified pairs.

    Pairs with fewer than `min_num_matches` inliers are left out (COLMAP's default, 15).
    """
    options = pycolmap.DatabaseCacheOptions()
    options.min_num_matches = min_num_matches
    options.image_names = set(names)
    with open_database(database) as source:
        return pycolmap.DatabaseCache.create(source, options)


def mapper_options(
    settings: MapperSettings, *, threads: int, seed: int, tuned: bool
) -> pycolmap.IncrementalPipelineOptions:
    """`IncrementalPipelineOptions` with the thesis's thresholds.

    `tuned` spends less on bundle adjustment while the model grows: equal output, measured, at about half of the
    cost. Without it everything else is COLMAP's default but for the registration without structure.
    """
    options = pycolmap.IncrementalPipelineOptions()
    options.min_model_size = settings.min_model_size
    options.num_threads = threads
    options.random_seed = seed
    options.extract_colors = False
    # Four free distortion terms fold over while few images hold them: on a lens close to a pinhole 3 of 60 images
    # registered with them free and 60 with them held.
    options.ba_refine_extra_params = settings.refine_distortion and settings.refine_lens
    options.mapper.abs_pose_refine_extra_params = options.ba_refine_extra_params
    options.ba_refine_focal_length = options.mapper.abs_pose_refine_focal_length = settings.refine_lens
    # Ten seconds for every image that it fails on: a dark stretch took minutes per start. What it does register hangs
    # on the model by no point.
    options.structure_less_registration_fallback = False
    options.mapper.init_min_num_inliers = settings.init_min_num_inliers
    options.mapper.abs_pose_min_num_inliers = settings.abs_pose_min_num_inliers
    options.mapper.abs_pose_min_inlier_ratio = settings.abs_pose_min_inlier_ratio
    if tuned:
        options.ba_global_frames_ratio = 1.6
        options.ba_global_points_ratio = 1.6
        options.ba_global_max_refinements = 2
        options.ba_global_max_num_iterations = 25
        options.ba_global_function_tolerance = 1e-5
        options.ba_local_max_refinements = 1
        options.ba_local_max_num_iterations = 15
        options.ba_local_function_tolerance = 1e-5
        # Neighbouring frames of a video rarely reach COLMAP's 16 degrees: its search would try every pair in vain.
        options.mapper.init_min_tri_angle = 6.0
    return options


def map_images(
    cache: pycolmap.DatabaseCache,
    options: pycolmap.IncrementalPipelineOptions,
    *,
    pairs: Sequence[tuple[int, int]] = (),
    search: bool = True,
    start_model: pycolmap.Reconstruction | None = None,
    progress: Progress | None = None,
) -> list[pycolmap.Reconstruction]:
    """All models that the images of `cache` give; empty when none.

    Args:
        cache: from `open_cache`.
        options: from `mapper_options`.
        pairs: image ids of initial pairs tried in turn; a whole model ends the search. When none of them
            gives a model of half of the images, COLMAP's own search follows.
        search: without it no other pairs are searched for.
        start_model: go on from this model instead (set ``options.fix_existing_frames`` to hold its poses).
            Its frames that are not in `cache` are dropped; it is not changed.
        progress: see `Progress`.
    """
    if start_model is not None:
        return _grow(cache, options, restrict_model(start_model, _names(cache)), progress)
    models: list[pycolmap.Reconstruction] = []
    for pair in pairs:
        models += _grow(cache, _from_pair(options, pair), pycolmap.Reconstruction(), progress)
        if _largest(models) >= WHOLE_SHARE * cache.num_images():
            break
    if search and _largest(models) < ENOUGH_SHARE * cache.num_images():
        models += _search(cache, options, progress)
    return models


def best_model(models: Sequence[pycolmap.Reconstruction]) -> pycolmap.Reconstruction | None:
    """The model with the highest score; the first of equals; None when there is none."""
    return max(models, key=lambda model: model_stats(model).score, default=None)


def registered_names(model: pycolmap.Reconstruction) -> list[str]:
    """Names of the registered images, sorted."""
    return sorted(model.image(image_id).name for image_id in model.reg_image_ids())


def restrict_model(model: pycolmap.Reconstruction, names: Iterable[str]) -> pycolmap.Reconstruction:
    """Copy of `model` with only the named images; points keep the observations that remain."""
    keep = set(names)
    part = pycolmap.Reconstruction(model)
    for image_id in list(part.reg_image_ids()):
        image = part.image(image_id)
        if image.name not in keep:
            part.deregister_frame(image.frame_id)
    # Written files hold registered images only: reading them back forgets the others, whose entries the
    # mapper would otherwise look up in the correspondence graph.
    with tempfile.TemporaryDirectory(prefix="model-") as folder:
        part.write_binary(folder)
        return pycolmap.Reconstruction(folder)


def _from_pair(
    options: pycolmap.IncrementalPipelineOptions, pair: tuple[int, int]
) -> pycolmap.IncrementalPipelineOptions:
    """Copy of the options that starts from `pair`, forward motion allowed: its angle was looked at."""
    chosen = copy.deepcopy(options)
    chosen.init_image_id1, chosen.init_image_id2 = pair
    chosen.mapper.init_min_tri_angle = PAIR_ANGLE_DEG
    chosen.mapper.init_max_forward_motion = 1.0
    return chosen


def _grow(
    cache: pycolmap.DatabaseCache,
    options: pycolmap.IncrementalPipelineOptions,
    model: pycolmap.Reconstruction,
    progress: Progress | None,
) -> list[pycolmap.Reconstruction]:
    """Register images into `model` (from the options' initial pair when it is empty) until none is left."""
    pipeline = pycolmap.IncrementalPipeline(options, cache, pycolmap.ReconstructionManager())
    mapper = pycolmap.IncrementalMapper(cache)
    _watch(pipeline, lambda: int(model.num_reg_images()), cache, progress)
    pipeline.reconstruct_sub_model(mapper, options.get_mapper(), model)
    mapper.end_reconstruction(False)
    return [model] if model.num_reg_images() >= options.min_model_size else []


def _search(
    cache: pycolmap.DatabaseCache, options: pycolmap.IncrementalPipelineOptions, progress: Progress | None
) -> list[pycolmap.Reconstruction]:
    """COLMAP's pipeline as it is: its own initial pairs, as many models as the options allow."""
    manager = pycolmap.ReconstructionManager()
    pipeline = pycolmap.IncrementalPipeline(options, cache, manager)
    _watch(pipeline, lambda: _largest([manager.get(i) for i in range(manager.size())]), cache, progress)
    pipeline.run()
    # COLMAP keeps a first model below min_model_size as well: filter by size here.
    models = [manager.get(i) for i in range(manager.size())]
    return [model for model in models if model.num_reg_images() >= options.min_model_size]


def _watch(
    pipeline: pycolmap.IncrementalPipeline,
    count: Callable[[], int],
    cache: pycolmap.DatabaseCache,
    progress: Progress | None,
) -> None:
    if progress is None:
        return
    total = int(cache.num_images())
    event = pycolmap.IncrementalPipelineCallback.NEXT_IMAGE_REG_CALLBACK
    pipeline.add_callback(event.value, lambda: progress(count(), total))


def _largest(models: Sequence[pycolmap.Reconstruction]) -> int:
    return max((int(model.num_reg_images()) for model in models), default=0)


def _names(cache: pycolmap.DatabaseCache) -> list[str]:
    return [image.name for image in cache.images.values()]
