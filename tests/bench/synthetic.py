"""A small synthetic truth and the perfect result for it, in another world frame."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2  # noqa: F401  (before pycolmap: the other order aborts when a PNG is written)
import numpy as np
import pycolmap
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from core.surface.ply import Mesh, write_cloud, write_mesh

Row = dict[str, Any]
F64 = NDArray[np.float64]

N_FRAMES = 10
SCALE, ROTATION, SHIFT = 0.02, Rotation.from_euler("xyz", [20, -35, 50], degrees=True), np.array([0.3, -0.1, 0.2])


def to_model(points_m: F64) -> F64:
    """Truth (metres) to the synthetic result's frame; the inverse of x = SCALE R x_model + SHIFT."""
    return ROTATION.inv().apply((points_m - SHIFT) / SCALE)


def plate() -> tuple[F64, NDArray[np.int32]]:
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(-0.03, 0.03, 31), np.linspace(-0.03, 0.03, 31)))
    vertices = np.stack([x, y, 0.002 * np.sin(150 * x) * np.cos(120 * y)], axis=1)
    corner = (np.arange(30)[:, None] * 31 + np.arange(30)).ravel()
    faces = np.concatenate(
        [np.stack([corner, corner + 1, corner + 31], 1), np.stack([corner + 1, corner + 32, corner + 31], 1)]
    )
    return vertices, faces.astype(np.int32)


def camera_poses() -> F64:
    poses = np.tile(np.eye(4), (N_FRAMES, 1, 1))
    for i in range(N_FRAMES):
        poses[i, :3, :3] = Rotation.from_euler("xy", [180 + 3 * (i % 3), 4 * i - 20], degrees=True).as_matrix()
        poses[i, :3, 3] = [0.004 * i - 0.02, 0.003 * (i % 4), 0.05 + 0.001 * (i % 2)]
    return poses


def defects() -> list[Row]:
    vertices, _ = plate()
    rows = []
    for number, place in enumerate(([0.01, 0.01], [-0.01, -0.012], [0.025, -0.025])):
        patch = vertices[np.linalg.norm(vertices[:, :2] - place, axis=1) < 0.004] if number < 2 else np.zeros((0, 3))
        center = patch.mean(axis=0).tolist() if len(patch) else None
        rows.append({"id": number, "surface_center": center, "surface_points": patch.tolist(), "radius_m": 0.004})
    return rows


BOXES = {0: [400.0, 300.0, 460.0, 360.0], 1: [500.0, 380.0, 560.0, 440.0]}


def write_truth(folder: Path) -> Path:
    cameras = {
        "camera": {"width": 960, "height": 720, "F": 520.0, "K3": -3e-10},
        "roi": [0.04, 0.11, 0.86, 0.84],
        "fps": 12.0,
        "cam_to_world": camera_poses().tolist(),
    }
    visible = [[{"defect": key, "bbox": box} for key, box in BOXES.items()] for _ in range(N_FRAMES)]
    truth = {"chord_m": [0.03, 0.024], "defects": defects(), "visible": visible}
    (folder / "cameras.json").write_text(json.dumps(cameras))
    (folder / "defects.json").write_text(json.dumps(truth))
    write_mesh(folder / "surface.ply", Mesh(*plate()))
    return folder


def detection(frame: int, box: ArrayLike, xyz_m: ArrayLike | None, **changes: object) -> Row:
    x1, y1, x2, y2 = np.asarray(box) / [960, 720, 960, 720]
    place = dict(zip("xyz", (None,) * 3 if xyz_m is None else to_model(np.array(xyz_m)).tolist(), strict=True))
    row = {"time_s": round(frame / 12, 4), "box_x1": x1, "box_y1": y1, "box_x2": x2, "box_y2": y2, **place}
    return {**row, "outcome": "mapped", "rung": "surface", "confidence": None, "defect_id": None, "model": 0, **changes}


def write_result(
    folder: Path,
    poses: F64 | None = None,
    frames: Sequence[int] = range(N_FRAMES),
    points: F64 | None = None,
    detections: Sequence[Row] = (),
    defects: Sequence[Row] = (),
) -> Path:
    poses, (vertices, faces) = camera_poses() if poses is None else poses, plate()
    rows = [f"{i},{source},0,0,x,sampled,1,0" for i, source in enumerate(frames)]
    (folder / "frames.csv").write_text("\n".join(["index,source_index,pts,time_s,sha256,role,registered,model", *rows]))
    (folder / "sparse").mkdir(exist_ok=True)
    sparse_model(poses[list(frames)]).write_binary(folder / "sparse")
    (folder / "dense").mkdir(exist_ok=True)
    points = to_model(vertices if points is None else points)
    write_mesh(folder / "dense/mesh_poisson.ply", Mesh(points, faces))
    write_cloud(folder / "dense/fused.ply", Mesh(points))
    (folder / "mapping").mkdir(exist_ok=True)
    (folder / "mapping/detections.json").write_text(json.dumps(list(detections)))
    (folder / "mapping/defects.json").write_text(json.dumps(list(defects)))
    return folder


def sparse_model(poses: F64) -> pycolmap.Reconstruction:
    model = pycolmap.Reconstruction()
    camera = pycolmap.Camera(
        model="OPENCV_FISHEYE", width=787, height=525, params=[520, 520, 442, 281, 0, 0, 0, 0], camera_id=1
    )
    model.add_camera_with_trivial_rig(camera)
    for i, pose in enumerate(poses):
        world_from_cam = pycolmap.Rigid3d(
            pycolmap.Rotation3d((ROTATION.inv() * Rotation.from_matrix(pose[:3, :3])).as_matrix()),
            to_model(pose[:3, 3]),
        )
        image = pycolmap.Image(name=f"{i:04d}.jpg", points2D=[], camera_id=1, image_id=i + 1)
        model.add_image_with_trivial_frame(image, world_from_cam.inverse())
        model.register_frame(model.image(i + 1).frame_id)
    return model
