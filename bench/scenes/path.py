"""Where the probe is, frame by frame, in the frame of the turning rotor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.spatial.transform import Rotation, Slerp

from bench.scenes.blades import HEIGHT_MM, HUB_MM
from bench.scenes.spec import Scene

F64 = NDArray[np.float64]

SLOWNESS = 12
"""Frames over which the hand's motion changes."""


@dataclass(frozen=True)
class Path:
    """Motion of a scene's camera. The engine's frame stands still, the rotor's turns with the blades."""

    rotor_angle: F64
    """(n,) rad by which the rotor has turned."""
    world_from_cam: F64
    """(n, 4, 4) in the engine's frame, mm."""

    def rotor_from_cam(self) -> F64:
        """(n, 4, 4) in the rotor's frame, mm."""
        back = Rotation.from_rotvec(-self.rotor_angle[:, None] * np.array([0.0, 0.0, 1.0])).as_matrix()
        poses = self.world_from_cam.copy()
        poses[:, :3, :3] = back @ poses[:, :3, :3]
        poses[:, :3, 3] = np.einsum("nij,nj->ni", back, poses[:, :3, 3])
        return poses


def make_path(scene: Scene) -> Path:
    """A probe held before the row, unsteadily, looking slantwise at the passing blades."""
    rng = np.random.default_rng(scene.seed + 1)
    n = scene.n_frames
    if scene.still:
        angle, wobble, sweep = np.full(n, 0.12), np.zeros((n, 6)), np.zeros((n, 3))
    else:
        angle, wobble, sweep = _angles(scene, rng), _smooth(rng, n), _sweep(scene, rng)
    radius = HUB_MM + 0.55 * HEIGHT_MM
    base = np.array([radius, -0.35 * scene.distance_mm, -scene.distance_mm])
    target = np.array([radius, 0.12 * scene.distance_mm, 0.0])
    poses = np.tile(np.eye(4), (n, 1, 1))
    for i in range(n):
        center = base + sweep[i] + scene.wobble_mm * wobble[i, :3]
        poses[i, :3, :3] = _looking(target - base) @ Rotation.from_rotvec(0.008 * wobble[i, 3:]).as_matrix()
        poses[i, :3, 3] = center
    return Path(angle, poses)


def resampled(path: Path, n_frames: int) -> Path:
    """The same motion over the same time, told by another number of frames.

    Cubic splines for angle and places, spherical interpolation for directions.
    """
    known = np.arange(len(path.rotor_angle), dtype=np.float64)
    wanted = np.linspace(0.0, known[-1], n_frames)
    poses = np.tile(np.eye(4), (n_frames, 1, 1))
    poses[:, :3, :3] = Slerp(known, Rotation.from_matrix(path.world_from_cam[:, :3, :3]))(wanted).as_matrix()
    poses[:, :3, 3] = CubicSpline(known, path.world_from_cam[:, :3, 3])(wanted)
    return Path(CubicSpline(known, path.rotor_angle)(wanted), poses)


def _sweep(scene: Scene, rng: np.random.Generator) -> F64:
    """(n, 3) the probe moved over the blades on purpose, twice along them and back while it nears them thrice.

    Without it the camera's path is nearly a line, and a similarity fitted to its centres may turn about that line.
    """
    phase = np.linspace(0.0, 2.0 * np.pi, scene.n_frames) + rng.uniform(0.0, 2.0 * np.pi)
    along, near = np.sin(2.0 * phase), 0.5 * np.sin(3.0 * phase)
    found: F64 = scene.sweep_mm * np.stack([along, np.zeros_like(along), near], axis=1)
    return found


def _smooth(rng: np.random.Generator, n: int) -> F64:
    """(n, 6) slow random motion with unit variance."""
    filtered = gaussian_filter1d(rng.normal(size=(n + 8 * SLOWNESS, 6)), SLOWNESS, axis=0)[4 * SLOWNESS :][:n]
    # White noise of unit variance has this variance after a Gaussian filter.
    scaled: F64 = filtered * np.sqrt(2.0 * np.sqrt(np.pi) * SLOWNESS)
    return scaled


def _angles(scene: Scene, rng: np.random.Generator) -> F64:
    """The rotor turned by hand: not evenly, at times not at all, perhaps back, perhaps with a jerk."""
    n = scene.n_frames
    speed = np.clip(1.0 + 0.35 * gaussian_filter1d(rng.normal(size=n), 6.0) / 0.2, 0.3, 2.0)
    if scene.stall is not None:
        speed[scene.stall.start : scene.stall.end] = 0.0
    total = speed.sum()
    if scene.reverse_at is not None:
        speed[scene.reverse_at :] *= -1.0
    step = np.radians(scene.turn_deg) * speed / total
    if scene.jump_at is not None:
        step[scene.jump_at] += np.radians(scene.jump_deg)
    # The blades pass the probe in the order of their numbers.
    turned: F64 = -(np.cumsum(step) - step[0])
    return turned


def _looking(direction: F64) -> F64:
    """(3, 3) world_from_cam, OpenCV axes, image down = towards the hub."""
    z = direction / np.linalg.norm(direction)
    down = np.array([-1.0, 0.0, 0.0])
    y = down - (down @ z) * z
    y /= np.linalg.norm(y)
    return np.stack([np.cross(y, z), y, z], axis=1)
