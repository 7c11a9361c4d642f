"""Where to look at a surface from, so that its defects show."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, radians, sin, tan

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import in_box

F64 = NDArray[np.float64]

FOV_DEG = 30.0
"""Vertical field of view of pictures."""
MARGIN = 1.06
"""Free space around the surface, as a factor of its size in the picture."""
_YAWS_DEG = (-60.0, -45.0, -30.0, -15.0, 0.0, 15.0, 30.0, 45.0, 60.0)
_PITCHES_DEG = (-30.0, -15.0, 0.0, 15.0, 30.0)
_MIN_SEPARATION_DEG = 45.0
_FRAMING_POINTS = 20_000
_FULLY_SEEN_PIXELS = 12
"""A defect that covers this many pixels of the small trial picture is seen well."""


@dataclass(frozen=True)
class Viewpoint:
    """A pinhole camera in the world; pictures have square pixels and look at the middle."""

    center: F64
    """(3,)"""
    right: F64
    """(3,) unit"""
    down: F64
    """(3,) unit"""
    forward: F64
    """(3,) unit"""
    fov_deg: float = FOV_DEG

    def rays(self, width: int, height: int, rows: tuple[int, int] | None = None) -> NDArray[np.float32]:
        """(rows, width, 6) origin and unit direction through pixel centres, for a band of rows or all."""
        low, high = rows or (0, height)
        half = tan(radians(self.fov_deg) / 2)
        y = ((np.arange(low, high) + 0.5) / height * 2 - 1) * half
        x = ((np.arange(width) + 0.5) / width * 2 - 1) * half * width / height
        direction = self.forward + x[None, :, None] * self.right + y[:, None, None] * self.down
        direction /= np.linalg.norm(direction, axis=2, keepdims=True)
        origin = np.broadcast_to(self.center, direction.shape)
        return np.concatenate([origin, direction], axis=2).astype(np.float32)


def main_axes(cam_from_world: F64) -> tuple[F64, F64]:
    """(forward, down), orthonormal: the mean of the cameras' viewing directions and of their image y axes.

    Args:
        cam_from_world: (n, 3, 4) poses; without any, the world's own z and y are used.
    """
    forward = cam_from_world[:, 2, :3].sum(axis=0) if len(cam_from_world) else np.zeros(3)
    if np.linalg.norm(forward) < 1e-6 * max(1, len(cam_from_world)):
        return np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
    forward = forward / np.linalg.norm(forward)
    down = cam_from_world[:, 1, :3].sum(axis=0)
    down = down - (down @ forward) * forward
    if np.linalg.norm(down) < 1e-6 * len(cam_from_world):
        helper = np.eye(3)[np.abs(forward).argmin()]
        down = helper - (helper @ forward) * forward
    return forward, down / np.linalg.norm(down)


def turned(forward: F64, down: F64, yaw_deg: float, pitch_deg: float) -> tuple[F64, F64]:
    """The axes after the viewer has walked `yaw_deg` about the down axis, then `pitch_deg` upwards."""
    right = np.cross(down, forward)
    yaw, pitch = radians(yaw_deg), radians(pitch_deg)
    ahead = cos(yaw) * forward + sin(yaw) * right
    return cos(pitch) * ahead + sin(pitch) * down, cos(pitch) * down - sin(pitch) * ahead


def framed(points: F64, forward: F64, down: F64, aspect: float, fov_deg: float = FOV_DEG) -> Viewpoint:
    """The nearest viewpoint along `forward` that shows the points, but for one in two hundred on each side.

    Args:
        points: (n, 3) what is to be seen.
        aspect: width / height of the picture.
    """
    right = np.cross(down, forward)
    axes = np.stack([right, down, forward])
    local = points @ axes.T
    low, high = np.percentile(local, [0.5, 99.5], axis=0)
    size = max(float(np.linalg.norm(high - low)), 1e-9)
    local = local[in_box(local, (*low, *high))]
    if not len(local):
        local = (low + high)[None] / 2
    half = np.array([tan(radians(fov_deg) / 2) * aspect, tan(radians(fov_deg) / 2)]) / MARGIN
    eye = (low + high) / 2
    eye[2] = low[2] - size
    for _ in range(4):
        # The rim that limits on each side decides both the distance and, in perspective, the middle.
        for axis in range(2):
            upper = (local[:, axis] - half[axis] * local[:, 2]).max()
            lower = (local[:, axis] + half[axis] * local[:, 2]).min()
            eye[axis] = (upper + lower) / 2
        reach = np.abs(local[:, :2] - eye[:2]) / half
        eye[2] = min(float((local[:, 2] - reach.max(axis=1)).min()), float(low[2]) - 1e-3 * size)
    return Viewpoint(eye @ axes, right, down, forward, fov_deg)


Sketch = Callable[[Viewpoint, int, int], tuple[NDArray[np.int32], NDArray[np.bool_]]]
"""Of a viewpoint, a width and a height in px: the (h, w) numbers of the defects seen, -1 for none, and the (h, w) mask
of surface that is seen from its front."""


def choose_two(picture: Sketch, points: F64, cam_from_world: F64, aspect: float) -> tuple[Viewpoint, Viewpoint]:
    """Two viewpoints at least 45 degrees apart that show most defects, each from the side of the cameras.

    Args:
        picture: gives small pictures of the surface.
        points: (n, 3) what is to be framed.
        cam_from_world: (n, 3, 4) poses of registered images.
    """
    forward, down = main_axes(cam_from_world)
    height = 120
    width = round(height * aspect)
    points = points[:: max(1, len(points) // _FRAMING_POINTS)]
    trials = []
    for pitch in _PITCHES_DEG:
        for yaw in _YAWS_DEG:
            view = framed(points, *turned(forward, down, yaw, pitch), aspect)
            defects, front = picture(view, width, height)
            trials.append((_merit(defects, front, yaw, pitch), view))
    trials.sort(key=lambda trial: -trial[0])
    first = trials[0][1]
    limit = cos(radians(_MIN_SEPARATION_DEG))
    others: Sequence[Viewpoint] = [view for _, view in trials if float(view.forward @ first.forward) <= limit]
    return first, others[0]


def _merit(defects: NDArray[np.int32], front: NDArray[np.bool_], yaw_deg: float, pitch_deg: float) -> float:
    """Defects seen well count most, then the surface seen from its front, then nearness to the cameras' direction."""
    counts = np.bincount(defects[(defects >= 0) & front])
    seen = float(np.minimum(1.0, counts / _FULLY_SEEN_PIXELS).sum())
    return seen + float(front.mean()) - 0.002 * (abs(yaw_deg) + 2 * abs(pitch_deg))
