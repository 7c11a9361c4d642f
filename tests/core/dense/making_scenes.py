"""Small rendered scenes with closed-form depth, and the sparse models that belong to them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray

F64 = NDArray[np.float64]

WIDTH, HEIGHT, FOCAL = 160, 120, 150.0


@dataclass(frozen=True)
class Scene:
    """A textured sphere (radius, centre) in front of a textured wall z = `wall`, seen by posed cameras."""

    wall: float = 6.0
    radius: float = 1.2
    center: tuple[float, float, float] = (0.0, 0.0, 4.2)

    def hit(self, origin: F64, rays: F64) -> tuple[F64, F64]:
        """Distance along (n, 3) rays and (n, 3) normals towards the viewer."""
        t = (self.wall - origin[2]) / rays[:, 2]
        normals = np.tile([0.0, 0.0, -1.0], (len(rays), 1))
        o = origin - np.array(self.center)
        a, b, c = (rays**2).sum(1), rays @ o, o @ o - self.radius**2
        disc = b * b - a * c
        s = (-b - np.sqrt(np.maximum(disc, 0))) / a
        on = (disc > 0) & (s > 0) & (s < t)
        t = np.where(on, s, t)
        sphere = (origin + rays * t[:, None] - self.center) / self.radius
        return t, np.where(on[:, None], sphere, normals)

    @staticmethod
    def texture(points: F64) -> F64:
        """Grey values of (n, 3) surface points: sums of waves, different along every axis, no period in view."""
        rng = np.random.default_rng(7)
        value = np.zeros(len(points))
        for _ in range(28):
            wave = rng.normal(size=3)
            wave *= rng.uniform(8, 40) / np.linalg.norm(wave)
            value += np.sin(points @ wave + rng.uniform(0, 6.28)) * 7.0
        return value + 120.0


def look(center: F64, target: F64) -> F64:
    """(3, 4) cam_from_world of a camera at `center` looking at `target`."""
    z = (target - center) / np.linalg.norm(target - center)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z])
    return np.column_stack([R, -R @ center])


def camera(fisheye: bool = False) -> pycolmap.Camera:
    if fisheye:
        params = [FOCAL, FOCAL, WIDTH / 2 + 4, HEIGHT / 2 - 3, 0.02, -0.01, 0.0, 0.0]
        return pycolmap.Camera(model="OPENCV_FISHEYE", width=WIDTH, height=HEIGHT, params=params, camera_id=1)
    params = [FOCAL, FOCAL, WIDTH / 2, HEIGHT / 2]
    return pycolmap.Camera(model="PINHOLE", width=WIDTH, height=HEIGHT, params=params, camera_id=1)


def render(scene: Scene, cam: pycolmap.Camera, pose: F64) -> tuple[NDArray[np.uint8], F64, F64]:
    """Colour image, depth along the axis and camera-frame normals; pixel centres at 0.5."""
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH]
    pixels = np.column_stack([u.ravel() + 0.5, v.ravel() + 0.5])
    rays = np.column_stack([np.asarray(cam.cam_from_img(pixels)), np.ones(len(pixels))])
    R, center = pose[:, :3], -pose[:, :3].T @ pose[:, 3]
    t, normals = scene.hit(center, rays @ R)
    grey = scene.texture(center + (rays @ R) * t[:, None]).clip(0, 255).astype(np.uint8)
    image = np.asarray(cv2.cvtColor(grey.reshape(HEIGHT, WIDTH), cv2.COLOR_GRAY2BGR), np.uint8)
    return image, t.reshape(HEIGHT, WIDTH), (normals @ R.T).reshape(HEIGHT, WIDTH, 3)


def poses(count: int) -> list[F64]:
    """Cameras on an arc, three degrees and more apart, looking at the sphere."""
    at = np.linspace(-0.8, 0.8, count)
    return [look(np.array([x, 0.25 * np.sin(3 * x), 0.1 * x]), np.array([0.0, 0.0, 4.5])) for x in at]


def build(folder: Path, count: int = 6, fisheye: bool = True) -> tuple[Scene, pycolmap.Reconstruction]:
    """Write ``extend/model`` and ``frames/images`` of the scene; returns it with its model."""
    scene, cam = Scene(), camera(fisheye)
    model = pycolmap.Reconstruction()
    model.add_camera_with_trivial_rig(cam)
    (folder / "frames" / "images").mkdir(parents=True)
    (folder / "extend" / "model").mkdir(parents=True)
    points = _surface_points(scene)
    tracks: dict[int, list[tuple[int, int]]] = {}
    for index, pose in enumerate(poses(count)):
        image, _, _ = render(scene, cam, pose)
        cv2.imwrite(str(folder / "frames" / "images" / f"{index:04d}.jpg"), image, [cv2.IMWRITE_JPEG_QUALITY, 97])
        ids, pixels = _observe(scene, cam, pose, points)
        for k, point in enumerate(ids):
            tracks.setdefault(int(point), []).append((index + 1, k))
        row = pycolmap.Image(name=f"{index:04d}.jpg", camera_id=1, image_id=index + 1)
        row.points2D = pycolmap.Point2DList([pycolmap.Point2D(p) for p in pixels])
        model.add_image_with_trivial_frame(row, pycolmap.Rigid3d(pose))
    for point, seen in sorted(tracks.items()):
        if len(seen) >= 2:
            track = pycolmap.Track()
            for image_id, k in seen:
                track.add_element(image_id, k)
            model.add_point3D(points[point], track)
    model.write(str(folder / "extend" / "model"))
    return scene, model


def _surface_points(scene: Scene) -> F64:
    """Points of the surface seen from the middle camera."""
    rng = np.random.default_rng(3)
    rays = np.column_stack([rng.uniform(-0.5, 0.5, (400, 1)), rng.uniform(-0.38, 0.38, (400, 1)), np.ones((400, 1))])
    t, _ = scene.hit(np.zeros(3), rays)
    return np.asarray(rays * t[:, None])


def _observe(scene: Scene, cam: pycolmap.Camera, pose: F64, points: F64) -> tuple[NDArray[np.int64], F64]:
    R, center = pose[:, :3], -pose[:, :3].T @ pose[:, 3]
    pixels = np.asarray(cam.img_from_cam(points @ R.T + pose[:, 3]))
    t, _ = scene.hit(center, points - center)
    visible = (t > 0.999) & (pixels > 1).all(axis=1) & (pixels < [WIDTH - 1, HEIGHT - 1]).all(axis=1)
    rows = np.flatnonzero(visible)
    return rows, pixels[rows]
