"""Stage `depth/NNN`: photometric depth maps of one chunk of views."""

from __future__ import annotations

from functools import partial

from core.dense.maps import open_scene, write_map
from core.dense.stereo import PhotometricStereo
from core.stage import StageResult, StageTask


def run(task: StageTask) -> StageResult:
    """Write ``NAME.npz`` of views [start, end); facts n_views, valid_share."""
    scene = open_scene(task.input("undistort"))
    views = scene.views[int(task.args["start"]) : int(task.args["end"])]
    stereo = PhotometricStereo(scene, task.settings.dense, task.settings.seed, task.threads)
    shares = []
    for number, view in enumerate(views):
        found = stereo.depth_map(view, partial(_report, task, number, len(views), view.name))
        write_map(task.out / f"{view.name}.npz", found)
        shares.append(found.valid_share)
    return StageResult({"n_views": len(views), "valid_share": round(sum(shares) / max(1, len(shares)), 4)})


def _report(task: StageTask, number: int, total: int, name: str, done: float) -> None:
    task.report(number + done, total, name)
