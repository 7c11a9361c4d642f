"""Surfaces fitted onto each other: a rigid motion or a similarity, point to plane."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.geometry.similarity import Similarity
from core.row.overlap import partners
from core.row.sample import SurfaceSample

F64 = NDArray[np.float64]

LEAST_PARTNERS = 30
"""With fewer a fit ends where it is."""
REACH_WIDTHS = 6.0
"""Partners farther apart than so many widths do not count."""
DAMPING = 1e-3
"""Of the sum of the weights: a motion that slides along the surface is not decided by it."""
RIGID = np.eye(7)[:, :6]
"""A rotation and a shift."""
SCALED = np.eye(7)
"""And a scale."""


def fitted_motion(
    sample: SurfaceSample,
    moving: SurfaceSample,
    start: Similarity,
    widths: F64,
    about: F64,
    free: F64 = RIGID,
) -> Similarity:
    """A motion fitted so that one surface lies on another (Chen and Medioni 1992), with Cauchy weights that narrow.

    Args:
        sample: what stays.
        moving: what is moved onto it.
        start: to begin with.
        widths: (k,) of the weights in each of the steps, scene units of `sample`.
        about: (3,) point that every step turns about.
        free: (7, k) what may change: rotation vector, shift (both of the frame of `sample`) and logarithm of the scale.
    """
    scale, rotation, translation = start.scale, start.rotation, start.shift
    for width in widths:
        moved = Similarity(scale, rotation, translation).apply(moving.points)
        found = partners(moved, moving.normals @ rotation.T, sample)
        use = np.flatnonzero(found.fits & (np.abs(found.across) < REACH_WIDTHS * width))
        if len(use) < LEAST_PARTNERS:
            break
        normals, residual = sample.normals[found.rows[use]], found.across[use]
        arms = moved[use] - about
        jacobian = np.hstack([np.cross(arms, normals), normals, (arms * normals).sum(axis=1, keepdims=True)]) @ free
        weight = 1.0 / (1.0 + (residual / width) ** 2)
        size = max(float((arms**2).sum(axis=1).mean()), 1e-300)
        weighted = jacobian * weight[:, None]
        damping = DAMPING * weight.sum() * free.T @ np.diag([size, size, size, 1.0, 1.0, 1.0, size]) @ free
        step = free @ -np.linalg.solve(weighted.T @ jacobian + damping, weighted.T @ residual)
        turn = Rotation.from_rotvec(step[:3]).as_matrix()
        grown = float(np.exp(step[6]))
        scale, rotation = grown * scale, turn @ rotation
        translation = grown * (turn @ (translation - about)) + about + step[3:6]
    return Similarity(scale, rotation, translation)
