"""What never moves in the picture: burned-in text, a logo, dirt on the lens.

Keypoints on it say that the camera stands still, and can weld a model together wrongly. A pixel counts as
still when it carries an edge that is the same, in strength and direction, in nearly all frames that differ
from each other. Where that holds for most edges nothing moves at all, and nothing is masked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from core.errors import StageFailed

F32 = NDArray[np.float32]
Flags = NDArray[np.bool_]

MAX_FRAMES = 48
MIN_FRAMES = 6
DIFFERENT = 3.0
"""Frames count once per view: the mean grey level must change by this much from the last that counted."""
EDGE = 12.0
"""Gradient of an edge, grey levels per pixel."""
SAME = 0.35
"""An edge is the same when its gradient is off by less than this share of it,"""
IN_FRAMES = 0.85
"""in at least this share of the frames."""
MOST = 0.5
"""With more of all edges still, the scene itself does not move."""
MAX_SHARE = 0.25
"""Nor is more of the picture masked than this: it would be something else than an overlay."""
REACH_PX = 4
"""Keypoints this near to a still edge see it."""
_STILL = "still.png"


@dataclass(frozen=True)
class StillPixels:
    """Mask of the exported frames."""

    mask: Flags
    """(h, w) True = still."""
    share: float
    """Of the picture."""
    frames: int
    """Different frames that were compared."""


def find_still(paths: Sequence[Path]) -> StillPixels:
    """Find still pixels over exported frames.

    Args:
        paths: of the frames in the order of time; at most `MAX_FRAMES` of them are read, evenly spread.

    Returns:
        An empty mask when there are too few different frames, when nothing moves, or when too much is still.
    """
    if not paths:
        raise StageFailed("there is no frame to look at", where="frames")
    rows = np.linspace(0, len(paths) - 1, min(MAX_FRAMES, len(paths))).round().astype(int)
    images = _different([_grey(paths[row]) for row in rows])
    nothing = np.zeros(images[0].shape, bool)
    if len(images) < MIN_FRAMES:
        return StillPixels(nothing, 0.0, len(images))
    still, textured = still_edges(images)
    if still.sum() > MOST * max(1, int(textured.sum())):
        return StillPixels(nothing, 0.0, len(images))
    size = 2 * REACH_PX + 1
    mask = cv2.dilate(still.astype(np.uint8), cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (size, size))).astype(bool)
    share = float(mask.mean())
    return StillPixels(nothing, 0.0, len(images)) if share > MAX_SHARE else StillPixels(mask, share, len(images))


def still_edges(images: Sequence[F32]) -> tuple[Flags, Flags]:
    """(h, w) pixels whose edge stays the same, and pixels that carry an edge in the middle frame of most.

    Args:
        images: grey frames that differ from each other.
    """
    gx = np.stack([cv2.Scharr(image, cv2.CV_32F, 1, 0) / 32.0 for image in images])
    gy = np.stack([cv2.Scharr(image, cv2.CV_32F, 0, 1) / 32.0 for image in images])
    middle_x, middle_y = np.median(gx, axis=0), np.median(gy, axis=0)
    strength = np.hypot(middle_x, middle_y)
    same = np.hypot(gx - middle_x, gy - middle_y) < SAME * strength
    still = (strength > EDGE) & (same.mean(axis=0) >= IN_FRAMES)
    textured = np.median(np.hypot(gx, gy), axis=0) > EDGE / 2
    return still, textured


def _grey(path: Path) -> F32:
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise StageFailed(f"frame {path.name} cannot be read", where=path.name)
    smooth: F32 = cv2.GaussianBlur(image, (0, 0), 0.8).astype(np.float32)
    return smooth


def _different(images: Sequence[F32]) -> list[F32]:
    """The frames that differ from the one kept before."""
    kept = [images[0]]
    for image in images[1:]:
        if float(np.abs(image - kept[-1]).mean()) >= DIFFERENT:
            kept.append(image)
    return kept


def write_still(folder: Path, mask: Flags) -> None:
    """Write the mask of still pixels into the result of `frames`."""
    write_mask(folder / _STILL, mask)


def read_still(folder: Path) -> Flags:
    """(h, w) mask of still pixels, from the result of `frames`."""
    return read_mask(folder / _STILL)


def write_mask(path: Path, mask: Flags) -> None:
    """Write a mask as PNG, 255 where it is set."""
    done, data = cv2.imencode(".png", mask.astype(np.uint8) * 255)
    if not done:
        raise StageFailed("the mask of still pixels could not be encoded", where=path.name)
    path.write_bytes(bytes(data))


def read_mask(path: Path) -> Flags:
    """Read what `write_mask` wrote."""
    image = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise StageFailed("the mask of still pixels cannot be read", where=path.name)
    return np.asarray(image > 127)
