"""A coloured mesh as a picture: ray casting on the CPU, soft light from the viewer, contours."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import cv2
import numpy as np
import open3d as o3d
from numpy.typing import NDArray

from core.geometry.pose import camera_center
from core.surface.glb import vertex_normals
from core.surface.ply import Mesh
from core.viewpoint import Viewpoint

F32 = NDArray[np.float32]
U8 = NDArray[np.uint8]
Value = TypeVar("Value", bound=np.generic)

BACKGROUND_RGB = (236, 238, 240)
BACK_RGB = (0.46, 0.48, 0.50)
"""Colour of the surface's back, so that a look from behind is seen to be one."""
_AMBIENT, _HEAD, _KEY, _GLOSS = 0.30, 0.48, 0.34, 0.10
_KEY_DIRECTION = (-0.55, -0.70, -0.45)
"""Towards the key light in the viewpoint's axes (right, down, forward): from upper left behind the viewer."""
_OCCLUSION_RAYS = 12
_OCCLUSION_REACH = 0.04
"""Length of ambient occlusion rays / mesh diagonal."""
_BAND_ROWS = 256


@dataclass(frozen=True)
class Picture:
    """A rendered picture with what each pixel shows."""

    rgb: U8
    """(h, w, 3)"""
    defect: NDArray[np.int32]
    """(h, w) defect number, -1 = none."""


@dataclass(frozen=True)
class _Hits:
    """What the rays of a band hit; arrays are (rows, width, ...)."""

    hit: NDArray[np.bool_]
    depth: F32
    normal: F32
    """Towards the viewer, in the world."""
    front: NDArray[np.bool_]
    color: F32
    """[0, 1]"""
    defect: NDArray[np.int32]
    position: F32


class Renderer:
    """Renders one mesh from any number of viewpoints."""

    def __init__(self, mesh: Mesh, threads: int = 1) -> None:
        """Take a mesh with colours (grey without) and, optionally, the vertex property ``defect_id``."""
        self._threads = threads
        self._scene = o3d.t.geometry.RaycastingScene(nthreads=threads)
        self._scene.add_triangles(mesh.vertices.astype(np.float32), mesh.faces.astype(np.uint32))
        self._faces = mesh.faces
        self._normals = vertex_normals(mesh).astype(np.float32)
        colors = np.full((len(mesh.vertices), 3), 180, np.uint8) if mesh.colors is None else mesh.colors
        self._colors = colors.astype(np.float32) / 255.0
        none = np.full(len(mesh.vertices), -1, np.int32)
        self._defect = np.asarray(mesh.extra.get("defect_id", none), dtype=np.int32)
        self._diagonal = mesh.diagonal
        self._exposure = _exposure(self._colors[self._defect < 0])

    def front_share(self, cam_from_world: NDArray[np.float64]) -> float:
        """Share of the surface in the middle of the cameras' views that turns its front to them; 1 for no view.

        Args:
            cam_from_world: (n, 3, 4) poses.
        """
        rays = [np.concatenate([camera_center(pose[:, :3], pose[:, 3]), pose[2, :3]]) for pose in cam_from_world]
        hits = self._cast(np.array(rays, np.float32).reshape(-1, 1, 6))
        return float(hits.front[hits.hit].mean()) if hits.hit.any() else 1.0

    def sketch(self, view: Viewpoint, width: int, height: int) -> tuple[NDArray[np.int32], NDArray[np.bool_]]:
        """Per pixel the defect number (-1 none) and whether the surface is seen from its front."""
        hits = self._cast(view.rays(width, height))
        return hits.defect, hits.front & hits.hit

    def render(self, view: Viewpoint, width: int, height: int, samples: int = 2) -> Picture:
        """Render with `samples` x `samples` rays per pixel.

        Light: ambient with occlusion, a headlight, a key light and a little gloss; silhouettes and creases
        are drawn darker. Colours are brightened together when the mesh is dark; the back is plain grey.
        """
        wide, high = width * samples, height * samples
        rgb = np.empty((high, wide, 3), np.float32)
        depth = np.empty((high, wide), np.float32)
        defect = np.empty((high, wide), np.int32)
        shadow = self._ambient_occlusion(view, max(1, width // 2), max(1, height // 2), (wide, high))
        for low in range(0, high, _BAND_ROWS):
            rows = slice(low, min(low + _BAND_ROWS, high))
            hits = self._cast(view.rays(wide, high, (rows.start, rows.stop)))
            rgb[rows] = self._shade(hits, view, shadow[rows])
            depth[rows] = np.where(hits.hit, hits.depth, np.inf)
            defect[rows] = np.where(hits.front, hits.defect, -1)
        rgb *= _contours(depth, self._diagonal)[..., None]
        small = cv2.resize(rgb, (width, height), interpolation=cv2.INTER_AREA)
        picture = np.rint(np.clip(small, 0, 1) * 255).astype(np.uint8)
        return Picture(picture, defect[samples // 2 :: samples, samples // 2 :: samples])

    def _cast(self, rays: F32) -> _Hits:
        answer = self._scene.cast_rays(o3d.core.Tensor(rays), nthreads=self._threads)
        depth = answer["t_hit"].numpy()
        hit = np.isfinite(depth)
        face = answer["primitive_ids"].numpy()[hit].astype(np.int64)
        u, v = answer["primitive_uvs"].numpy()[hit].T
        share = np.stack([1 - u - v, u, v], axis=1).astype(np.float32)
        corners = self._faces[face]
        normal = _interpolate(self._normals, corners, share)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
        direction = rays[hit][:, 3:]
        facing = (answer["primitive_normals"].numpy()[hit] * direction).sum(axis=1) < 0
        # A smooth normal may lean away where the face itself does not; then it is bent to the viewer's side.
        away = (normal * direction).sum(axis=1)
        normal = np.where((away > 0)[:, None], normal - 2 * away[:, None] * direction, normal)
        nearest = corners[np.arange(len(corners)), share.argmax(axis=1)]
        position = rays[hit][:, :3] + depth[hit][:, None] * direction
        return _Hits(
            hit,
            depth,
            _scatter(hit, normal),
            _scatter(hit, facing),
            _scatter(hit, _interpolate(self._colors, corners, share)),
            _scatter(hit, self._defect[nearest], -1),
            _scatter(hit, position),
        )

    def _shade(self, hits: _Hits, view: Viewpoint, shadow: F32) -> F32:
        axes = np.stack([view.right, view.down, view.forward])
        key = np.asarray(_KEY_DIRECTION) @ axes
        key = (key / np.linalg.norm(key)).astype(np.float32)
        towards = -view.forward.astype(np.float32)
        head = np.clip(hits.normal @ towards, 0, 1)
        lambert = np.clip(hits.normal @ key, 0, 1)
        half = key + towards
        gloss = np.clip(hits.normal @ (half / np.linalg.norm(half)).astype(np.float32), 0, 1) ** 24
        light = _AMBIENT * shadow + (_HEAD * head + _KEY * lambert) * (0.45 + 0.55 * shadow)
        base = np.where(
            hits.front[..., None], np.clip(hits.color * self._exposure, 0, 1), np.asarray(BACK_RGB, np.float32)
        )
        lit = base * light[..., None] * np.float32(1.12) + (_GLOSS * gloss * shadow * hits.front)[..., None]
        background = np.asarray(BACKGROUND_RGB, np.float32) / 255.0
        shaded: F32 = np.where(hits.hit[..., None], lit, background).astype(np.float32)
        return shaded

    def _ambient_occlusion(self, view: Viewpoint, width: int, height: int, size: tuple[int, int]) -> F32:
        """(h, w) of `size`: share of open sky over each point, from rays cast at lower resolution."""
        hits = self._cast(view.rays(width, height))
        normal, position = hits.normal[hits.hit], hits.position[hits.hit]
        open_share = np.zeros(len(normal), np.float32)
        reach = _OCCLUSION_REACH * self._diagonal
        start = position + normal * np.float32(0.02 * reach)
        for direction in _sphere_points(_OCCLUSION_RAYS):
            towards = normal + direction  # a unit normal plus a point of the unit sphere is cosine-distributed
            towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-6)
            rays = o3d.core.Tensor(np.hstack([start, towards]).astype(np.float32))
            free = self._scene.cast_rays(rays, nthreads=self._threads)["t_hit"].numpy()
            open_share += np.clip(free / reach, 0, 1)
        field = np.ones((height, width), np.float32)
        field[hits.hit] = open_share / _OCCLUSION_RAYS
        solid = hits.hit.astype(np.float32)
        weight = np.maximum(cv2.blur(solid, (3, 3)), 1e-6)
        smooth = cv2.blur(field * solid, (3, 3)) / weight
        return np.asarray(cv2.resize(np.where(hits.hit, smooth, 1.0).astype(np.float32), size), np.float32)


def _interpolate(values: F32, corners: NDArray[np.int32], share: F32) -> F32:
    mixed: F32 = np.einsum("nk,nkc->nc", share, values[corners])
    return mixed


def _scatter(hit: NDArray[np.bool_], values: NDArray[Value], fill: float = 0) -> NDArray[Value]:
    """Values of the hit pixels back in the picture."""
    out = np.full(hit.shape + values.shape[1:], fill, dtype=values.dtype)
    out[hit] = values
    return out


def _sphere_points(count: int) -> F32:
    """(count, 3) evenly spread unit vectors (Fibonacci lattice)."""
    k = np.arange(count) + 0.5
    z = 1 - 2 * k / count
    angle = np.pi * (1 + 5**0.5) * k
    ring = np.sqrt(1 - z * z)
    return np.stack([ring * np.cos(angle), ring * np.sin(angle), z], axis=1).astype(np.float32)


def _exposure(colors: F32) -> float:
    """Common factor that brings the bright end of dark colours to a readable level; never darkens."""
    if not len(colors):
        return 1.0
    bright = float(np.percentile(colors.mean(axis=1), 90))
    return float(np.clip(0.72 / max(bright, 1e-3), 1.0, 3.0))


def _contours(depth: F32, diagonal: float) -> F32:
    """(h, w) factor that darkens silhouettes: the farther side of depth jumps, and the rim against nothing."""
    limit = 0.012 * diagonal
    finite = np.where(np.isfinite(depth), depth, np.float32(1e9))
    near = cv2.erode(finite, np.ones((3, 3), np.uint8))
    jump = (finite - near > limit).astype(np.float32)
    jump[~np.isfinite(depth)] *= 0.8
    factor: F32 = 1.0 - 0.45 * cv2.GaussianBlur(jump, (3, 3), 0)
    return factor
