"""COLMAP's dense workspace, as its stereo fusion and CUDA PatchMatch read it, and that fusion."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import cv2  # noqa: F401  (before pycolmap: the other order aborts when a PNG is written)
import numpy as np
import pycolmap

from core.dense.maps import DenseScene, DepthMap, read_map
from core.dense.views import DenseView
from core.errors import StageFailed
from core.settings.groups import FusionSettings
from core.surface.ply import Mesh, read_mesh, write_cloud

CLOUD_COMMENTS = ("world frame: that of the sparse model", "unit: model units")
"""What every PLY of the dense surface says about its coordinates."""


def fuse(scene: DenseScene, maps: Mapping[str, Path], workspace: Path, out: Path, settings: FusionSettings) -> Mesh:
    """Fuse the depth maps at `maps` (by image name) into the cloud `out` with normals and colours.

    One thread: COLMAP's fusion threads share an unsynchronised mask, so more would not repeat.

    Raises:
        StageFailed: no point was seen by enough depth maps.
    """
    views = [view for view in scene.views if view.name in maps]
    write_workspace(workspace, scene.folder, views)
    for view in views:
        write_maps(workspace, view.name, read_map(maps[view.name]))
    options = pycolmap.StereoFusionOptions()
    options.min_num_pixels = min(settings.min_num_pixels, len(views))
    options.max_reproj_error = settings.max_reproj_error_px
    options.max_depth_error = settings.max_depth_error
    options.max_normal_error = settings.max_normal_error_deg
    options.num_threads = 1
    pycolmap.stereo_fusion(str(out), str(workspace), input_type="geometric", options=options, output_type="PLY")
    out.with_name(out.name + ".vis").unlink(missing_ok=True)
    cloud = read_mesh(out)
    if not len(cloud.vertices):
        raise StageFailed("the depth maps agree nowhere: the fused cloud is empty", code="empty_cloud", where="fuse")
    write_cloud(out, cloud, CLOUD_COMMENTS)
    return cloud


def write_workspace(workspace: Path, undistorted: Path, views: Sequence[DenseView]) -> None:
    """Lay out ``images/``, ``sparse/``, ``stereo/`` and ``fusion.cfg`` for the given views.

    The principal point in ``sparse/`` is moved by half a pixel: COLMAP's fusion (and its CUDA kernels) multiply whole
    pixel indices with the inverse of K although K has its pixel centres at 0.5. Without the shift the fused
    surface is off by half a pixel.
    """
    for folder in ("images", "sparse", "stereo/depth_maps", "stereo/normal_maps", "stereo/consistency_graphs"):
        (workspace / folder).mkdir(parents=True, exist_ok=True)
    model = pycolmap.Reconstruction(str(undistorted / "sparse"))
    shift_principal_point(model, -0.5)
    model.write(str(workspace / "sparse"))
    for _, image in sorted(model.images.items()):
        target = workspace / "images" / image.name
        if not target.exists():
            _link(undistorted / "images" / image.name, target)
    names = [view.name for view in views]
    (workspace / "stereo" / "fusion.cfg").write_text("".join(f"{name}\n" for name in names))


def shift_principal_point(model: pycolmap.Reconstruction, offset_px: float) -> None:
    """Move cx and cy of every PINHOLE camera of a pycolmap.Reconstruction."""
    for camera in model.cameras.values():
        params = np.array(camera.params)
        params[2:4] += offset_px
        camera.params = params


def _link(source: Path, target: Path) -> None:
    """Symbolic link, or a copy where links are not supported."""
    try:
        target.symlink_to(source.resolve())
    except OSError:
        shutil.copyfile(source, target)


def depth_path(workspace: Path, name: str, kind: str) -> Path:
    """File of an image's depth map, by COLMAP's name."""
    return workspace / "stereo" / "depth_maps" / f"{name}.{kind}.bin"


def normal_path(workspace: Path, name: str, kind: str) -> Path:
    """File of its normals."""
    return depth_path(workspace, name, kind).parents[1] / "normal_maps" / depth_path(workspace, name, kind).name


def write_maps(workspace: Path, name: str, found: DepthMap, kind: str = "geometric") -> None:
    """Write one view's depth and normal map in COLMAP's format. Depth <= 0 means none."""
    depth = np.ascontiguousarray(found.depth, dtype=np.float32)
    valid = depth[depth > 0]
    low, high = (float(valid.min()), float(valid.max())) if len(valid) else (0.0, 1.0)
    pycolmap.DepthMap.from_array(depth, low, high).write(str(depth_path(workspace, name, kind)))
    normals = np.ascontiguousarray(found.normal, dtype=np.float32)
    pycolmap.NormalMap.from_array(normals).write(str(normal_path(workspace, name, kind)))


def read_maps(workspace: Path, name: str, kind: str = "geometric") -> DepthMap:
    """Read one view's maps; COLMAP keeps no cost, so it is 0 where there is a depth and 2 elsewhere."""
    depth_map, normal_map = pycolmap.DepthMap(), pycolmap.NormalMap()
    depth_map.read(str(depth_path(workspace, name, kind)))
    normal_map.read(str(normal_path(workspace, name, kind)))
    depth = np.maximum(np.asarray(depth_map.to_array(), dtype=np.float32), 0.0)
    normal = np.asarray(normal_map.to_array(), dtype=np.float32)
    cost = np.where(depth > 0, 0.0, 2.0).astype(np.float32)
    return DepthMap(depth, normal, cost)


def write_patch_match_config(workspace: Path, views: Iterable[DenseView]) -> Path:
    """Write COLMAP's list of reference images and their sources; returns its path."""
    path = workspace / "stereo" / "patch-match.cfg"
    path.write_text("".join(f"{view.name}\n{', '.join(view.sources)}\n" for view in views))
    return path
