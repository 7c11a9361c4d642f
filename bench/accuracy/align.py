"""One similarity from a model's frame to the true one, and what the cameras miss by then."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Sim3:
    """``x_truth = scale * rotation @ x_model + translation``."""

    scale: float
    rotation: F64
    translation: F64

    def apply(self, points: F64) -> F64:
        """(n, 3) points of the model in the true frame."""
        return self.scale * points @ self.rotation.T + self.translation


def umeyama(model: F64, truth: F64) -> Sim3 | None:
    """Least-squares similarity between (n, 3) point sets (Umeyama 1991, eq. 40-43).

    None when it is not determined: fewer than three points, or all in one place or on one line.
    """
    if len(model) < 3:
        return None
    mean_model, mean_truth = model.mean(axis=0), truth.mean(axis=0)
    a, b = model - mean_model, truth - mean_truth
    spread = np.linalg.svd(a, compute_uv=False)
    if spread[1] <= 1e-9 * max(spread[0], np.finfo(float).tiny):
        return None
    u, d, vt = np.linalg.svd(b.T @ a / len(model))
    sign = np.array([1.0, 1.0, np.sign(np.linalg.det(u) * np.linalg.det(vt))])
    rotation = (u * sign) @ vt
    scale = float((d * sign).sum() / (a**2).sum() * len(model))
    return Sim3(scale, rotation, mean_truth - scale * rotation @ mean_model)


@dataclass(frozen=True)
class PoseErrors:
    """Errors of registered cameras after the alignment."""

    position_mm: F64
    rotation_deg: F64


def pose_errors(centers: F64, rotations: F64, true_centers: F64, true_rotations: F64, sim3: Sim3) -> PoseErrors:
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
