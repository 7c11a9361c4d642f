"""Other views of a place: which could see it, and in which of them something was detected there.

A frame that the detector never saw says nothing; one that it saw without a detection at the place speaks
against it, as far as the detector finds what is there. After the view-consensus rate of MaskClustering
(Yan et al. 2024, arXiv 2401.07745), with boxes instead of masks.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import Box, in_box
from core.mapping.surface import Surface
from core.scene.views import Views

F64 = NDArray[np.float64]
Flags = NDArray[np.bool_]

MARGIN = 0.15
"""Boxes are widened by this share of their sides: they are drawn by hand or by a detector."""
MARGIN_PX = 2.0
RIM_PX = 4.0
"""A place nearer than this to the rim of the frame is not expected to be detected."""
MAX_INCIDENCE_DEG = 75.0
"""A view that sees the surface flatter than this is not expected to show anything on it."""


@dataclass(frozen=True)
class LookedAt:
    """What the detector said of the registered frames that it saw."""

    rows: NDArray[np.int64]
    """(k,) rows of the views with an entry in the annotations, with detections or without."""
    boxes: tuple[F64, ...]
    """Per row, (m, 4) boxes in crop pixels, widened."""
    labels: tuple[tuple[str, ...], ...]
    """Per row, labels of its boxes."""


def looked_at(views: Views, boxes: Mapping[int, Sequence[tuple[Box, str]]]) -> LookedAt:
    """From the boxes (crop pixels) and labels by frame index; an empty sequence = seen, nothing found."""
    rows = [row for row, frame in enumerate(views.frame_index.tolist()) if frame in boxes]
    own = [boxes[int(views.frame_index[row])] for row in rows]
    return LookedAt(
        np.array(rows, np.int64),
        tuple(widened(np.array([box for box, _ in found], np.float64).reshape(-1, 4)) for found in own),
        tuple(tuple(label for _, label in found) for found in own),
    )


def widened(boxes: F64) -> F64:
    """(m, 4) boxes with their margins."""
    extra = MARGIN * (boxes[:, 2:] - boxes[:, :2]) + MARGIN_PX
    return np.hstack([boxes[:, :2] - extra, boxes[:, 2:] + extra])


@dataclass(frozen=True)
class ViewConsensus:
    """Supporting, contradicting and silent views of n places."""

    could_see: Flags
    """(n, k) places by the frames of `LookedAt`."""
    supports: Flags
    """(n, k) could see it, and a box lies there."""
    same_label: Flags
    """(n, k) and one of these boxes has the same label."""

    @property
    def n_visible(self) -> NDArray[np.int64]:
        """(n,) frames that could see each place."""
        return np.asarray(self.could_see.sum(axis=1), np.int64)

    @property
    def n_support(self) -> NDArray[np.int64]:
        """(n,) frames that support each place."""
        return np.asarray(self.supports.sum(axis=1), np.int64)


def could_see(
    places: F64, normals: F64, views: Views, rows: NDArray[np.int64], surface: Surface, tolerance: float
) -> tuple[Flags, F64]:
    """Which of the views `rows` have each place on the frame, face it and are not blocked.

    Args:
        places: (n, 3).
        normals: (n, 3) unit normals of the surface there, towards the camera that saw it.
        views: registered images.
        rows: (k,) rows of `views`.
        surface: what may hide a place.
        tolerance: depth by which the surface may lie before a place, scene units.

    Returns:
        (n, k) flags and (n, k, 2) crop pixels.
    """
    chosen = Views(views.frame_index[rows], views.R[rows], views.t[rows], views.camera)
    xy, seen = chosen.project(places)
    right, lower = views.camera.width - RIM_PX, views.camera.height - RIM_PX
    seen &= in_box(xy, (RIM_PX, RIM_PX, right, lower), border=False)
    towards = chosen.centers[None] - places[:, None]
    cosine = np.einsum("nfi,ni->nf", towards, normals) / np.maximum(np.linalg.norm(towards, axis=2), 1e-300)
    seen &= cosine > np.cos(np.radians(MAX_INCIDENCE_DEG))
    place, view = np.nonzero(seen)
    seen[place, view] = surface.clear(chosen.centers[view], places[place], tolerance)
    return seen, xy


def view_consensus(
    places: F64,
    normals: F64,
    labels: Sequence[str],
    own_rows: Sequence[int],
    views: Views,
    frames: LookedAt,
    surface: Surface,
    tolerance: float,
) -> ViewConsensus:
    """Ask all frames that the detector saw about n places; a place's own frame (`own_rows`) is not asked."""
    seen, xy = could_see(places, normals, views, frames.rows, surface, tolerance)
    seen &= frames.rows[None] != np.asarray(own_rows, np.int64)[:, None]
    supports, same = np.zeros_like(seen), np.zeros_like(seen)
    for k, (boxes, names) in enumerate(zip(frames.boxes, frames.labels, strict=True)):
        asked = np.flatnonzero(seen[:, k])
        if not len(asked) or not len(boxes):
            continue
        at = xy[asked, k][:, None]
        inside = in_box(at, boxes)
        supports[asked, k] = inside.any(axis=1)
        equal = np.array([[name == labels[i] for name in names] for i in asked.tolist()])
        same[asked, k] = (inside & equal).any(axis=1)
    return ViewConsensus(seen, supports, same)
