"""The part of the verified view graph that a window sees, and what else of its frames a mapper needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pycolmap

from core.viewgraph import PairTable, open_database


def within(table: PairTable, start: int, end: int) -> PairTable:
    """The verified pairs whose both frames lie in [start, end)."""
    mask = np.all((table.pairs >= start) & (table.pairs < end), axis=1) & table.verified
    counts = table.n_inliers[mask]
    return PairTable(
        table.pairs[mask],
        table.method[mask],
        table.n_matches[mask],
        table.config[mask],
        np.concatenate([[0], np.cumsum(counts)]).astype(np.int64),
        table.inliers[np.repeat(mask, table.n_inliers)],
        table.rotation_xyzw[mask],
        table.translation[mask],
        table.triangulation_angle_deg[mask],
    )


@dataclass(frozen=True)
class Frames:
    """Names, keypoints and the camera of some frames."""

    indices: tuple[int, ...]
    """Frame indices, rising; image_id = index + 1."""
    names: tuple[str, ...]
    keypoints: tuple[npt.NDArray[np.float64], ...]
    """(n, 2) each, crop pixels."""
    camera: pycolmap.Camera
    """`pycolmap.Camera`, shared."""


def read_frames(database: Path, start: int, end: int) -> Frames:
    """Frames [start, end) of the database of stage `graph`."""
    with open_database(database) as source:
        images = sorted(source.read_all_images(), key=lambda image: int(image.image_id))
        images = [image for image in images if start <= image.image_id - 1 < end]
        keypoints = tuple(source.read_keypoints(image.image_id)[:, :2].astype(np.float64) for image in images)
        camera = source.read_all_cameras()[0]
    return Frames(
        tuple(int(image.image_id) - 1 for image in images), tuple(image.name for image in images), keypoints, camera
    )
