"""How right a sparse model of a clip with a reference is, the same for every program."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pycolmap
from numpy.typing import NDArray

from bench.accuracy.align import align, pose_errors
from bench.accuracy.result import read_sparse, registered, source_indices_by_name
from bench.real.clip import Clip, Reference
from core.errors import BadInput
from core.geometry.pose import pose_of

F64 = NDArray[np.float64]

PERCENT = 100.0
Spread = tuple[float, float]
"""Median and 95 %."""


@dataclass(frozen=True)
class Score:
    """What one program made of a clip; None is what cannot be measured."""

    registered: int = 0
    """Frames of the model with the most, or of the headline model."""
    elsewhere: int = 0
    """Further frames in further models."""
    position_percent: Spread | None = None
    """Distance of camera centres to the true ones after a similarity, percent of the path's extent."""
    rotation_deg: Spread | None = None
    focal_percent: float | None = None
    """Mean focal length against the reference's: signed, percent."""
    depth_percent: Spread | None = None
    """Depth of the model's points in its frames, after one scale, against the depth pictures."""


def score_peer(folder: Path, clip: Clip, reference: Reference) -> Score:
    """Score `folder/sparse`, whose images are named by the number of their frame; an empty score without it."""
    if not (folder / "sparse").is_dir():
        return Score()
    model = read_sparse(folder / "sparse")
    names = [str(model.image(key).name) for key in model.reg_image_ids()]
    return _score(model, {name: int(Path(name).stem) for name in names}, 0, clip, reference)


def score_product(folder: Path, clip: Clip, reference: Reference) -> Score:
    """Score a result folder by its headline model; an empty score when it has none."""
    roots = [folder, *sorted((folder / "models").glob("*"))]
    models = [read_sparse(root / "sparse") for root in roots if (root / "sparse").is_dir()]
    if not models:
        return Score()
    headline = models[0]
    frames = {key for model in models for key in _names(model)} - _names(headline)
    return _score(headline, source_indices_by_name(folder / "frames.csv"), len(frames), clip, reference)


def _names(model: pycolmap.Reconstruction) -> set[str]:
    return {str(model.image(key).name) for key in model.reg_image_ids()}


def _score(
    model: pycolmap.Reconstruction, sources: Mapping[str, int], elsewhere: int, clip: Clip, reference: Reference
) -> Score:
    cameras = registered(model, sources)
    if cameras.source_indices and max(cameras.source_indices) >= reference.n_frames:
        text = f"the model has frame {max(cameras.source_indices)}, the clip {reference.n_frames} frames"
        raise BadInput(text, where=clip.name)
    position, rotation = _pose_errors(cameras.source_indices, cameras.centers, cameras.rotations, reference)
    return Score(
        registered=len(cameras.source_indices),
        elsewhere=elsewhere,
        position_percent=position,
        rotation_deg=rotation,
        focal_percent=_focal_error(model, reference),
        depth_percent=_depth_error(model, sources, clip.depths) if clip.depths else None,
    )


def _pose_errors(
    indices: list[int], centers: F64, rotations: F64, reference: Reference
) -> tuple[Spread | None, Spread | None]:
    """Percent of the extent, and degrees, over the frames whose pose is known."""
    if reference.centers is None or reference.rotations is None:
        return None, None
    true_centers, true_rotations = reference.centers[indices], reference.rotations[indices]
    known = np.isfinite(true_centers).all(axis=1)
    sim3 = align(centers[known], true_centers[known])
    if sim3 is None:
        return None, None
    errors = pose_errors(centers[known], rotations[known], true_centers[known], true_rotations[known], sim3)
    # The errors come in the unit of the reference, whatever it is.
    return _spread(errors.position_mm / reference.extent * PERCENT), _spread(errors.rotation_deg)


def _focal_error(model: pycolmap.Reconstruction, reference: Reference) -> float | None:
    if reference.focal_px is None or reference.width_px is None or not model.reg_image_ids():
        return None
    camera = model.camera(model.image(model.reg_image_ids()[0]).camera_id)
    focal_px = camera.mean_focal_length() * reference.width_px / camera.width
    return float((focal_px / reference.focal_px - 1.0) * PERCENT)


def _depth_error(model: pycolmap.Reconstruction, sources: Mapping[str, int], depths: list[Path]) -> Spread | None:
    """Over every observation of every point, at the nearest pixel; the scale is the median ratio of the depths."""
    found, true = [], []
    for key in model.reg_image_ids():
        image = model.image(key)
        picture = cv2.imread(str(depths[sources[image.name]]), cv2.IMREAD_UNCHANGED)
        if picture is None or picture.ndim != 2:
            raise BadInput(f"{depths[sources[image.name]].name} is not a depth picture", where="depths")
        seen = [point for point in image.points2D if point.has_point3D()]
        if not seen:
            continue
        points = np.array([model.point3D(point.point3D_id).xyz for point in seen])
        camera = model.camera(image.camera_id)
        scale = np.array([picture.shape[1] / camera.width, picture.shape[0] / camera.height])
        # Pixel centres are at (0.5, 0.5): the pixel of a place is its whole part.
        x, y = (np.array([point.xy for point in seen]) * scale).astype(int).T
        inside = (x >= 0) & (y >= 0) & (x < picture.shape[1]) & (y < picture.shape[0])
        found.append(pose_of(image).in_camera(points)[inside, 2])
        true.append(picture[y[inside], x[inside]].astype(np.float64))
    if not found:
        return None
    model_depth, true_depth = np.concatenate(found), np.concatenate(true)
    valid = (true_depth > 0) & (model_depth > 0)
    if not valid.any():
        return None
    ratio = model_depth[valid] / true_depth[valid]
    return _spread(np.abs(ratio / np.median(ratio) - 1.0) * PERCENT)


def _spread(values: F64) -> Spread:
    return float(np.median(values)), float(np.percentile(values, 95))
