"""How a video asks to be shown: quarter turns and mirror images from its display matrix, pixels that are not square."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput

_ONE = 1 << 16
"""1.0 in the 16.16 fixed point numbers of the matrix."""


@dataclass(frozen=True)
class Orientation:
    """An exact rearrangement of pixels: swap the axes, then mirror either one."""

    swap_axes: bool = False
    mirror_x: bool = False
    mirror_y: bool = False

    @property
    def rotation_deg(self) -> int:
        """Clockwise turn in [0, 360) that, after the mirror image if `mirrored`, gives the shown frame."""
        if self.swap_axes:
            return 90 if self.mirror_x else 270
        return 180 if self.mirror_y else 0

    @property
    def mirrored(self) -> bool:
        """Whether the shown frame is a mirror image of the coded one (left and right, before turning)."""
        return (self.swap_axes + self.mirror_x + self.mirror_y) % 2 == 1

    @classmethod
    def from_display_matrix(cls, data: bytes) -> Orientation:
        """Read the nine int32 of ISO/IEC 14496-12 (row vector times matrix: x' = a x + c y, y' = b x + d y).

        Raises:
            BadInput: `unsupported_rotation` when the matrix is no quarter turn; turning by other angles
                would resample every pixel.
        """
        a, b, _, c, d, *_ = struct.unpack("=9i", data[:36])
        near = _ONE // 50
        if max(abs(b), abs(c)) < near and min(abs(a), abs(d)) > near:
            return cls(False, a < 0, d < 0)
        if max(abs(a), abs(d)) < near and min(abs(b), abs(c)) > near:
            return cls(True, c < 0, b < 0)
        raise BadInput(
            "the video's rotation flag is not a multiple of 90 degrees", code="unsupported_rotation", where="video"
        )

    def apply(self, image: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """The frame everyone sees, (h, w, 3), contiguous, from the coded frame."""
        if self.swap_axes:
            image = image.transpose(1, 0, 2)
        if self.mirror_x:
            image = image[:, ::-1]
        if self.mirror_y:
            image = image[::-1]
        return np.ascontiguousarray(image)


def square_width(width: int, aspect: Fraction) -> int:
    """Columns of a picture once its pixels are square, as FFmpeg's ``scale=iw*sar:ih`` counts them.

    Args:
        width: columns as coded.
        aspect: width / height of a pixel (sample aspect ratio).
    """
    return max(1, int(width * aspect))
