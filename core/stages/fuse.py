"""Stage `fuse`: all depth maps into one point cloud."""

from __future__ import annotations

import shutil

from core.dense.maps import map_paths, open_scene
from core.dense.workspace import fuse
from core.io.surface import fused_cloud
from core.products.surface import DepthProduct, FuseProduct
from core.stage import StageTask


def run(task: StageTask) -> FuseProduct:
    """Write ``fused.ply``."""
    scene = open_scene(task.input("undistort"))
    chunks = task.fan_in("geometric")
    maps = map_paths(folder for _, folder in chunks)
    methods = sorted({one.method for one in task.products.every(DepthProduct, (key for key, _ in chunks))})
    workspace = task.out / "workspace"
    task.report(0, 1, "fusing")
    cloud = fuse(scene, maps, workspace, fused_cloud(task.out), task.settings.fusion)
    shutil.rmtree(workspace)
    return FuseProduct(n_points=len(cloud.vertices), method="+".join(methods))
