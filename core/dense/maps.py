"""Depth maps on disk and the undistorted data set that the dense stages share."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray

from core.dense.cameras import Pinhole
from core.dense.views import DenseView, read_views
from core.errors import StageFailed
from core.geometry.pose import Pose, pose_of

F32 = NDArray[np.float32]
F64 = NDArray[np.float64]
U8 = NDArray[np.uint8]


_SUFFIX = ".npz"
_MASK = "mask.png"


@dataclass(frozen=True)
class DepthMap:
    """Depth along the optical axis (0 = none), unit normals in the camera frame, and matching cost."""

    depth: F32
    """(h, w)"""
    normal: F32
    """(h, w, 3)"""
    cost: F32
    """(h, w), 1 - NCC; 2 where there is no depth."""

    @property
    def valid_share(self) -> float:
        """Share of pixels with a depth."""
        return float((self.depth > 0).mean())


def map_path(folder: Path, name: str) -> Path:
    """File of the depth map of an image, in the result of a chunk."""
    return folder / f"{name}{_SUFFIX}"


def write_map(path: Path, found: DepthMap) -> None:
    """Write ``NAME.npz``: depth as float32, normal and cost as float16 (3 decimals suffice and halve the file)."""
    np.savez(path, depth=found.depth, normal=found.normal.astype(np.float16), cost=found.cost.astype(np.float16))


def read_map(path: Path) -> DepthMap:
    """Read ``NAME.npz``."""
    try:
        with np.load(path) as data:
            return DepthMap(
                data["depth"].astype(np.float32), data["normal"].astype(np.float32), data["cost"].astype(np.float32)
            )
    except (OSError, KeyError, ValueError) as error:
        raise StageFailed(f"depth map {path.name} cannot be read: {error}", where=path.name) from None


def map_paths(folders: Iterable[Path]) -> dict[str, Path]:
    """Paths of all depth maps in the result folders of chunks, by image name."""
    return {path.name.removesuffix(_SUFFIX): path for folder in folders for path in sorted(folder.glob(f"*{_SUFFIX}"))}


@dataclass(frozen=True)
class DenseScene:
    """The result of `undistort`, opened for reading."""

    folder: Path
    pinhole: Pinhole
    poses: dict[str, Pose]
    """By image name."""
    points: dict[str, F64]
    """By image name, (n, 3) sparse points that the image observes."""
    views: tuple[DenseView, ...]

    def grey(self, name: str) -> U8:
        """(h, w) grey image."""
        image = cv2.imread(str(self.folder / "images" / name), cv2.IMREAD_GRAYSCALE)
        if image is None:
            raise StageFailed(f"undistorted image {name} cannot be read", where=name)
        return np.asarray(image, dtype=np.uint8)

    def mask(self) -> NDArray[np.bool_]:
        """(h, w) where the lens's picture covers the pinhole's."""
        image = cv2.imread(str(self.folder / _MASK), cv2.IMREAD_GRAYSCALE)
        if image is None:
            raise StageFailed("the mask of the undistorted images cannot be read", where=_MASK)
        return np.asarray(image > 127)


def write_mask(folder: Path, inside: NDArray[np.bool_]) -> None:
    """Write which pixels of the pinhole's (h, w) picture the lens's covers, into the result of `undistort`."""
    cv2.imwrite(str(folder / _MASK), inside.astype(np.uint8) * 255)


def open_scene(folder: Path) -> DenseScene:
    """Open the result folder of `undistort`."""
    model = pycolmap.Reconstruction(str(folder / "sparse"))
    camera = next(iter(model.cameras.values()))
    pinhole = Pinhole(
        float(camera.params[0]), float(camera.params[2]), float(camera.params[3]), camera.width, camera.height
    )
    poses, points = {}, {}
    for _, image in sorted(model.images.items()):
        poses[image.name] = pose_of(image)
        ids = sorted({o.point3D_id for o in image.get_observation_points2D()})
        points[image.name] = np.array([model.points3D[i].xyz for i in ids], dtype=np.float64).reshape(-1, 3)
    return DenseScene(folder, pinhole, poses, points, tuple(read_views(folder)))
