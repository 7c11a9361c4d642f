"""Sparse models between stages: the folder ``model`` of a result, and ``cameras.npz``."""

from __future__ import annotations

from pathlib import Path

import cv2  # noqa: F401  (before pycolmap: the other order aborts in PNG writing)
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.errors import StageFailed
from core.scene.views import Views

_MODEL = "model"
_CAMERAS = "cameras.npz"


def model_folder(folder: Path, number: int = 0) -> Path:
    """Folder of COLMAP's files in a result; of the further model `number` in the result of `pieces`."""
    return folder / str(number) / _MODEL if number else folder / _MODEL


def has_model(folder: Path) -> bool:
    """Whether a result has a sparse model."""
    return model_folder(folder).is_dir()


def write_model(folder: Path, model: pycolmap.Reconstruction, number: int = 0) -> None:
    """Write the sparse model of a result, or a further one under its number."""
    path = model_folder(folder, number)
    path.mkdir(parents=True)
    model.write_binary(path)


def read_model(folder: Path, number: int = 0) -> pycolmap.Reconstruction:
    """Read what `write_model` wrote; `StageFailed` when there is none."""
    return open_model(model_folder(folder, number))


def open_model(path: Path) -> pycolmap.Reconstruction:
    """The COLMAP model in a folder of its own files; `StageFailed` when there is none."""
    try:
        return pycolmap.Reconstruction(str(path))
    except (ValueError, RuntimeError, OSError) as error:
        raise StageFailed(f"no sparse model in {path.name}: {error}", where=path.name) from None


def write_cameras(folder: Path, views: Views) -> None:
    """Write the poses of the registered images, for choosing where to look at the surface from."""
    poses = np.concatenate([views.R, views.t[:, :, None]], axis=2)
    np.savez(folder / _CAMERAS, frame_index=views.frame_index, cam_from_world=poses)


def read_poses(folder: Path) -> NDArray[np.float64]:
    """(n, 3, 4) cam_from_world of the registered images, as `write_cameras` wrote them."""
    with np.load(folder / _CAMERAS) as cameras:
        poses: NDArray[np.float64] = cameras["cam_from_world"]
    return poses
