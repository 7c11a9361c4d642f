"""Two plates one behind the other, seen by a fisheye camera that steps sideways: a scene with an edge.

The near plate is z = 4 for x < 0, the far one z = 6 everywhere. Everything can be scaled, since no rule may
depend on the unit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import cv2  # noqa: F401  (before pycolmap)
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.mapping.consensus import looked_at
from core.mapping.depth_consistency import DepthMaps, no_depth_maps
from core.mapping.scene import Scene, SparsePoints, cloud_tree, face_normals
from core.mapping.support import Observations
from core.mapping.surface import Surface
from core.scene.detection import Detection
from core.scene.frame import Crop, RunFrames
from core.scene.views import Views
from core.surface.ply import Mesh
from tests.core.making_rows import run_frames

WIDTH, HEIGHT, FOCAL = 320, 240, 160.0
NEAR, FAR, STEP = 4.0, 6.0, 0.1
SPACING = 0.05
CROP = Crop(20, 10, 20 + WIDTH, 10 + HEIGHT, 360, 260)


def camera() -> pycolmap.Camera:
    params = [FOCAL, FOCAL, WIDTH / 2 + 3, HEIGHT / 2 - 2, -0.02, 0.003, 0.0, 0.0]
    return pycolmap.Camera(model="OPENCV_FISHEYE", width=WIDTH, height=HEIGHT, params=params, camera_id=1)


def views(frames: Sequence[int], scale: float = 1.0) -> Views:
    """Camera i at x = STEP * i, looking along +z."""
    R = np.tile(np.eye(3), (len(frames), 1, 1))
    t = np.array([[-STEP * frame, 0.0, 0.0] for frame in frames]).reshape(-1, 3) * scale
    return Views(np.array(frames, np.int64), R, t, camera())


def plate(x: tuple[float, float], y: tuple[float, float], z: float) -> Mesh:
    """Facing the cameras; vertices every SPACING."""
    columns, rows = np.arange(x[0], x[1] + 1e-9, SPACING), np.arange(y[0], y[1] + 1e-9, SPACING)
    grid_x, grid_y = np.meshgrid(columns, rows)
    index = np.arange(grid_x.size).reshape(grid_x.shape)
    a, b, c, d = (part.ravel() for part in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    faces = np.vstack([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)]).astype(np.int32)
    return Mesh(np.column_stack([grid_x.ravel(), grid_y.ravel(), np.full(grid_x.size, z)]), faces)


def joined(meshes: Sequence[Mesh]) -> Mesh:
    offsets = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    faces = [mesh.faces + offset for mesh, offset in zip(meshes, offsets, strict=True)]
    return Mesh(np.concatenate([mesh.vertices for mesh in meshes]), np.concatenate(faces).astype(np.int32))


def plates(*more: Mesh) -> Mesh:
    return joined([plate((-3.0, 0.0), (-2.0, 2.0), NEAR), plate((-4.0, 4.0), (-3.0, 3.0), FAR), *more])


def scene(
    frames: Sequence[int] = tuple(range(10)),
    detections: Sequence[Detection] = (),
    mesh: Mesh | None = None,
    looked: Sequence[int] | None = None,
    depth: DepthMaps | None = None,
    sparse: Mapping[int, tuple[np.ndarray, np.ndarray]] | None = None,
    scale: float = 1.0,
) -> Scene:
    """Frame index = source index. `looked`: frames the detector saw (all); `sparse`: keypoints, points."""
    mesh = plates() if mesh is None else mesh
    mesh = Mesh(mesh.vertices * scale, mesh.faces)
    boxes: dict[int, list[tuple[tuple[float, float, float, float], str]]] = {
        frame: [] for frame in (frames if looked is None else looked)
    }
    for one in detections:
        if one.source_index in boxes:
            boxes[one.source_index].append((in_crop(one), one.label))
    observations: dict[int, Observations] = {}
    positions: dict[int, NDArray[np.float64]] = {}
    for frame, (xy, points) in (sparse or {}).items():
        ids = np.arange(len(points)) + 1000 * frame
        observations[frame] = Observations(xy, ids)
        positions |= {int(i): point * scale for i, point in zip(ids, points, strict=True)}
    seen = views(frames, scale)
    return Scene(
        views=seen,
        mesh=mesh,
        surface=Surface(mesh.vertices, mesh.faces),
        face_normals=face_normals(mesh),
        cloud=cloud_tree(mesh.vertices),
        spacing=SPACING * scale,
        crop=CROP,
        sparse=SparsePoints(observations, positions),
        frames=looked_at(seen, boxes),
        depth=depth or no_depth_maps(),
        focal_px=FOCAL,
    )


def times(count: int = 12, step_s: float = 0.1) -> RunFrames:
    return run_frames(count, step_s)


def no_matches(_index: int) -> list[tuple[int, np.ndarray, np.ndarray]]:
    return []


def pixel(place: Sequence[float], frame: int) -> np.ndarray:
    """(2,) crop pixel of a place (unscaled) in a frame."""
    at = camera().img_from_cam(np.array(place, np.float64) - [STEP * frame, 0.0, 0.0])
    return np.asarray(at, np.float64)


def detection(
    number: int,
    place: Sequence[float],
    frame: int,
    half_px: float = 8.0,
    label: str = "dent",
    polygon_px: Sequence[tuple[float, float]] | None = None,
    **more: object,
) -> Detection:
    """A box around a place as a frame sees it, normalised on the source frame."""
    x, y = pixel(place, frame) + np.array([CROP.x0, CROP.y0])
    size = np.array([CROP.source_width, CROP.source_height] * 2)
    box = np.array([x - half_px, y - half_px, x + half_px, y + half_px]) / size
    polygon = None
    if polygon_px is not None:
        polygon = tuple(((px + CROP.x0) / size[0], (py + CROP.y0) / size[1]) for px, py in polygon_px)
    key = f"{0.1 * frame:.4f}"
    values = {"score": 0.8, "source_index": frame, "polygon": polygon, **more}
    return Detection(number, key, 0.1 * frame, label, box=tuple(box.tolist()), **values)  # type: ignore[arg-type]


def in_crop(one: Detection) -> tuple[float, float, float, float]:
    x1, y1, x2, y2 = one.box
    w, h = CROP.source_width, CROP.source_height
    return x1 * w - CROP.x0, y1 * h - CROP.y0, x2 * w - CROP.x0, y2 * h - CROP.y0


def depth_maps_of(mesh: Mesh, frames: Sequence[int], scale: float = 1.0) -> DepthMaps:
    """What depth maps of these frames would measure on a surface: exact distances along any ray."""
    surface = Surface(mesh.vertices * scale, mesh.faces)

    def distances(frame: int, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        origin = np.array([STEP * frame, 0.0, 0.0]) * scale
        own = np.linalg.norm(points - origin, axis=1)
        hits = surface.cast(np.broadcast_to(origin, points.shape), (points - origin) / own[:, None])
        return np.where(hits.hit, hits.distance, 0.0), own

    return DepthMaps(np.array(sorted(frames), np.int64), distances)


def write_model(folder: Path, frames: Sequence[int]) -> None:
    """Cameras, and a few points on the near plate that all of them see."""
    model = pycolmap.Reconstruction()
    model.add_camera_with_trivial_rig(camera())
    points = np.array([(x, y, NEAR) for x in np.linspace(-1.6, -0.5, 12) for y in np.linspace(-0.5, 0.4, 8)])
    ids = [model.add_point3D(point, pycolmap.Track(), np.zeros(3, np.uint8)) for point in points]
    for frame in frames:
        xy = np.array([pixel(point, frame) for point in points])
        keypoints = pycolmap.Point2DList([pycolmap.Point2D(at) for at in xy])
        image = pycolmap.Image(name=f"{frame:04d}.jpg", points2D=keypoints, camera_id=1, image_id=frame + 1)
        pose = pycolmap.Rigid3d(np.column_stack([np.eye(3), [-STEP * frame, 0, 0]]))
        model.add_image_with_trivial_frame(image, pose)
        for k, point_id in enumerate(ids):
            model.add_observation(point_id, pycolmap.TrackElement(frame + 1, k))
    folder.mkdir()
    model.write_binary(folder)
