"""The similarity that puts a model into the true frame, and what the cameras of the model miss then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.geometry.similarity import Similarity

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class PoseErrors:
    """Errors of registered cameras after the alignment."""

    position_mm: F64
    rotation_deg: F64


def align(centers: F64, true_centers: F64) -> Similarity | None:
    """Least-squares similarity from (n, 3) camera centres of a model to the true ones.

    None when it is not determined: fewer than three cameras, or all in one place or on one line.
    """
    if len(centers) < 3:
        return None
    found = pycolmap.estimate_sim3d(centers, true_centers)
    if found is None:
        return None
    return Similarity(float(found.scale), np.asarray(found.rotation.matrix()), np.asarray(found.translation))


def pose_errors(centers: F64, rotations: F64, true_centers: F64, true_rotations: F64, sim3: Similarity) -> PoseErrors:
    """Distances and angles between (n,) aligned and true cameras; rotations are world_from_cam (n, 3, 3)."""
    position = np.linalg.norm(sim3.apply(centers) - true_centers, axis=1)
    difference = np.einsum("nji,njk->nik", true_rotations, sim3.rotation @ rotations)
    return PoseErrors(position, rotation_angles_deg(difference))


def rotation_angles_deg(rotations: F64) -> F64:
    """(n,) angles of (n, 3, 3) rotations; exact near zero, where the trace alone is not."""
    skew = rotations - np.swapaxes(rotations, 1, 2)
    sine = np.sqrt((skew**2).sum(axis=(1, 2)) / 8.0)
    cosine = (np.trace(rotations, axis1=1, axis2=2) - 1.0) / 2.0
    return np.asarray(np.degrees(np.arctan2(sine, cosine)), np.float64)
