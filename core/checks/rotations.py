"""`bent_model`: rotations measured between two images against those of the model.

A model can fit its keypoints well and still be bent: registered count and reprojection error do not see it.
The rotation between two frames is also measured alone, from their matches, before any mapping. Where the
camera path is welded wrongly, all pairs across that place disagree with the model, and only those; so the
disagreement is looked at cut by cut along the sequence and not only over all pairs.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.flags import Flag, Severity, between_frames
from core.viewgraph import PairTable

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

CALIBRATED = 2
"""COLMAP's two-view configuration of a pair whose essential matrix is determined."""

MIN_INLIERS = 50
MIN_PAIRS_AT_CUT = 3
MAX_CUT_DEG = 4.0
MAX_MEDIAN_DEG = 2.0


@dataclass(frozen=True)
class PairRotations:
    """Rotations measured between two images, before any mapping."""

    pairs: I64
    """(m, 2) frame indices, first below second."""
    rotations: F64
    """(m, 3, 3) cam2_from_cam1."""


def measured_rotations(graph: PairTable, min_inliers: int = MIN_INLIERS) -> PairRotations:
    """The well-conditioned pairs of ``graph.npz``: calibrated, with at least `min_inliers` inliers."""
    quaternions = graph.rotation_xyzw
    usable = (graph.config == CALIBRATED) & (np.diff(graph.offsets) >= min_inliers)
    usable &= np.abs(np.linalg.norm(quaternions, axis=1) - 1.0) < 1e-3
    chosen = quaternions[usable]
    rotations = Rotation.from_quat(chosen).as_matrix() if len(chosen) else np.zeros((0, 3, 3))
    return PairRotations(graph.pairs[usable].astype(np.int64), rotations)


@dataclass(frozen=True)
class Disagreement:
    """Angles between measured and modelled rotations of the pairs inside the model."""

    pairs: I64
    """(m, 2) frame indices."""
    angles_deg: F64
    """(m,)"""

    @property
    def median_deg(self) -> float:
        """Over all pairs; 0 without any."""
        return float(np.median(self.angles_deg)) if len(self.angles_deg) else 0.0


def model_rotations(model: pycolmap.Reconstruction) -> tuple[I64, F64]:
    """(n,) registered frames of a model (image_id = index + 1), rising, and their (n, 3, 3) cam_from_world."""
    ids = sorted(model.reg_image_ids())
    rotations = [model.image(image_id).cam_from_world().rotation.matrix() for image_id in ids]
    return np.array([image_id - 1 for image_id in ids], np.int64), np.array(rotations).reshape(-1, 3, 3)


def disagreement(measured: PairRotations, frames: I64, cam_from_world: F64) -> Disagreement:
    """Compare with a model.

    Args:
        measured: see `measured_rotations`.
        frames: (n,) indices of the registered frames, rising.
        cam_from_world: (n, 3, 3) their rotations.
    """
    if not len(frames):
        return Disagreement(np.zeros((0, 2), np.int64), np.zeros(0))
    rows = np.searchsorted(frames, measured.pairs).clip(max=len(frames) - 1)
    inside = (frames[rows] == measured.pairs).all(axis=1)
    first, second = cam_from_world[rows[inside, 0]], cam_from_world[rows[inside, 1]]
    modelled = second @ np.swapaxes(first, 1, 2)
    difference = np.swapaxes(modelled, 1, 2) @ measured.rotations[inside]
    angles = Rotation.from_matrix(difference).magnitude() if inside.any() else np.zeros(0)
    return Disagreement(measured.pairs[inside], np.degrees(angles))


@dataclass(frozen=True)
class Cut:
    """The place of the sequence whose pairs disagree most."""

    frame: int
    """The cut lies between this frame and the next."""
    median_deg: float


def worst_cut(found: Disagreement) -> Cut | None:
    """The cut with the largest median angle over the pairs across it; None when none has enough pairs."""
    worst: Cut | None = None
    for frame in np.unique(found.pairs[:, 0]):
        across = (found.pairs[:, 0] <= frame) & (frame < found.pairs[:, 1])
        if across.sum() >= MIN_PAIRS_AT_CUT:
            median = float(np.median(found.angles_deg[across]))
            if worst is None or median > worst.median_deg:
                worst = Cut(int(frame), median)
    return worst


def check_rotations(found: Disagreement) -> Flag | None:
    """`bent_model` when all pairs together, or those across any one cut, disagree too much."""
    if len(found.pairs) and found.median_deg > MAX_MEDIAN_DEG:
        where = f"{len(found.pairs)} pairs of frames {found.pairs.min()}-{found.pairs.max()}"
        return Flag("bent_model", Severity.ERROR, found.median_deg, MAX_MEDIAN_DEG, where)
    cut = worst_cut(found)
    if cut is not None and cut.median_deg > MAX_CUT_DEG:
        return Flag("bent_model", Severity.ERROR, cut.median_deg, MAX_CUT_DEG, between_frames(cut.frame, cut.frame + 1))
    return None
