"""A synthetic inspection: a fisheye camera moves along a bumpy wall, keypoints and pairs with known truth."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pycolmap

from core.features.io import FrameFeatures
from core.matched_pair import MUTUAL_NEAREST, MatchedPair
from core.settings import make_settings
from core.sparse.cases import Case, CaseResult, run_case
from core.sparse.tracks import Tracks
from core.sparse.triangulation import add_track_points
from core.sparse.view_graph import Frames
from core.verification import CameraFields, Verifier, camera_from_dict
from core.viewgraph import PairTable, make_table, write_database, write_table

WIDTH, HEIGHT, FOCAL = 640, 480, 320.0
LENS: CameraFields = {
    "model": "OPENCV_FISHEYE",
    "width": WIDTH,
    "height": HEIGHT,
    "params": [FOCAL, FOCAL, WIDTH / 2, HEIGHT / 2, 0.0, 0.0, 0.0, 0.0],
}


@dataclass(frozen=True)
class Scene:
    """Features by frame, the 3D point of every keypoint, and the true camera centres."""

    features: list[FrameFeatures]
    point: list[npt.NDArray[np.int64]]
    centers: npt.NDArray[np.float64]
    lens: CameraFields


def make_scene(
    n_frames: int = 24,
    n_points: int = 900,
    *,
    step: float = 0.12,
    noise_px: float = 0.3,
    drift: float = 0.0,
    lens: CameraFields = LENS,
) -> Scene:
    """Frames that see a bumpy wall from about 2 away; with ``step=0`` the camera only turns.

    Every other point is a highlight: it follows the camera over the wall, the more the farther aside it is.
    """
    rng = np.random.default_rng(5)
    length = max(step * n_frames, 1.0)
    points = rng.uniform([-2.0, -1.6, 1.6], [length + 2.0, 1.6, 2.6], (n_points, 3))
    descriptors = rng.normal(size=(n_points, 32))
    descriptors /= np.linalg.norm(descriptors, axis=1, keepdims=True)
    follow = drift * np.linspace(0.0, 1.0, n_points) * (np.arange(n_points) % 2 > 0)
    features, seen, centers = [], [], []
    for frame in range(n_frames):
        center = np.array([step * frame, 0.15 * np.sin(frame / 4) * (step > 0), 0.2 * np.sin(frame / 6) * (step > 0)])
        aside = (center - points) * [1.0, 1.0, 0.0]
        moved = points + (follow * (aside**2).sum(axis=1))[:, None] * aside
        xy = project((moved - center) @ turn_of(frame).T, lens)
        visible = np.flatnonzero(((xy > 0) & (xy < [WIDTH, HEIGHT])).all(axis=1))
        visible = rng.permutation(visible)
        keypoints = (xy[visible] + rng.normal(0, noise_px, (len(visible), 2))).astype(np.float32)
        features.append(
            FrameFeatures(
                keypoints,
                np.linspace(1.0, 0.1, len(visible), dtype=np.float32),
                (descriptors[visible] + rng.normal(0, 0.01, (len(visible), 32))).astype(np.float16),
            )
        )
        seen.append(visible)
        centers.append(center)
    return Scene(features, seen, np.array(centers), lens)


def project(points: npt.NDArray[np.float64], lens: CameraFields = LENS) -> npt.NDArray[np.float64]:
    """(n, 3) camera points to (n, 2) pixels, by default of an equidistant lens; NaN behind the camera."""
    if lens is not LENS:
        before = points[:, 2] >= 0.1
        pixels = np.full((len(points), 2), np.nan)
        pixels[before] = camera_from_dict(lens).img_from_cam(points[before])
        return pixels
    radius = np.linalg.norm(points[:, :2], axis=1)
    theta = np.arctan2(radius, points[:, 2])
    xy: npt.NDArray[np.float64] = FOCAL * theta[:, None] * points[:, :2] / radius[:, None] + [WIDTH / 2, HEIGHT / 2]
    xy[points[:, 2] < 0.1] = np.nan
    return xy


def view_graph(scene: Scene, window: int = 5) -> PairTable:
    """True matches of neighbouring frames, verified by the real verifier."""
    verifier = Verifier(camera_from_dict(scene.lens), make_settings().verification)
    n = len(scene.features)
    pairs = [(a, b) for a in range(n) for b in range(a + 1, min(a + window, n - 1) + 1)]
    matched = []
    for a, b in pairs:
        _, first, second = np.intersect1d(scene.point[a], scene.point[b], return_indices=True)
        matches = np.stack([first, second], axis=1).astype(np.uint32)
        geometry = verifier.verify(scene.features[a].keypoints, scene.features[b].keypoints, matches)
        matched.append(MatchedPair(MUTUAL_NEAREST, len(matches), geometry))
    return make_table(pairs, matched)


def write_graph(folder: Path, scene: Scene, table: PairTable) -> Path:
    """The result folder of stage `graph`."""
    folder.mkdir(parents=True)
    write_table(folder / "graph.npz", table)
    keypoints = [features.keypoints for features in scene.features]
    write_database(folder / "database.db", camera_from_dict(scene.lens), keypoints, table)
    return folder


def model_of(case: Case) -> pycolmap.Reconstruction:
    """The model of a case that has one."""
    return found_in(run_case(case))


def found_in(result: CaseResult) -> pycolmap.Reconstruction:
    """The model of a result that has one."""
    assert result.model is not None
    return result.model


def true_model(scene: Scene) -> pycolmap.Reconstruction:
    """The true poses, and the points that the rays of at least three keypoints of one true point meet in."""
    camera = camera_from_dict(LENS)
    model = pycolmap.Reconstruction()
    model.add_camera_with_trivial_rig(camera)
    keypoints = tuple(features.keypoints.astype(np.float64) for features in scene.features)
    indices, names = tuple(range(len(keypoints))), tuple(f"{i:04d}.jpg" for i in range(len(keypoints)))
    for i, (xy, center) in enumerate(zip(keypoints, scene.centers, strict=True)):
        R = turn_of(i)
        image = pycolmap.Image(name=names[i], keypoints=xy, camera_id=1, image_id=i + 1)
        model.add_image_with_trivial_frame(image, pycolmap.Rigid3d(np.column_stack([R, -R @ center])))
    point = np.concatenate(scene.point)
    frame = np.repeat(indices, [len(own) for own in scene.point])
    keypoint = np.concatenate([np.arange(len(own)) for own in scene.point])
    order = np.lexsort((frame, point))
    offsets = np.concatenate([[0], np.cumsum(np.unique(point, return_counts=True)[1])])
    add_track_points(model, Tracks(offsets, frame[order], keypoint[order]), Frames(indices, names, keypoints, camera))
    return model


def center_errors(model: pycolmap.Reconstruction, scene: Scene) -> npt.NDArray[np.float64]:
    """Distances of the registered camera centres to the true ones after the best similarity, sorted by image id."""
    ids = sorted(model.reg_image_ids())
    found = np.array([model.image(i).projection_center() for i in ids])
    truth = scene.centers[np.array(ids) - 1]
    a, b = found - found.mean(axis=0), truth - truth.mean(axis=0)
    u, s, vt = np.linalg.svd(b.T @ a)
    flip = np.diag([1.0, 1.0, np.linalg.det(u @ vt)])
    scale = np.trace(np.diag(s) @ flip) / (a**2).sum()
    errors: npt.NDArray[np.float64] = np.linalg.norm(scale * a @ (u @ flip @ vt).T - b, axis=1)
    return errors


def turn_of(frame: int) -> npt.NDArray[np.float64]:
    """(3, 3) cam_from_world of a frame."""
    yaw, pitch = 0.15 * np.sin(frame / 5), 0.01 * frame
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    pitched = np.array([[1, 0, 0], [0, cp, -sp], [0, sp, cp]])
    return np.asarray(pitched @ np.array([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]]), np.float64)
