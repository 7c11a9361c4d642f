"""The surface that rays are cast upon: hits, nearest points, lines of sight."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import open3d as o3d
from numpy.typing import NDArray

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]
Flags = NDArray[np.bool_]


MAX_BACKS = 4
"""Backs of faces that a ray goes through on its way to a front."""


@dataclass(frozen=True)
class Hits:
    """What each of n rays meets first."""

    hit: Flags
    """(n,) whether it meets the surface at all."""
    distance: F64
    """(n,) along the ray, scene units; infinite without a hit."""
    cosine: F64
    """(n,) of the angle between the face's normal and the way back; negative = the face is seen from behind."""
    face: I64
    """(n,) -1 without a hit."""


class Surface:
    """A triangle mesh for casting. Deterministic; one thread unless told otherwise."""

    def __init__(self, vertices: F64, faces: NDArray[np.int32], threads: int = 1) -> None:
        self._threads = threads
        self._scene: Any = None
        if len(faces):
            self._scene = o3d.t.geometry.RaycastingScene()
            self._scene.add_triangles(vertices.astype(np.float32), faces.astype(np.uint32))

    @property
    def empty(self) -> bool:
        """Whether there is nothing to hit."""
        return self._scene is None

    def cast(self, origins: F64, directions: F64) -> Hits:
        """First hits of rays from (n, 3) origins along (n, 3) unit directions."""
        n = len(origins)
        if self._scene is None or not n:
            return Hits(np.zeros(n, bool), np.full(n, np.inf), np.zeros(n), np.full(n, -1, np.int64))
        answer = self._scene.cast_rays(_tensor(np.hstack([origins, directions])), nthreads=self._threads)
        distance = answer["t_hit"].numpy().astype(np.float64)
        normal = answer["primitive_normals"].numpy().astype(np.float64)
        hit = np.isfinite(distance)
        face = np.where(hit, answer["primitive_ids"].numpy().astype(np.int64), -1)
        return Hits(hit, distance, -(normal * directions).sum(axis=1), face)

    def cast_front(self, first: Hits, origins: F64, directions: F64, step: float) -> Hits:
        """First hits that see a face from its front, going on through backs.

        No camera sees the back of a solid: a back before a front is a stray sheet. Rays that meet nothing but
        backs keep their first.

        Args:
            first: what `cast` finds for these rays.
            origins: (n, 3)
            directions: (n, 3) unit.
            step: by which a ray goes on behind a back, scene units.
        """
        distance, cosine, face = first.distance.copy(), first.cosine.copy(), first.face.copy()
        behind = np.flatnonzero(first.hit & (first.cosine <= 0))
        gone = first.distance[behind] + step
        for _ in range(MAX_BACKS):
            if not len(behind):
                break
            start = origins[behind] + gone[:, None] * directions[behind]
            further = self.cast(start, directions[behind])
            front = further.hit & (further.cosine > 0)
            rows = behind[front]
            distance[rows], face[rows] = gone[front] + further.distance[front], further.face[front]
            cosine[rows] = further.cosine[front]
            left = further.hit & ~front
            gone = gone[left] + further.distance[left] + step
            behind = behind[left]
        return Hits(first.hit, distance, cosine, face)

    def nearest(self, points: F64) -> tuple[F64, I64]:
        """(n, 3) points of the surface nearest to the given ones, and their faces.

        Raises:
            ValueError: the surface is empty.
        """
        if self._scene is None:
            raise ValueError("an empty surface has no nearest point")
        answer = self._scene.compute_closest_points(_tensor(points), nthreads=self._threads)
        return answer["points"].numpy().astype(np.float64), answer["primitive_ids"].numpy().astype(np.int64)

    def clear(self, centers: F64, points: F64, tolerance: F64 | float) -> Flags:
        """(n,) whether nothing lies between each centre and its point, but for `tolerance` scene units before it."""
        towards = points - centers
        distance = np.linalg.norm(towards, axis=1)
        hits = self.cast(centers, towards / np.maximum(distance, 1e-300)[:, None])
        free: Flags = hits.distance >= distance - tolerance
        return free


def _tensor(values: F64) -> Any:
    tensor: Any = o3d.core.Tensor  # its stubs know no arrays
    return tensor(np.ascontiguousarray(values, dtype=np.float32))
