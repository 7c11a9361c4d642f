"""The verified view graph as arrays, and the part of it that a window sees."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pycolmap

CALIBRATED = 2
"""COLMAP's two-view configuration of a pair that moved past a surface that is not a plane."""


@dataclass(frozen=True)
class ViewGraph:
    """Pairs of frames and their inliers; see ``graph.npz`` in docs/stage-results.md."""

    pairs: npt.NDArray[np.int32]
    """(m, 2) frame indices."""
    config: npt.NDArray[np.uint8]
    """(m,) COLMAP's two-view configuration."""
    angle_deg: npt.NDArray[np.float32]
    """(m,) median triangulation angle."""
    offsets: npt.NDArray[np.int64]
    """(m + 1,) rows of `inliers` that belong to each pair."""
    inliers: npt.NDArray[np.uint32]
    """(total, 2) keypoint indices."""

    @property
    def n_inliers(self) -> npt.NDArray[np.int64]:
        """(m,) inliers of every pair."""
        return np.diff(self.offsets)

    def within(self, start: int, end: int) -> ViewGraph:
        """The pairs whose both frames lie in [start, end)."""
        inside: npt.NDArray[np.bool_] = np.all((self.pairs >= start) & (self.pairs < end), axis=1)
        return self.select(inside)

    def select(self, mask: npt.NDArray[np.bool_]) -> ViewGraph:
        """The pairs where `mask` (m,) is true."""
        rows = np.repeat(mask, self.n_inliers)
        counts = self.n_inliers[mask]
        return ViewGraph(
            self.pairs[mask],
            self.config[mask],
            self.angle_deg[mask],
            np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
            self.inliers[rows],
        )


def read_view_graph(path: Path) -> ViewGraph:
    """Read ``graph.npz``."""
    with np.load(path) as data:
        return ViewGraph(
            data["pairs"], data["config"], data["triangulation_angle_deg"], data["offsets"], data["inliers"]
        )


@dataclass(frozen=True)
class Frames:
    """Names, keypoints and the camera of some frames, read from the database."""

    indices: tuple[int, ...]
    """Frame indices, rising; image_id = index + 1."""
    names: tuple[str, ...]
    keypoints: tuple[npt.NDArray[np.float64], ...]
    """(n, 2) each, crop pixels."""
    camera: Any
    """`pycolmap.Camera`, shared."""


def read_frames(database: Path, start: int, end: int) -> Frames:
    """Frames [start, end) of the database of stage `graph`."""
    with pycolmap.Database.open(database) as source:
        images = sorted(source.read_all_images(), key=lambda image: int(image.image_id))
        images = [image for image in images if start <= image.image_id - 1 < end]
        keypoints = tuple(source.read_keypoints(image.image_id)[:, :2].astype(np.float64) for image in images)
        camera = source.read_all_cameras()[0]
    return Frames(
        tuple(int(image.image_id) - 1 for image in images), tuple(image.name for image in images), keypoints, camera
    )
