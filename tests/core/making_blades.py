"""True surfaces of blades and hubs for tests, and cameras that walk along them."""

from __future__ import annotations

import numpy as np
import pycolmap

import bench.scenes.blades as scenes
from bench.scenes.spec import Lens, Scene
from core.scene.views import Views
from core.surface.ply import Mesh

SCENE = Scene("row", 0, Lens(960, 720, 90.0))
PITCH_RAD = scenes.pitch_rad(SCENE)


def blades(count: int, hub: bool = False, skipped: tuple[int, ...] = (), bent: float = 0.0) -> Mesh:
    """Equal blades about the z axis, mm; `bent` pitches more from every blade to the next."""
    parts = []
    for blade in range(count):
        if blade not in skipped:
            points, faces = scenes._blade(SCENE, blade, [])
            parts.append((turned(points, bent * PITCH_RAD * blade * blade), faces))
    if hub:
        parts.append(scenes._ring(SCENE, 2, scenes.HUB_MM + scenes.RING_MM))
    starts = np.cumsum([0, *(len(points) for points, _ in parts[:-1])])
    vertices = np.concatenate([points for points, _ in parts])
    faces = np.concatenate([faces + start for (_, faces), start in zip(parts, starts, strict=True)])
    return Mesh(vertices, faces.astype(np.int32))


def blade_of(vertex: np.ndarray) -> np.ndarray:
    """Index of the blade that vertices of `blades` are of."""
    return vertex // len(scenes._blade(SCENE, 0, [])[0])


def turned(points: np.ndarray, angle_rad: float) -> np.ndarray:
    cos, sin = np.cos(angle_rad), np.sin(angle_rad)
    turned_points: np.ndarray = points @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]).T
    return turned_points


def walk(count: int, turn_pitches: float = 3.0, away: float = 60.0) -> Views:
    """Cameras above the convex sides, going round the axis by so many pitches and wandering on the way."""
    rotations, translations = [], []
    for k in range(count):
        share = k / (count - 1)
        angle = turn_pitches * PITCH_RAD * share
        radius = 176.0 + 6.0 * np.sin(9.0 * share)
        target = np.array([radius * np.cos(angle), radius * np.sin(angle), 0.0])
        way = np.array([0.0, 0.8, -0.6 + 0.2 * np.cos(7.0 * share)])
        centre = target + away * turned(way[None] / np.linalg.norm(way), angle)[0]
        ahead = (target - centre) / np.linalg.norm(target - centre)
        right = np.cross(ahead, target / np.linalg.norm(target))
        right /= np.linalg.norm(right)
        rotation = np.stack([right, np.cross(ahead, right), ahead])
        rotations.append(rotation)
        translations.append(-rotation @ centre)
    camera = pycolmap.Camera(model="PINHOLE", width=960, height=720, params=[480.0, 480.0, 480.0, 360.0])
    return Views(np.arange(count), np.array(rotations), np.array(translations), camera)


def sparse_of(views: Views) -> pycolmap.Reconstruction:
    """A model without points that has these views."""
    model = pycolmap.Reconstruction()
    views.camera.camera_id = 1
    model.add_camera_with_trivial_rig(views.camera)
    for k, image_id in enumerate(views.image_ids):
        image = pycolmap.Image(name=f"{image_id - 1:04d}.jpg", camera_id=1, image_id=image_id)
        pose = pycolmap.Rigid3d(np.hstack([views.R[k], views.t[k][:, None]]))
        model.add_image_with_trivial_frame(image, pose)
    return model
