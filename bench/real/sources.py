"""Clips out of public repositories, built from checkouts that lie side by side in one folder, each by its own name.

Nothing of them is part of the project. Every source says where in its checkout pictures and poses lie and how its
poses are written; docs/experiments/real-footage.md lists the repositories with their licences.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from bench.real.clip import DEPTHS, PICTURES, Clip, Reference, write_reference
from core.errors import BadInput

F64 = NDArray[np.float64]

SINUS = "example_training_data_root/bag_1/_start_004259_end_004629_stride_25_segment_13"
TEMPLE = "data/templeRing"
FOUNTAIN = "Benchmarking_Camera_Calibration_2008/fountain-P11"
KITTI = "data/KITTI07"
KITTI_POSES = "EndoSfMLearner/kitti_eval/gt_poses/07.txt"
KITTI_FRAMES = 60
TUBE = "docker_templates/SimCol3D-task1-depth-docker/images/input"


@dataclass(frozen=True)
class Cameras:
    """Poses and lens as a source states them."""

    centers: F64 | None = None
    """(n, 3)"""
    rotations: F64 | None = None
    """(n, 3, 3) world_from_cam."""
    focal_px: float | None = None


@dataclass(frozen=True)
class Source:
    """How one clip is made of checkouts."""

    name: str
    repository: str
    """owner/name of the repository of the pictures; its checkout is the folder `name`."""
    pictures: str
    """Pattern of the pictures below the checkout; they are taken in the order of their names."""
    cameras: Callable[[Path], Cameras]
    """Reads the poses; given the folder of all checkouts."""
    n_frames: int | None = None
    """Take the first so many pictures; None for all."""
    depths: str = ""
    """Pattern of the depth pictures, where a source has them."""

    @property
    def checkout(self) -> str:
        """Name of the folder of the checkout."""
        return self.repository.partition("/")[2]

    def is_there(self, checkouts: Path) -> bool:
        """Whether the checkout that holds the pictures lies in the folder."""
        return (checkouts / self.checkout).is_dir()

    def build(self, checkouts: Path, folder: Path) -> Clip:
        """Copy the pictures, as they are, and write the reference into an empty `folder`.

        Raises:
            BadInput: the checkout has no such pictures, or its poses are not of their number.
        """
        root = checkouts / self.checkout
        pictures = sorted(root.glob(self.pictures))[: self.n_frames]
        if not pictures:
            raise BadInput(f"the checkout of {self.repository} has no {self.pictures}", where=self.name)
        cameras = self._read_cameras(checkouts, len(pictures))
        _copy(pictures, folder / PICTURES)
        if self.depths:
            _copy(sorted(root.glob(self.depths))[: self.n_frames], folder / DEPTHS)
        first = cv2.imread(str(pictures[0]), cv2.IMREAD_UNCHANGED)
        if first is None:
            raise BadInput(f"{pictures[0].name} is not a picture: the checkout holds a pointer?", where=self.name)
        write_reference(
            folder,
            Reference(
                source=f"github.com/{self.repository}, {self.pictures}",
                n_frames=len(pictures),
                centers=cameras.centers,
                rotations=cameras.rotations,
                focal_px=cameras.focal_px,
                width_px=first.shape[1],
            ),
        )
        return Clip(self.name, folder)

    def _read_cameras(self, checkouts: Path, n_frames: int) -> Cameras:
        try:
            cameras = self.cameras(checkouts)
        except (OSError, ValueError, IndexError) as error:
            raise BadInput(f"the poses of {self.name} cannot be read: {error}", where=self.name) from None
        if cameras.centers is None or cameras.rotations is None:
            return cameras
        if len(cameras.centers) < n_frames:
            text = f"{self.name} has {n_frames} pictures and {len(cameras.centers)} poses"
            raise BadInput(text, where=self.name)
        return Cameras(cameras.centers[:n_frames], cameras.rotations[:n_frames], cameras.focal_px)


def _copy(pictures: list[Path], folder: Path) -> None:
    folder.mkdir(parents=True)
    for number, picture in enumerate(pictures):
        shutil.copyfile(picture, folder / f"{number:04d}{picture.suffix.lower()}")


def _sinus(checkouts: Path) -> Cameras:
    """`motion.yaml`: position and unit quaternion of world_from_cam; fx and fy are the first two intrinsics."""
    folder = checkouts / "EndoscopyDepthEstimation-Pytorch" / SINUS
    text = (folder / "motion.yaml").read_text()
    found = dict[str, list[float]]()
    for axis, value in re.findall(r"^ {6}([xyzw]): *(\S+)", text, flags=re.MULTILINE):
        found.setdefault(axis, []).append(float(value))
    # Each pose writes x, y, z of its position, and then x, y, z, w of its quaternion.
    xyz = np.array([found["x"], found["y"], found["z"]]).T.reshape(-1, 2, 3)
    quaternions = np.column_stack([xyz[:, 1], found["w"]])
    return Cameras(xyz[:, 0], _rotations(quaternions), _mean_focal((folder / "camera_intrinsics_per_view").read_text()))


def _rotations(quaternions: F64) -> F64:
    """(n, 3, 3) of (n, 4) quaternions x, y, z, w."""
    x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), 2, 0)


def _mean_focal(text: str) -> float:
    fx, fy = text.split()[:2]
    return (float(fx) + float(fy)) / 2.0


def _temple(checkouts: Path) -> Cameras:
    """`templeR_par.txt`: name, K, R and t of cam_from_world in a row for every picture."""
    lines = (checkouts / "Multiple-View-Stereo" / TEMPLE / "templeR_par.txt").read_text().split("\n")[1:]
    rows = np.array([line.split()[1:] for line in lines if line.strip()], np.float64)
    R, t = rows[:, 9:18].reshape(-1, 3, 3), rows[:, 18:]
    return Cameras(-np.einsum("nji,nj->ni", R, t), np.swapaxes(R, 1, 2), float(rows[:, [0, 4]].mean()))


def _fountain(checkouts: Path) -> Cameras:
    """A file for every picture: K, a row of zeros, world_from_cam, the camera's centre, width and height."""
    files = sorted((checkouts / "SfM_quality_evaluation" / FOUNTAIN / "gt_dense_cameras").glob("*.camera"))
    values = np.array([path.read_text().split() for path in files], np.float64)
    rotations = values[:, 12:21].reshape(-1, 3, 3)
    return Cameras(values[:, 21:24], rotations, float(values[:, [0, 4]].mean()))


def _kitti(checkouts: Path) -> Cameras:
    """A row for every frame: world_from_cam, 3 by 4; the lens is the first matrix of `calib.txt`, 3 by 4."""
    rows = np.array([line.split() for line in (checkouts / "EndoSLAM" / KITTI_POSES).read_text().splitlines()], float)
    poses = rows.reshape(-1, 3, 4)
    calibration = (checkouts / "3dv_tutorial" / KITTI / "calib.txt").read_text().split()
    return Cameras(poses[:, :, 3], poses[:, :, :3], (float(calibration[1]) + float(calibration[6])) / 2.0)


SOURCES: tuple[Source, ...] = (
    Source("sinus", "lppllppl920/EndoscopyDepthEstimation-Pytorch", f"{SINUS}/0*.jpg", _sinus),
    Source("templeRing", "ayoleoz/Multiple-View-Stereo", f"{TEMPLE}/templeR*.png", _temple),
    Source("fountain-P11", "openMVG/SfM_quality_evaluation", f"{FOUNTAIN}/images/*.jpg", _fountain),
    Source("KITTI07", "mint-lab/3dv_tutorial", f"{KITTI}/image_0/*.png", _kitti, n_frames=KITTI_FRAMES),
    Source(
        "simcol",
        "anitarau/simcol",
        f"{TUBE}/FrameBuffer_*.png",
        lambda _: Cameras(),
        depths=f"{TUBE}/Depth_*.png",
    ),
)
