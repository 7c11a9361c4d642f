"""Ground truth of a rendered clip: exact cameras and lens, true surface, true defects."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.accuracy.true_row import TrueRow, true_row
from core.errors import BadInput, StageFailed
from core.geometry.nearest import nearest_index
from core.surface.ply import read_mesh

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]

MM_PER_M = 1000.0
RADII = 2000
"""Between the middle of a picture and its corner, that directions are known at; between them they are straight."""


@dataclass(frozen=True)
class TrueDefect:
    """One defect of the scene and the true surface that shows it; lengths in mm."""

    number: int
    center: F64
    """(3,) mean of the patch (`surface_center`)."""
    patch: F64
    """(n, 3) points of the patch (`surface_points`)."""
    sizes: Mapping[str, float]
    """`length`, `width`, `depth` (mm) and `area` (mm^2), those that are known."""


@dataclass(frozen=True)
class TrueBox:
    """A defect visible in one frame."""

    defect: int
    box_px: F64
    """(4,) x1, y1, x2, y2 on the source frame."""


@dataclass(frozen=True)
class Lens:
    """A pixel at r px from the image centre looks ``theta = r / F + K3 r^3`` off the axis."""

    width: int
    height: int
    focal_px: float
    k3: float

    def angle(self, radius_px: F64 | float) -> F64:
        """Angle off the axis (rad) that is seen so far from the image centre; of the shape of `radius_px`."""
        return np.asarray(np.multiply(radius_px, 1.0 / self.focal_px) + self.k3 * np.power(radius_px, 3), np.float64)

    def rays(self, x_px: F64, y_px: F64) -> F64:
        """(n, 3) unit viewing directions of image points in the camera frame (OpenCV axes)."""
        dx, dy = x_px - self.width / 2, y_px - self.height / 2
        r = np.hypot(dx, dy)
        theta = self.angle(r)
        scale = np.where(r > 0, np.sin(theta) / np.where(r > 0, r, 1.0), 1.0 / self.focal_px)
        return np.stack([dx * scale, dy * scale, np.cos(theta)], axis=1)

    def project(self, in_cam: F64) -> F64:
        """(n, 2) image points of (n, 3) points in the camera frame; NaN for those beyond the corners' directions."""
        radii = np.linspace(0.0, np.hypot(self.width, self.height) / 2, RADII)
        angles = self.angle(radii)
        away = np.hypot(in_cam[:, 0], in_cam[:, 1])
        r = np.interp(np.arctan2(away, in_cam[:, 2]), angles, radii, right=np.nan)
        scale = r / np.maximum(away, 1e-300)
        return np.stack([in_cam[:, 0] * scale + self.width / 2, in_cam[:, 1] * scale + self.height / 2], axis=1)


@dataclass(frozen=True)
class Truth:
    """Everything known about a clip; lengths in mm."""

    lens: Lens
    roi: tuple[float, float, float, float]
    times_s: F64
    """(n,) presentation times of the source frames."""
    centers: F64
    """(n, 3) camera centres of every source frame."""
    rotations: F64
    """(n, 3, 3) world_from_cam."""
    chord: float
    """Mean of root and tip chord."""
    defects: dict[int, TrueDefect]
    """Those that are ever visible, by number."""
    boxes: list[list[TrueBox]]
    """Visible defects of every source frame."""
    vertices: F64
    faces: I32
    row: TrueRow | None = None
    """The row of blades, where the truth tells of one."""

    @property
    def n_frames(self) -> int:
        """Number of source frames of the clip."""
        return len(self.centers)

    def frame_at(self, time_s: float) -> int | None:
        """Source frame shown at a time; None outside the clip."""
        frame = nearest_index(self.times_s.tolist(), time_s)
        spacing = float(np.diff(self.times_s).max(initial=0.0)) or 1.0
        return frame if abs(self.times_s[frame] - time_s) <= spacing / 2 else None


def load_truth(folder: Path) -> Truth:
    """Read `cameras.json`, `defects.json` and `surface.ply` (metres); `BadInput` names what is wrong."""
    cameras, defects = _json(folder / "cameras.json"), _json(folder / "defects.json")
    try:
        mesh = read_mesh(folder / "surface.ply")
        poses = np.asarray(cameras["cam_to_world"], dtype=np.float64).reshape(-1, 4, 4)
        camera = cameras["camera"]
        return Truth(
            lens=Lens(int(camera["width"]), int(camera["height"]), float(camera["F"]), float(camera["K3"])),
            roi=tuple(float(value) for value in cameras["roi"]),  # type: ignore[arg-type]  # four by the format
            times_s=_times(cameras, len(poses)),
            centers=poses[:, :3, 3] * MM_PER_M,
            rotations=poses[:, :3, :3],
            chord=float(np.mean(defects["chord_m"])) * MM_PER_M,
            defects=_defects(defects["defects"]),
            boxes=[
                [TrueBox(int(item["defect"]), np.asarray(item["bbox"], np.float64)) for item in frame]
                for frame in defects["visible"]
            ],
            vertices=mesh.vertices * MM_PER_M,
            faces=mesh.faces,
            row=true_row(defects, MM_PER_M),
        )
    except StageFailed as error:
        raise BadInput(error.message, where="surface.ply") from None
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"the truth in {folder.name} is not in the expected form: {error!r}", where="truth") from None


def _times(cameras: dict[str, Any], count: int) -> F64:
    """Times of the frames: listed, or evenly spaced by the frame rate."""
    if "times_s" in cameras:
        return np.asarray(cameras["times_s"], np.float64)
    times: F64 = np.arange(count) / float(cameras["fps"])
    return times


def _defects(rows: list[dict[str, Any]]) -> dict[int, TrueDefect]:
    """Defects with a visible patch; the others can neither be found nor missed."""
    found = {}
    for row in rows:
        patch = np.asarray(row["surface_points"], np.float64).reshape(-1, 3)
        if len(patch):
            center = np.asarray(row["surface_center"], np.float64)
            found[int(row["id"])] = TrueDefect(int(row["id"]), center * MM_PER_M, patch * MM_PER_M, _sizes(row))
    return found


def _sizes(row: dict[str, Any]) -> dict[str, float]:
    """As written; of a truth of before, the nominal diameter as length and width of what is no line."""
    keys = {"length": ("length_m", 1), "width": ("width_m", 1), "area": ("area_m2", 2), "depth": ("depth_m", 1)}
    if "length_m" in row:
        written = {name: (row[key], power) for name, (key, power) in keys.items()}
        return {name: float(value) * MM_PER_M**power for name, (value, power) in written.items() if value is not None}
    if row.get("kind", "crack") == "crack" or "radius_m" not in row:
        return {}
    diameter = 2.0 * float(row["radius_m"]) * MM_PER_M
    return {"length": diameter, "width": diameter}


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text())
    except (OSError, ValueError) as error:
        raise BadInput(f"{path.name} cannot be read: {error}", where=path.name) from None
