"""All checks of a sparse model, gathered from COLMAP's objects."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.checks.joins import check_joins, tracks_of
from core.checks.lens import check_lens
from core.checks.matches import check_matches, match_agreement
from core.checks.parallax import check_planar, largest_angle_deg, model_parallax
from core.checks.rotations import check_rotations, disagreement, measured_rotations, model_rotations
from core.checks.stats import ModelStats, model_stats
from core.flags import Flag, Severity, worst
from core.geometry.lens import lens_of
from core.viewgraph import PairTable

if TYPE_CHECKING:
    import pycolmap

MIN_POINTS_PER_IMAGE = 20.0
MIN_COVERAGE = 0.5
MAX_MEAN_ERROR_PX = 2.0


def check_points(points3D: int, registered_images: int) -> Flag | None:
    """`few_points` below 20 3D points per registered image."""
    per_image = points3D / max(1, registered_images)
    if per_image >= MIN_POINTS_PER_IMAGE:
        return None
    return Flag("few_points", Severity.WARNING, per_image, MIN_POINTS_PER_IMAGE, f"{registered_images} images")


def check_coverage(registered_images: int, frames: int) -> Flag | None:
    """`coverage_low` when less than half of the frames that took part are registered."""
    share = registered_images / max(1, frames)
    if share >= MIN_COVERAGE:
        return None
    return Flag("coverage_low", Severity.WARNING, share, MIN_COVERAGE, f"{registered_images} of {frames} frames")


def check_reprojection(mean_reprojection_error_px: float) -> Flag | None:
    """`high_reprojection_error` above 2 px on average (the thesis's best model has 1.2 px)."""
    if mean_reprojection_error_px <= MAX_MEAN_ERROR_PX:
        return None
    return Flag("high_reprojection_error", Severity.WARNING, mean_reprojection_error_px, MAX_MEAN_ERROR_PX, "model")


SAMPLED_POINTS = 2000


def check_model(
    model: pycolmap.Reconstruction,
    stats: ModelStats,
    graph: PairTable,
    n_frames: int,
    n_search: int | None = None,
) -> list[Flag]:
    """Flags of a model (`pycolmap.Reconstruction`, image_id = index + 1).

    Args:
        model: to judge.
        stats: of the same model.
        graph: pairs of ``graph.npz``.
        n_frames: frames that took part.
        n_search: frames from this index on are out of order; None = all are in order.
    """
    frames, rotations = model_rotations(model)
    found = disagreement(measured_rotations(graph), frames, rotations)
    camera = next(iter(model.cameras.values()))
    flags = [
        check_rotations(found),
        check_planar(graph.pairs, graph.n_inliers, graph.config, frames),
        check_joins(tracks_of(model), frames, int(frames.max(initial=-1)) + 1 if n_search is None else n_search),
        *check_matches(match_agreement(model, graph)),
        model_parallax(point_angles_deg(model)),
        check_points(stats.points3D, stats.registered_images),
        check_coverage(stats.registered_images, n_frames),
        check_reprojection(stats.mean_reprojection_error_px),
        *check_lens(int(camera.width), int(camera.height), lens_of(camera)),
    ]
    return [flag for flag in flags if flag is not None]


def is_wrong(model: pycolmap.Reconstruction, table: PairTable, n_frames: int, n_search: int | None = None) -> bool:
    """Whether `check_model` rejects a model: the one rule by which a model is not gone on with."""
    return worst(check_model(model, model_stats(model), table, n_frames, n_search)) == Severity.ERROR


def point_angles_deg(model: pycolmap.Reconstruction, count: int = SAMPLED_POINTS) -> NDArray[np.float64]:
    """(n,) largest angle between the views of a point, for at most `count` points spread over the ids."""
    ids = np.array(sorted(model.point3D_ids()))
    if len(ids) > count:
        ids = ids[np.linspace(0, len(ids) - 1, count).round().astype(int)]
    centers = {image_id: model.image(image_id).projection_center() for image_id in model.reg_image_ids()}
    angles = []
    for point_id in ids:
        point = model.point3D(int(point_id))
        views = sorted({element.image_id for element in point.track.elements})
        angles.append(largest_angle_deg(point.xyz, np.array([centers[view] for view in views])))
    return np.array(angles)
