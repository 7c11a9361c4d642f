"""Stage `fuse`: all depth maps into one point cloud."""

from __future__ import annotations

import shutil

from core.dense.maps import map_paths, open_scene
from core.dense.workspace import fuse
from core.io.surface import fused_cloud
from core.stage import StageResult, StageTask


def run(task: StageTask) -> StageResult:
    """Write ``fused.ply``; facts n_points and the method that made the depth maps."""
    scene = open_scene(task.input("undistort"))
    chunks = task.fan_in("geometric")
    maps = map_paths(folder for _, folder in chunks)
    methods = sorted({str(task.facts.get(key, {}).get("method", "cpu")) for key, _ in chunks})
    workspace = task.out / "workspace"
    task.report(0, 1, "fusing")
    cloud = fuse(scene, maps, workspace, fused_cloud(task.out), task.settings.fusion)
    shutil.rmtree(workspace)
    return StageResult({"n_points": len(cloud.vertices), "method": "+".join(methods)})
