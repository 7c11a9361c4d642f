"""Counts and errors of a sparse model: what it is compared and judged by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    import pycolmap

FAR_PX = 1e6
"""A point with a larger mean reprojection error lies at or behind infinity and says nothing about the model."""


@dataclass(frozen=True)
class ModelStats:
    """What a sparse model is judged by. Errors are over points with a finite mean error."""

    registered_images: int
    points3D: int  # noqa: N815 (COLMAP's and the contract's name)
    mean_reprojection_error_px: float
    median_reprojection_error_px: float
    mean_track_length: float

    @property
    def score(self) -> tuple[int, int]:
        """The thesis's score S(M) = (registered images, 3D points), compared lexicographically."""
        return self.registered_images, self.points3D


def model_stats(model: pycolmap.Reconstruction) -> ModelStats:
    """Registered images, points and errors of a model; its points' errors are computed anew."""
    model.update_point_3d_errors()
    points = model.points3D.values()
    errors = np.array([point.error for point in points], dtype=np.float64)
    lengths = np.array([point.track.length() for point in points], dtype=np.int64)
    near = np.isfinite(errors) & (errors >= 0) & (errors < FAR_PX)
    if not near.any():
        return ModelStats(int(model.num_reg_images()), 0, 0.0, 0.0, 0.0)
    return ModelStats(
        registered_images=int(model.num_reg_images()),
        points3D=int(near.sum()),
        mean_reprojection_error_px=float(errors[near].mean()),
        median_reprojection_error_px=float(np.median(errors[near])),
        mean_track_length=float(lengths[near].mean()),
    )
