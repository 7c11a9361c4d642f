"""Turns about an axis in space, and rigid motions read as screws."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.geometry.pose import transform

F64 = NDArray[np.float64]


@dataclass(frozen=True)
class Axis:
    """A line in space with a direction."""

    direction: F64
    """(3,) unit."""
    foot: F64
    """(3,) a point of it."""

    @property
    def across(self) -> F64:
        """(2, 3) unit vectors at right angles to the direction and to each other."""
        least = np.eye(3)[int(np.abs(self.direction).argmin())]
        first = np.cross(self.direction, least)
        first = first / np.linalg.norm(first)
        return np.stack([first, np.cross(self.direction, first)])

    def matrix(self, angle_rad: float) -> F64:
        """(3, 3) rotation by an angle about the direction."""
        matrix: F64 = Rotation.from_rotvec(angle_rad * self.direction).as_matrix()
        return matrix

    def turned(self, points: F64, angle_rad: float) -> F64:
        """(n, 3) points turned about the axis."""
        return transform(points - self.foot, self.matrix(angle_rad), self.foot)

    def cylinder(self, points: F64) -> tuple[F64, F64, F64]:
        """Angle in (-pi, pi], radius and height along the axis of (n, 3) points."""
        relative = points - self.foot
        height = relative @ self.direction
        x, y = (relative @ side for side in self.across)
        return np.arctan2(y, x), np.hypot(x, y), height

    def radial(self, points: F64) -> F64:
        """(n, 3) unit directions away from the axis at the points."""
        relative = points - self.foot
        outward = relative - (relative @ self.direction)[:, None] * self.direction
        unit: F64 = outward / np.maximum(np.linalg.norm(outward, axis=1, keepdims=True), 1e-300)
        return unit

    def tangential(self, points: F64) -> F64:
        """(n, 3) unit directions of growing angle at the points."""
        along: F64 = np.cross(self.direction, self.radial(points))
        return along

    def moved(self, steps: F64, length: float) -> Axis:
        """Tilted by the first two steps (rad) and shifted across by the next two, in units of `length`."""
        across = self.across
        tilted = self.direction + steps[:2] @ across
        return Axis(tilted / np.linalg.norm(tilted), self.foot + length * (steps[2:4] @ across))

    def nearest_to(self, point: F64) -> Axis:
        """The same line, with the point of it nearest to (3,) `point` as its foot."""
        return Axis(self.direction, self.foot + ((point - self.foot) @ self.direction) * self.direction)


@dataclass(frozen=True)
class Screw:
    """A rigid motion: a turn about an axis, and a shift along it."""

    axis: Axis
    angle_rad: float
    """Positive."""
    shift: float
    """Along the direction of the axis, scene units."""


def screw_of(rotation: F64, translation: F64) -> Screw | None:
    """The motion ``x -> rotation @ x + translation`` as a screw (Chasles); None for one that hardly turns."""
    vector = Rotation.from_matrix(rotation).as_rotvec()
    angle = float(np.linalg.norm(vector))
    if angle < 1e-6:
        return None
    direction = vector / angle
    shift = float(translation @ direction)
    across = translation - shift * direction
    foot = 0.5 * (across + np.cross(direction, across) / np.tan(angle / 2))
    return Screw(Axis(direction, foot), angle, shift)
