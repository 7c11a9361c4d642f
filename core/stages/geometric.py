"""Stage `geometric/NNN`: geometric consistency and filtering of one chunk of views."""

from __future__ import annotations

import shutil
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path

from core.dense import cuda
from core.dense.geometric import GeometricFilter
from core.dense.maps import DenseScene, DepthMap, map_path, map_paths, open_scene, write_map
from core.dense.views import DenseView
from core.products.surface import DepthProduct
from core.stage import StageTask


def run(task: StageTask) -> DepthProduct:
    """Write ``NAME.npz`` of views [start, end)."""
    scene = open_scene(task.input("undistort"))
    views = scene.views[int(task.args["start"]) : int(task.args["end"])]
    paths = map_paths(folder for _, folder in task.fan_in("depth"))
    method = cuda.resolve_method(task.settings.dense)
    maps = _on_cuda(task, scene, views, paths) if method == "cuda" else _on_cpu(task, scene, views, paths)
    shares = []
    for name, found in maps:
        write_map(map_path(task.out, name), found)
        shares.append(found.valid_share)
    share = round(sum(shares) / max(1, len(shares)), 4)
    return DepthProduct(n_views=len(shares), valid_share=share, method=method)


def _on_cpu(
    task: StageTask, scene: DenseScene, views: Sequence[DenseView], paths: dict[str, Path]
) -> Iterator[tuple[str, DepthMap]]:
    judge = GeometricFilter(scene, task.settings.dense, paths, task.settings.seed, task.threads)
    for number, view in enumerate(views):
        yield view.name, judge.depth_map(view, partial(_report, task, number, len(views), view.name))


def _on_cuda(
    task: StageTask, scene: DenseScene, views: Sequence[DenseView], paths: dict[str, Path]
) -> Iterator[tuple[str, DepthMap]]:
    workspace = task.out / "workspace"
    cuda.geometric(scene, views, paths, workspace, task.settings.dense)
    yield from cuda.collect(workspace, views, "geometric").items()
    shutil.rmtree(workspace)


def _report(task: StageTask, number: int, total: int, name: str, done: float) -> None:
    task.report(number + done, total, name)
