"""Depth maps by COLMAP's PatchMatch on CUDA, for machines and builds of pycolmap that have it.

Chunks map onto COLMAP's two passes: `photometric` runs the first for a chunk's views; `geometric` puts the first
pass of all views beside the chunk's configuration, so that COLMAP, which skips maps that exist, runs only the second.

This path has not been run: no CUDA build of pycolmap was at hand. What is tested is the choice of the method, the
workspace and the configuration that COLMAP reads.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import cv2  # noqa: F401  (before pycolmap: the other order aborts when a PNG is written)
import pycolmap

from core.dense.maps import DenseScene, DepthMap, read_map
from core.dense.views import DenseView
from core.dense.workspace import depth_path, read_maps, write_maps, write_patch_match_config, write_workspace
from core.errors import BadInput
from core.settings.groups import DenseSettings

Method = Literal["cpu", "cuda"]


def resolve_method(settings: DenseSettings, has_cuda: bool | None = None) -> Method:
    """The method that this process will use; `BadInput` when CUDA is demanded of a build without it."""
    available = bool(pycolmap.has_cuda) if has_cuda is None else has_cuda
    if settings.method == "cuda" and not available:
        raise BadInput(
            "dense.method is 'cuda' but this pycolmap has no CUDA; use 'auto' or 'cpu'", where="dense.method"
        )
    return "cuda" if available and settings.method != "cpu" else "cpu"


def patch_match_options(settings: DenseSettings, geometric: bool) -> pycolmap.PatchMatchOptions:
    """pycolmap.PatchMatchOptions of our settings; the window and the sampling stay COLMAP's."""
    options = pycolmap.PatchMatchOptions()
    options.geom_consistency = geometric
    options.filter = geometric
    options.filter_min_ncc = settings.min_ncc
    options.filter_min_triangulation_angle = settings.min_triangulation_deg
    options.filter_min_num_consistent = settings.min_consistent
    return options


def photometric(scene: DenseScene, views: Sequence[DenseView], workspace: Path, settings: DenseSettings) -> None:
    """COLMAP's first pass for `views`; leaves NAME.photometric.bin in the workspace."""
    write_workspace(workspace, scene.folder, scene.views)
    config = write_patch_match_config(workspace, views)
    pycolmap.patch_match_stereo(
        str(workspace), options=patch_match_options(settings, geometric=False), config_path=str(config)
    )


def geometric(
    scene: DenseScene,
    views: Sequence[DenseView],
    maps: Mapping[str, Path],
    workspace: Path,
    settings: DenseSettings,
) -> None:
    """COLMAP's second pass for `views` from the photometric maps at `maps`; leaves NAME.geometric.bin."""
    write_workspace(workspace, scene.folder, scene.views)
    known = [replace(view, sources=tuple(name for name in view.sources if name in maps)) for view in views]
    config = write_patch_match_config(workspace, [view for view in known if view.sources])
    for name in sorted({name for view in known for name in (view.name, *view.sources)}):
        write_maps(workspace, name, read_map(maps[name]), "photometric")
    pycolmap.patch_match_stereo(
        str(workspace), options=patch_match_options(settings, geometric=True), config_path=str(config)
    )


def collect(workspace: Path, views: Sequence[DenseView], kind: str) -> dict[str, DepthMap]:
    """The maps that COLMAP wrote, by image name."""
    done = [view for view in views if depth_path(workspace, view.name, kind).exists()]
    return {view.name: read_maps(workspace, view.name, kind) for view in done}
