"""How far a place may be off: the pose of its view, the edge of the box, the spacing of the surface."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

BOX_JITTER = 0.06
"""Standard deviation of a box's centre over its side: detectors and people are about this exact."""
MASK_JITTER = 0.02
_MAD = 1.4826


@dataclass(frozen=True)
class PoseCovariance:
    """Covariance of a small motion of the camera in its own frame: rotation (rad), then translation (scene units)."""

    matrix: F64
    """(6, 6)"""


def pose_covariance(in_cam: F64, residuals_px: F64, focal_px: float) -> PoseCovariance | None:
    """Of one image, the structure held: the inverse normal matrix of its observations.

    The lens is taken as equidistant with this focal length for the derivative alone: an image error of e px
    is a direction error of e / focal rad, wherever it lies. The scale of the noise is the robust spread of
    the image's own residuals, so what the model does not explain counts too. Points held at their places
    make this a lower bound.

    Args:
        in_cam: (n, 3) observed points in the camera's frame.
        residuals_px: (n, 2) reprojection errors.
        focal_px: of the lens.

    Returns:
        None with fewer than six points or when they do not fix the pose.
    """
    if len(in_cam) < 6:
        return None
    distance = np.linalg.norm(in_cam, axis=1)
    ray = in_cam / distance[:, None]
    # A motion (w, v) moves the direction of a point X by (I - r r^T)(w x X + v) / |X|.
    cross = np.zeros((len(ray), 3, 3))
    cross[:, 0, 1], cross[:, 0, 2] = in_cam[:, 2], -in_cam[:, 1]
    cross[:, 1, 0], cross[:, 1, 2] = -in_cam[:, 2], in_cam[:, 0]
    cross[:, 2, 0], cross[:, 2, 1] = in_cam[:, 1], -in_cam[:, 0]
    tangent = np.eye(3) - ray[:, :, None] * ray[:, None, :]
    jacobian = np.concatenate([tangent @ cross, tangent], axis=2) / distance[:, None, None]
    normal = np.einsum("nij,nik->jk", jacobian, jacobian)
    noise_px = _MAD * float(np.median(np.abs(residuals_px)))
    if np.linalg.cond(normal) > 1e12:
        return None
    return PoseCovariance(np.linalg.inv(normal) * (noise_px / focal_px) ** 2)


def place_sigma(
    place_in_cam: F64, pose: PoseCovariance | None, side_px: float, outline: str, focal_px: float, spacing: float
) -> float:
    """Standard deviation of a place across the line of sight, scene units.

    Args:
        place_in_cam: (3,)
        pose: of the view; None adds nothing.
        side_px: mean side of the box.
        outline: ``mask`` or ``box``.
        focal_px: of the lens.
        spacing: of the fused cloud.
    """
    distance = float(np.linalg.norm(place_in_cam))
    edge = (MASK_JITTER if outline == "mask" else BOX_JITTER) * side_px / focal_px * distance
    moved = 0.0
    if pose is not None:
        x, y, z = place_in_cam
        shift = np.hstack([np.array([[0, z, -y], [-z, 0, x], [y, -x, 0]]), np.eye(3)])
        moved = float(np.trace(shift @ pose.matrix @ shift.T)) / 2
    return float(np.sqrt(edge**2 + moved + spacing**2))
