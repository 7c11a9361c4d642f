"""The results of earlier stages, opened as what placing detections asks for."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import cv2  # noqa: F401  (before pycolmap: the other order aborts in PNG writing)
import numpy as np
from numpy.typing import NDArray

from core.dense.cameras import Pinhole
from core.dense.maps import map_paths, open_scene, read_map
from core.geometry.boxes import Box
from core.geometry.pose import Pose
from core.mapping.consensus import looked_at
from core.mapping.depth_consistency import DepthMaps
from core.mapping.facing import read_surface
from core.mapping.scene import Scene, SparsePoints, cloud_tree, face_normals, mean_focal
from core.mapping.support import read_sparse_model
from core.mapping.surface import Surface
from core.mapping.surface_rules import Matches
from core.scene.frame import Crop, index_of_image
from core.scene.views import Views
from core.surface.ply import read_mesh
from core.surface.support import point_spacing
from core.viewgraph import database_of, open_database, read_graph

F64 = NDArray[np.float64]

_OPEN_MAPS = 12
MAX_NEIGHBOURS = 4
"""Registered frames that a mask is carried to, at most: those with the most matches."""


def open_mapping_scene(
    model_dir: Path,
    mesh_path: Path,
    cloud_path: Path,
    crop: Crop,
    boxes: Mapping[int, Sequence[tuple[Box, str]]],
    depth: DepthMaps,
    threads: int,
    model: int = 0,
) -> Scene:
    """Open a model with its surface.

    Args:
        model_dir: COLMAP model, image id = frame index + 1.
        mesh_path: the supported surface.
        cloud_path: the fused points.
        crop: of the exported frames.
        boxes: what the detector said, see `core.mapping.consensus.looked_at`.
        depth: depth maps.
        threads: for casting.
        model: its number.
    """
    mesh, views = read_surface(model_dir, mesh_path)
    points = read_mesh(cloud_path).vertices
    with_boxes = [frame for frame, found in boxes.items() if found]
    # A frame without a box of its own is asked for nothing but its pose.
    sparse = read_sparse_model(model_dir, with_boxes)
    return Scene(
        views=views,
        mesh=mesh,
        surface=Surface(mesh.vertices, mesh.faces, threads),
        face_normals=face_normals(mesh),
        cloud=cloud_tree(points),
        spacing=point_spacing(points),
        crop=crop,
        sparse=SparsePoints(sparse.observations, sparse.positions),
        frames=looked_at(views, boxes),
        depth=depth,
        focal_px=mean_focal(views.camera),
        model=model,
    )


def open_depth_maps(undistorted: Path, folders: Iterable[Path]) -> DepthMaps:
    """Depth maps of the dense views, asked by frame index and world positions."""
    scene = open_scene(undistorted)
    paths = map_paths(folders)
    names = {index_of_image(name): name for name in paths}

    @lru_cache(maxsize=_OPEN_MAPS)
    def depth_of(frame_index: int) -> NDArray[np.float32]:
        return read_map(paths[names[frame_index]]).depth

    def distances(frame_index: int, points: F64) -> tuple[F64, F64]:
        pose = scene.poses[names[frame_index]]
        return distances_in_map(depth_of(frame_index), scene.pinhole, pose, points)

    return DepthMaps(np.array(sorted(names), np.int64), distances)


def distances_in_map(depth: NDArray[np.float32], pinhole: Pinhole, pose: Pose, points: F64) -> tuple[F64, F64]:
    """What a depth map shows in the direction of (n, 3) world points.

    Returns:
        (n,) distance of the map's surface from the projection centre (0 = none), by the pixel that shows each
        point, and (n,) distance of the point itself.
    """
    in_cam = pose.in_camera(points)
    own: F64 = np.linalg.norm(in_cam, axis=1)
    z = in_cam[:, 2]
    ahead = z > 1e-6 * np.maximum(own, 1e-300)
    safe = np.where(ahead, z, 1.0)
    with np.errstate(over="ignore", invalid="ignore"):
        u = np.floor(pinhole.focal_px * in_cam[:, 0] / safe + pinhole.cx)
        v = np.floor(pinhole.focal_px * in_cam[:, 1] / safe + pinhole.cy)
    inside = ahead & (u >= 0) & (v >= 0) & (u < depth.shape[1]) & (v < depth.shape[0])
    found = np.zeros(len(points))
    column, row = u[inside].astype(np.int64), v[inside].astype(np.int64)
    found[inside] = depth[row, column] * own[inside] / safe[inside]
    return found, own


def matches_of_graph(graph: Path, views: Views) -> Matches:
    """Verified matches of a frame with registered ones, from the result of stage `graph`."""
    table = read_graph(graph)
    registered = set(views.frame_index.tolist())
    keypoints = _keypoints(database_of(graph))

    def matches(index: int) -> list[tuple[int, F64, F64]]:
        found = []
        for row in np.flatnonzero((table.pairs == index).any(axis=1) & table.verified).tolist():
            first, second = table.pairs[row].tolist()
            other = second if first == index else first
            if other not in registered:
                continue
            inliers = table.inliers[table.offsets[row] : table.offsets[row + 1]].astype(np.int64)
            own, theirs = (0, 1) if first == index else (1, 0)
            found.append((other, keypoints(index)[inliers[:, own]], keypoints(other)[inliers[:, theirs]]))
        return sorted(found, key=lambda item: (-len(item[1]), item[0]))[:MAX_NEIGHBOURS]

    return matches


def _keypoints(database_path: Path) -> Callable[[int], F64]:
    @lru_cache(maxsize=16)
    def of(index: int) -> F64:
        with open_database(database_path) as database:
            values: Any = database.read_keypoints(index + 1)
        return np.asarray(values, np.float64)[:, :2]

    return of
