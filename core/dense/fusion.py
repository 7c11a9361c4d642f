"""Depth maps into one point cloud: COLMAP's stereo fusion on a workspace of ours."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import cv2  # noqa: F401  (before pycolmap: the other order aborts when a PNG is written)
import pycolmap

from core.dense.maps import DenseScene, read_map
from core.dense.workspace import write_maps, write_workspace
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
