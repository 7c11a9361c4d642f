"""The fisheye polynomial of OpenCV and COLMAP (`OPENCV_FISHEYE`): from the angle off the axis to the image and back."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

F64 = NDArray[np.float64]

MAX_THETA = 2 * np.pi
"""A fisheye polynomial is followed up to here: beyond any lens, so that a far too short focal length is no fold."""


def fisheye_radius(theta: F64, distortion: F64) -> F64:
    """``theta (1 + k1 theta^2 + ... + k4 theta^8)``: distance from the principal point over the focal length.

    Args:
        theta: (n,) angles off the axis, rad.
        distortion: (k,) coefficients, from the second power on.
    """
    square = theta**2
    scale = np.ones_like(theta)
    for power, k in enumerate(distortion, start=1):
        scale = scale + k * square**power
    return np.asarray(theta * scale)


def viewing_angle(radius: float, distortion: F64) -> float | None:
    """Angle off the axis (radians) at which the polynomial reaches `radius`; None when it turns back before."""
    theta = np.linspace(0.0, MAX_THETA, 8001)
    r = fisheye_radius(theta, distortion)
    reached = np.flatnonzero(r >= radius)
    folds = np.flatnonzero(np.diff(r) <= 0)
    if not len(reached) or (len(folds) and folds[0] < reached[0]):
        return None
    return float(np.interp(radius, r[: reached[0] + 1], theta[: reached[0] + 1]))


def fisheye_radius_and_slope(theta: float, k1: float, k2: float, k3: float, k4: float) -> tuple[float, float]:
    """`fisheye_radius` of one angle, and its derivative by the angle; for loops that are compiled where they stand.

    It is written in Horner's form, which rounds differently in the last bits than the powers above; both forms stay,
    because the results of either would change otherwise.
    """
    t2 = theta * theta
    radius = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
    slope = 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))
    return radius, slope
