"""A clip with a reference: pictures or a video, and what others measured about its cameras."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput

F64 = NDArray[np.float64]

PICTURES = "pictures"
DEPTHS = "depths"
REFERENCE = "poses.json"


@dataclass(frozen=True)
class Reference:
    """What is known about the cameras of a clip; lengths in the unit of the source."""

    source: str
    """Where the clip comes from, and its licence."""
    n_frames: int
    centers: F64 | None = None
    """(n, 3) camera centres; a row of NaN is a frame without a pose, None a clip without poses."""
    rotations: F64 | None = None
    """(n, 3, 3) world_from_cam, OpenCV axes; None like `centers`."""
    focal_px: float | None = None
    """Mean focal length on a picture of `width_px`; None when it is not known."""
    width_px: int | None = None

    @property
    def extent(self) -> float:
        """Largest distance between two known camera centres, in the unit of the source."""
        if self.centers is None:
            return 0.0
        known = self.centers[np.isfinite(self.centers).all(axis=1)]
        return float(np.linalg.norm(known[:, None] - known[None], axis=2).max(initial=0.0))


@dataclass(frozen=True)
class Clip:
    """A folder of `pictures` (or `video.mp4`), `poses.json`, and for some clips `depths`, one picture a frame."""

    name: str
    folder: Path

    @property
    def video(self) -> Path:
        """What the product is given."""
        pictures = self.folder / PICTURES
        return pictures if pictures.is_dir() else self.folder / "video.mp4"

    @property
    def depths(self) -> list[Path]:
        """Depth pictures in the order of the frames, proportional to the depth along the axis; often none."""
        return sorted((self.folder / DEPTHS).glob("*.png"))


def write_reference(folder: Path, reference: Reference) -> None:
    """Write `poses.json`; a frame without a pose is null there."""
    form = {
        "source": reference.source,
        "convention": "centers in the unit of the source; rotations world_from_cam, camera axes right, down, forward",
        "n_frames": reference.n_frames,
        "focal_px": reference.focal_px,
        "width_px": reference.width_px,
        "centers": _rows(reference.centers),
        "rotations": _rows(reference.rotations),
    }
    (folder / REFERENCE).write_text(json.dumps(form, allow_nan=False))


def read_reference(folder: Path) -> Reference:
    """Read `poses.json` of a clip; `BadInput` where it is missing or not in the form that `write_reference` gives."""
    path = folder / REFERENCE
    try:
        form = json.loads(path.read_text())
        n_frames = int(form["n_frames"])
        return Reference(
            source=str(form["source"]),
            n_frames=n_frames,
            centers=_array(form["centers"], (n_frames, 3)),
            rotations=_array(form["rotations"], (n_frames, 3, 3)),
            focal_px=None if form["focal_px"] is None else float(form["focal_px"]),
            width_px=None if form["width_px"] is None else int(form["width_px"]),
        )
    except (OSError, KeyError, TypeError, ValueError) as error:
        raise BadInput(
            f"{folder.name}/{REFERENCE} is not the reference of a clip: {error!r}", where=REFERENCE
        ) from None


def _rows(values: F64 | None) -> list[Any] | None:
    """Nested lists, null where a frame's numbers are not finite."""
    if values is None:
        return None
    return [row.tolist() if np.isfinite(row).all() else None for row in values]


def _array(rows: Sequence[Any] | None, shape: tuple[int, ...]) -> F64 | None:
    if rows is None:
        return None
    missing = np.full(shape[1:], np.nan)
    values = np.array([missing if row is None else row for row in rows], np.float64)
    if values.shape != shape:
        raise ValueError(f"an array of {values.shape} stands where {shape} belongs")
    return values
