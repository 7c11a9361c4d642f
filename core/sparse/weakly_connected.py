"""Weakly connected images of a model, at the ends and single ones: taken off before they are believed.

Frames of a dark stretch, or of another part of the scene, can be registered by a few chance matches. They then sit
anywhere, and what was right before is a part of a model that is wrong as a whole.
"""

from __future__ import annotations

import numpy as np
import pycolmap

from core.checks.joins import WEAK_POINTS, points_across, tracks_of

WEAK_SHARE = 0.05
"""A cut with fewer than this share of the points that reach across a typical cut is weak too."""
MIN_OBSERVATIONS = 20
"""An image that is out of the sequence's order stays when it sees so many of the points that are left."""
TYPICAL_SHARE = 0.5
"""A frame with this share of a typical frame's points stays in any model, however few they are."""


def drop_weak_ends(model: pycolmap.Reconstruction, n_search: int) -> tuple[pycolmap.Reconstruction, list[int]]:
    """The part of a model between weak cuts that has the most images, and the frames taken off.

    Args:
        model: `pycolmap.Reconstruction`, image_id = index + 1; not changed.
        n_search: frames from this on are out of order.

    Returns:
        The model itself when no image is weakly connected, else a copy.
    """
    frames = np.array(sorted(image_id - 1 for image_id in model.reg_image_ids()), np.int64)
    ordered = frames[frames < n_search]
    if len(ordered) < 2:
        return model, []
    # Whether they move or not: while the rotor stands, nothing does.
    across = points_across(tracks_of(model), ordered, 0.0)
    weak = across < max(WEAK_POINTS, WEAK_SHARE * float(np.median(across)))
    parts = np.split(ordered, np.flatnonzero(weak) + 1)
    if len(parts) == 1:
        return model, []
    kept = max(parts, key=len)
    work = pycolmap.Reconstruction(model)
    dropped = sorted(set(ordered.tolist()) - set(kept.tolist()))
    _take_off(work, dropped)
    # What sees only the ends goes with them.
    held = set().union(*(_points_of(work, frame) for frame in kept.tolist()))
    others = frames[frames >= n_search].tolist()
    lost = [frame for frame in others if len(_points_of(work, frame) & held) < MIN_OBSERVATIONS]
    _take_off(work, lost)
    return work, sorted(dropped + lost)


def drop_weak_images(model: pycolmap.Reconstruction) -> tuple[pycolmap.Reconstruction, list[int]]:
    """The model without the frames that see next to none of its points, and these frames.

    In a dark stretch that pairs across it span no cut is weak, and what was registered inside sits anywhere: on a
    rendered scene by 23 to 26 points where others have a thousand, 4 to 9 mm and 15 degrees off.

    Args:
        model: `pycolmap.Reconstruction`, image_id = index + 1; not changed.

    Returns:
        The model itself when no image is weakly connected, else a copy.
    """
    counts = {image_id - 1: model.image(image_id).num_points3D for image_id in sorted(model.reg_image_ids())}
    if not counts:
        return model, []
    typical = float(np.median(list(counts.values())))
    limit = min(max(WEAK_POINTS, WEAK_SHARE * typical), TYPICAL_SHARE * typical)
    weak_images = [frame for frame, count in counts.items() if count < limit]
    if not weak_images:
        return model, []
    work = pycolmap.Reconstruction(model)
    _take_off(work, weak_images)
    return work, weak_images


def _points_of(model: pycolmap.Reconstruction, frame: int) -> set[int]:
    return {point.point3D_id for point in model.image(frame + 1).get_observation_points2D()}


def _take_off(model: pycolmap.Reconstruction, frames: list[int]) -> None:
    for frame in frames:
        model.deregister_frame(model.image(frame + 1).frame_id)
