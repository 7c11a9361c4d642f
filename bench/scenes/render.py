"""Pictures of a scene: rays through the exact lens, lights at the tip, marks on the metal, highlights, noise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
import open3d as o3d
from numpy.typing import NDArray
from scipy.ndimage import map_coordinates

from bench.accuracy.truth import Lens as TrueLens
from bench.scenes.blades import Defect, Row, pitch_rad, vertex_normals
from bench.scenes.path import Path
from bench.scenes.spec import Lens, Scene

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
U8 = NDArray[np.uint8]

LIGHTS_MM = np.array([[3.2, -0.5, -1.0], [-2.8, 1.2, -1.0]])
"""In the camera's frame: beside the lens, a little behind it."""
OCTAVES = ((0.55, 0.30), (1.3, 0.26), (3.4, 0.20), (9.0, 0.14))
"""Size in mm and strength of the marks."""
VOLUME = 64
DARK = 0.0001
"""What is left of the light when the lamps are off."""
LEAST_LIGHT = 0.15
"""The exposure follows the picture down to this much light."""
TONE = 1.8
"""A pixel is light to the power of one over this, as cameras write it."""
BEHIND = 0.012
"""What is seen between the blades: hardly any light comes back from there."""


def true_lens(lens: Lens) -> TrueLens:
    """The lens of a scene in the form of the truth files."""
    half, theta = lens.width / 2, np.radians(lens.fov_deg) / 2
    return TrueLens(lens.width, lens.height, half / (theta * (1.0 - lens.bend)), theta * lens.bend / half**3)


@dataclass(frozen=True)
class Frame:
    """One picture and what it shows."""

    rgb: U8
    """(h, w, 3)"""
    point: F64
    """(h, w, 3) the surface in the rotor's frame, mm; NaN where nothing of the row is seen."""
    defect: I32
    """(h, w) number of the defect seen; -1 none."""


class Painter:
    """Renders a scene's frames; the same scene gives the same pixels."""

    def __init__(self, scene: Scene, row: Row, path: Path) -> None:
        self._scene, self._row, self._path = scene, row, path
        self._poses = path.rotor_from_cam()
        self._volume = np.random.default_rng(scene.seed + 2).random((VOLUME, VOLUME, VOLUME)).astype(np.float32)
        lens = true_lens(scene.lens)
        y, x = np.mgrid[0 : lens.height, 0 : lens.width] + 0.5
        self._rays = lens.rays(x.ravel(), y.ravel())
        self._blades = _caster(row.vertices, row.faces)
        self._vanes = _vanes(scene) if scene.casing else None
        self._rng = np.random.default_rng(scene.seed + 3)
        self._text = _overlay(scene.lens) if scene.overlay else None

    def frames(self) -> Any:
        """All frames in order, one at a time."""
        for i in range(self._scene.n_frames):
            yield self._frame(i)

    def sketch(self, i: int) -> tuple[F64, I32]:
        """What a frame shows, without its colours: (h, w, 3) points and (h, w) defects as in `Frame`."""
        pose, vertices, faces = self._poses[i], self._row.vertices, self._row.faces
        towards = self._rays @ pose[:3, :3].T
        hit, point, _ = _hits(self._blades, vertices, faces, self._row.normals, pose[:3, 3], towards)
        if self._vanes is not None:
            still = self._path.world_from_cam[i]
            vanes, faces, normals, caster = self._vanes
            towards = self._rays @ still[:3, :3].T
            before, vane, _ = _hits(caster, vanes, faces, normals, still[:3, 3], towards)
            far = np.linalg.norm(point - pose[:3, 3], axis=1)
            hit &= ~(before & (np.linalg.norm(vane - still[:3, 3], axis=1) < far))
        defect = defects_at(point, hit, self._row.defects, pitch_rad(self._scene))
        shape = (self._scene.lens.height, self._scene.lens.width)
        return np.where(hit[:, None], point, np.nan).reshape(*shape, 3), defect.reshape(shape)

    def _frame(self, i: int) -> Frame:
        lens, scene = self._scene.lens, self._scene
        pose = self._poses[i]
        vertices, caster = self._row.vertices, self._blades
        if scene.soft_mm:
            vertices = _bent(vertices, scene.soft_mm, i)
            caster = _caster(vertices, self._row.faces)
        towards = self._rays @ pose[:3, :3].T
        hit, point, normal = _hits(caster, vertices, self._row.faces, self._row.normals, pose[:3, 3], towards)
        distance = np.where(hit, np.linalg.norm(point - pose[:3, 3], axis=1), np.inf)
        defect = defects_at(point, hit, self._row.defects, pitch_rad(scene))
        albedo = self._albedo(point, defect)
        shade = np.where(hit[:, None], _shade(point, normal, pose, albedo, scene.glare), BEHIND)
        if self._vanes is not None:
            shade, hidden = self._with_vanes(i, shade, distance)
            hit, defect = hit & ~hidden, np.where(hidden, -1, defect)
        if scene.dark is not None and scene.dark.start <= i < scene.dark.end:
            shade *= DARK
        image = shade.reshape(lens.height, lens.width, 3)
        rgb = self._exposed(image)
        point = np.where(hit[:, None], point, np.nan).reshape(lens.height, lens.width, 3)
        return Frame(rgb, point, defect.reshape(lens.height, lens.width).astype(np.int32))

    def _albedo(self, point: F64, defect: I32) -> F64:
        """(n, 3) colour of the metal: marks fixed to it, and what defects do to it."""
        marks: F64 = np.zeros(len(point))
        for size, strength in OCTAVES:
            at = np.nan_to_num(point) / size
            marks += strength * (map_coordinates(self._volume, at.T, order=1, mode="grid-wrap") - 0.5)
        grey = 0.48 * np.exp(self._scene.texture * 1.7 * marks)
        color: F64 = grey[:, None] * np.array([1.0, 0.97, 0.92])
        kinds = {one.number: one.kind for one in self._row.defects}
        for number, kind in kinds.items():
            at = defect == number
            if kind == "burn":
                color[at] *= np.array([0.45, 0.33, 0.26])
            elif kind == "coating_loss":
                color[at] = 0.62 * color[at] + np.array([0.30, 0.27, 0.20])
            elif kind == "crack":
                color[at] *= 0.18
        return color

    def _with_vanes(self, i: int, shade: F64, distance: F64) -> tuple[F64, NDArray[np.bool_]]:
        """Vanes of the casing before the blades, with marks of their own."""
        assert self._vanes is not None
        vertices, faces, normals, caster = self._vanes
        pose = self._path.world_from_cam[i]
        towards = self._rays @ pose[:3, :3].T
        hit, point, normal = _hits(caster, vertices, faces, normals, pose[:3, 3], towards)
        nearer = hit & (np.linalg.norm(point - pose[:3, 3], axis=1) < distance)
        color = self._albedo(point + 500.0, np.full(len(point), -1, np.int32))
        lit = _shade(point, normal, pose, color, self._scene.glare)
        return np.where(nearer[:, None], lit, shade), nearer

    def _exposed(self, image: F64) -> U8:
        """Through the sensor: blur of the optics, exposure, noise, text of the interface."""
        image = np.asarray(cv2.GaussianBlur(image, (0, 0), 0.55), np.float64)
        scale = 0.42 / max(float(np.percentile(image, 75)), LEAST_LIGHT)
        exposed = np.clip(image * scale, 0.0, None)
        toned = exposed / (1.0 + np.maximum(0.0, exposed - 0.8))
        noisy = np.clip(toned, 0.0, 1.0) ** (1 / TONE) + self._rng.normal(scale=self._scene.noise, size=image.shape)
        rgb: U8 = np.clip(255.0 * noisy, 0, 255).astype(np.uint8)
        if self._text is not None:
            rgb = np.where(self._text[..., None] > 0, self._text[..., None], rgb)
        return rgb


def _caster(vertices: F64, faces: I32) -> Any:
    caster: Any = o3d.t.geometry.RaycastingScene()
    caster.add_triangles(vertices.astype(np.float32), faces.astype(np.uint32))
    return caster


def _hits(
    caster: Any, vertices: F64, faces: I32, normals: F64, center: F64, towards: F64
) -> tuple[NDArray[np.bool_], F64, F64]:
    """(n,) hit, (n, 3) points and (n, 3) smooth normals towards the camera."""
    tensor: Any = o3d.core.Tensor
    rays = np.hstack([np.broadcast_to(center, towards.shape), towards]).astype(np.float32)
    answer = caster.cast_rays(tensor(rays), nthreads=1)
    t = answer["t_hit"].numpy().astype(np.float64)
    hit = np.isfinite(t)
    face = np.where(hit, answer["primitive_ids"].numpy(), 0).astype(np.int64)
    uv = answer["primitive_uvs"].numpy().astype(np.float64)
    weight = np.stack([1.0 - uv.sum(axis=1), uv[:, 0], uv[:, 1]], axis=1)
    normal = np.einsum("nk,nki->ni", weight, normals[faces[face]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)
    normal *= -np.sign((normal * towards).sum(axis=1, keepdims=True))
    return hit, center + np.where(hit, t, 0.0)[:, None] * towards, normal


def _shade(point: F64, normal: F64, pose: F64, albedo: F64, glare: float) -> F64:
    """(n, 3) light that comes back: Lambert and Blinn-Phong, falling with the square of the distance."""
    back = pose[:3, 3] - point
    back /= np.maximum(np.linalg.norm(back, axis=1, keepdims=True), 1e-9)
    total = np.zeros_like(albedo)
    for offset in LIGHTS_MM:
        to_light = pose[:3, :3] @ offset + pose[:3, 3] - point
        distance = np.linalg.norm(to_light, axis=1, keepdims=True)
        to_light /= np.maximum(distance, 1e-9)
        half = to_light + back
        half /= np.maximum(np.linalg.norm(half, axis=1, keepdims=True), 1e-9)
        diffuse = np.maximum(0.0, (normal * to_light).sum(axis=1, keepdims=True))
        shine = np.maximum(0.0, (normal * half).sum(axis=1, keepdims=True)) ** 60
        total += (albedo * diffuse + 3.0 * glare * shine) * (40.0 / np.maximum(distance, 1.0)) ** 2
    return total


def defects_at(point: F64, hit: NDArray[np.bool_], defects: tuple[Defect, ...], pitch: float) -> I32:
    """(n,) the defect that each seen point belongs to; -1 = none."""
    found = np.full(len(point), -1, np.int32)
    for one in defects:
        away = point - one.center
        near = hit & ((away**2).sum(axis=1) <= (1.25 * one.radius_mm) ** 2)
        if not near.any():
            continue
        rows = np.flatnonzero(near)
        local = away[rows]
        distance = np.linalg.norm(local, axis=1)
        if one.kind == "crack":
            axis = _crack_axis(one, pitch)
            along = local @ axis
            across = np.linalg.norm(local - along[:, None] * axis, axis=1)
            wave = 0.12 * one.radius_mm * np.sin(5.0 * along / one.radius_mm)
            inside = (np.abs(along) <= one.radius_mm) & (np.abs(across - np.abs(wave)) <= 0.09 * one.radius_mm + 0.05)
        elif one.kind in ("burn", "coating_loss"):
            ragged = 0.82 + 0.18 * np.sin(3.1 * local[:, 0] + one.number) * np.sin(2.7 * local[:, 2] - one.number)
            inside = distance <= one.radius_mm * ragged
        else:
            inside = distance <= one.radius_mm
        found[rows[inside]] = one.number
    return found


def _crack_axis(defect: Defect, pitch: float) -> F64:
    """Mostly along the span, slanting."""
    angle = defect.blade * pitch
    radial = np.array([np.cos(angle), np.sin(angle), 0.0])
    axis: F64 = 0.85 * radial + 0.5 * np.array([0.0, 0.0, 1.0 if defect.number % 2 else -1.0])
    return axis / np.linalg.norm(axis)


def _bent(vertices: F64, amount_mm: float, frame: int) -> F64:
    """A shape that is another one in every frame."""
    phase = 0.9 * frame
    wave = np.sin(0.11 * vertices[:, :1] + phase) + np.sin(0.17 * vertices[:, 1:2] - 1.3 * phase)
    bent: F64 = vertices + amount_mm * wave * np.array([[0.3, 0.5, 0.8]])
    return bent


def _vanes(scene: Scene) -> tuple[F64, I32, F64, Any]:
    """Two plates that stand still in the engine, between the probe and a part of the blades."""
    depth = -0.55 * scene.distance_mm
    plates, faces = [], []
    for k, (low, high) in enumerate(((-16.0, -11.5), (9.0, 15.0))):
        y, x = np.meshgrid(np.linspace(low, high, 12), np.linspace(140.0, 205.0, 50), indexing="ij")
        plates.append(np.stack([x, y - 6.0, depth + 0.25 * (y - low)], axis=-1).reshape(-1, 3))
        index = np.arange(y.size).reshape(y.shape) + k * y.size
        a, b, c, d = index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]
        faces.append(np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]))
    vertices, triangles = np.concatenate(plates), np.concatenate(faces).astype(np.int32)
    return vertices, triangles, vertex_normals(vertices, triangles), _caster(vertices, triangles)


def _overlay(lens: Lens) -> U8:
    """(h, w) text as an inspection system burns it in; 0 = none."""
    picture = np.zeros((lens.height, lens.width), np.uint8)
    size = lens.height / 480
    lines = (("STAGE 2 HPT  ROW B", 0.14), ("PROBE 6.0MM  GAIN 12DB", 0.88), ("REC 00:14", 0.94))
    for line, (text, y) in enumerate(lines):
        at = (int(0.08 * lens.width) + 6 * line, int(y * lens.height))
        cv2.putText(picture, text, at, cv2.FONT_HERSHEY_SIMPLEX, 0.9 * size, 235, max(1, round(2 * size)), cv2.LINE_AA)
    return picture
