"""How much a model holds: points, frames, reprojection error."""

from __future__ import annotations

from core.flags import Flag, Severity

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
