"""The lens models that are used, their parameters in COLMAP's order, and one form for all of them.

A perspective model distorts the point (x / z, y / z), a fisheye model the angle off the axis
(`core.geometry.fisheye`). The models of each kind differ in how many terms of the same polynomial they have, so
`Lens` holds what the largest has and turns into any other. Everything that depends on which model a camera has asks
this module, or COLMAP's camera itself.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput
from core.geometry.fisheye import viewing_angle

F64 = NDArray[np.float64]

MAX_SIDE_PX = 1 << 16
MIN_FOCAL_SHARE, MAX_FOCAL_SHARE = 0.05, 100.0
"""Focal lengths of a told lens, over the longer side of the picture: 0.05 is beyond any fisheye's 360 degrees."""

MAX_ASPECT = 0.03
"""Focal lengths across and down that differ by a larger share are those of pixels that are not square."""

MAX_TANGENT = 20.0
"""A perspective polynomial is followed up to here, 87 degrees off the axis."""


class LensModel(StrEnum):
    """The models that a run can be told to use, by COLMAP's names."""

    OPENCV_FISHEYE = "OPENCV_FISHEYE"
    OPENCV = "OPENCV"
    PINHOLE = "PINHOLE"
    SIMPLE_RADIAL = "SIMPLE_RADIAL"


PERSPECTIVE = LensModel.SIMPLE_RADIAL
"""The perspective lens of a run where nobody said which it is: one radial term, because little may be there to settle
more."""

PARAMETERS: Mapping[str, tuple[str, ...]] = {
    "SIMPLE_PINHOLE": ("f", "cx", "cy"),
    "PINHOLE": ("fx", "fy", "cx", "cy"),
    "SIMPLE_RADIAL": ("f", "cx", "cy", "k1"),
    "RADIAL": ("f", "cx", "cy", "k1", "k2"),
    "OPENCV": ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"),
    "SIMPLE_FISHEYE": ("f", "cx", "cy"),
    "SIMPLE_RADIAL_FISHEYE": ("f", "cx", "cy", "k1"),
    "RADIAL_FISHEYE": ("f", "cx", "cy", "k1", "k2"),
    "OPENCV_FISHEYE": ("fx", "fy", "cx", "cy", "k1", "k2", "k3", "k4"),
}
"""Parameters by the name of COLMAP's model: those above, and the smaller ones that stand in for them meanwhile."""

REDUCED: Mapping[LensModel, tuple[str, ...]] = {
    LensModel.OPENCV_FISHEYE: ("SIMPLE_FISHEYE", "SIMPLE_RADIAL_FISHEYE", "RADIAL_FISHEYE"),
    LensModel.OPENCV: ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL"),
    LensModel.PINHOLE: ("SIMPLE_PINHOLE",),
    LensModel.SIMPLE_RADIAL: ("SIMPLE_PINHOLE", "SIMPLE_RADIAL"),
}
"""What stands in for a model with 0, 1 and 2 radial terms and one focal length, as far as the model has them."""


@dataclass(frozen=True)
class Lens:
    """Any of the models; lengths in px, pixel centres at (0.5, 0.5)."""

    fx: float
    fy: float
    cx: float
    cy: float
    radial: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    """k1 to k4, by powers of the squared angle (fisheye) or of the squared tangent (perspective: k3 and k4 are 0)."""
    tangential: tuple[float, float] = (0.0, 0.0)
    """p1, p2 of OpenCV; 0 for a fisheye."""
    fisheye: bool = True

    @property
    def focal_px(self) -> float:
        """Mean of both focal lengths."""
        return (self.fx + self.fy) / 2.0

    def params(self, model: str) -> list[float]:
        """Parameters in the order of a model of `PARAMETERS`; terms that it lacks are dropped, one focal length is
        the mean of two."""
        values = {"f": self.focal_px, "fx": self.fx, "fy": self.fy, "cx": self.cx, "cy": self.cy}
        values |= {f"k{power}": k for power, k in enumerate(self.radial, start=1)}
        values |= {"p1": self.tangential[0], "p2": self.tangential[1]}
        return [values[name] for name in PARAMETERS[model]]

    def vector(self) -> F64:
        """(11,) fx, fy, cx, cy, k1..k4, p1, p2, and 1 for a perspective lens, for compiled loops."""
        values = (self.fx, self.fy, self.cx, self.cy, *self.radial, *self.tangential, float(not self.fisheye))
        return np.array(values, np.float64)

    def scaled(self, factor: float) -> Lens:
        """The lens of the same picture at `factor` times its size."""
        fx, fy, cx, cy = (factor * value for value in (self.fx, self.fy, self.cx, self.cy))
        return replace(self, fx=fx, fy=fy, cx=cx, cy=cy)

    def cropped(self, x0: float, y0: float) -> Lens:
        """The lens of a part of the picture whose upper left corner was at (x0, y0)."""
        return replace(self, cx=self.cx - x0, cy=self.cy - y0)

    def before_fold(self, in_camera: F64) -> NDArray[np.bool_]:
        """(n,) which of (n, 3) points in the camera's frame a perspective lens maps one to one.

        Beyond the tangent at which its polynomial turns back it would show points again that lie outside its view.
        A fisheye of a plausible model does so behind the camera only, and is not asked.
        """
        limit = self._fold_tangent()
        if self.fisheye or np.isinf(limit):
            return np.ones(len(in_camera), np.bool_)
        return np.asarray(np.hypot(in_camera[:, 0], in_camera[:, 1]) < limit * in_camera[:, 2])

    def angle_at(self, radius: float) -> float | None:
        """Angle off the axis (rad) that is seen at `radius` focal lengths from the principal point.

        None where the polynomial turns back before it gets there. Tangential terms are left out.
        """
        if self.fisheye:
            return viewing_angle(radius, np.array(self.radial))
        tangent = np.linspace(0.0, min(self._fold_tangent(), MAX_TANGENT), 8001)
        reached = tangent * (1.0 + self.radial[0] * tangent**2 + self.radial[1] * tangent**4)
        if reached[-1] < radius:
            return None
        return float(np.arctan(np.interp(radius, reached, tangent)))

    def _fold_tangent(self) -> float:
        """Smallest tangent at which 1 + 3 k1 t^2 + 5 k2 t^4, the slope of the perspective polynomial, is 0."""
        roots = np.roots([5.0 * self.radial[1], 3.0 * self.radial[0], 1.0])
        found = [float(root.real) for root in np.atleast_1d(roots) if abs(root.imag) < 1e-12 and root.real > 0]
        return float(np.sqrt(min(found))) if found else float("inf")


def make_lens(model: str, params: Sequence[float]) -> Lens:
    """The lens of a model of `PARAMETERS` from its parameters in COLMAP's order."""
    value = dict(zip(PARAMETERS[model], (float(param) for param in params), strict=True))
    focal = value.get("f", 0.0)
    return Lens(
        value.get("fx", focal),
        value.get("fy", focal),
        value["cx"],
        value["cy"],
        (value.get("k1", 0.0), value.get("k2", 0.0), value.get("k3", 0.0), value.get("k4", 0.0)),
        (value.get("p1", 0.0), value.get("p2", 0.0)),
        model.endswith("FISHEYE"),
    )


def check_told(model: str, params: Sequence[float], size_px: tuple[int, int]) -> None:
    """`ValueError` for parameters that no lens of a model has: their number, a focal length, a point, the size."""
    names = PARAMETERS[model]
    if len(params) != len(names):
        raise ValueError(f"{model} has the {len(names)} parameters {', '.join(names)}; {len(params)} are given")
    if not np.isfinite(params).all():
        raise ValueError("a parameter of the lens is not a finite number")
    width, height = size_px
    if not (0 < width <= MAX_SIDE_PX and 0 < height <= MAX_SIDE_PX):
        raise ValueError(f"the picture of the calibration has {width}x{height} pixels")
    lens = make_lens(model, params)
    if min(lens.fx, lens.fy) < MIN_FOCAL_SHARE * max(size_px) or max(lens.fx, lens.fy) > MAX_FOCAL_SHARE * max(size_px):
        raise ValueError(
            f"the focal length {lens.fx:g}, {lens.fy:g} px is that of no lens on a picture of {width}x{height}"
        )
    if abs(lens.fx / lens.fy - 1.0) > MAX_ASPECT:
        raise ValueError(
            f"the focal lengths {lens.fx:g} and {lens.fy:g} px differ by more than {MAX_ASPECT:.0%}: the pixels of the "
            "calibration are not square; calibrate on frames as they are shown"
        )
    if not (0 <= lens.cx <= width and 0 <= lens.cy <= height):
        raise ValueError(f"the principal point {lens.cx:g}, {lens.cy:g} lies outside the picture of {width}x{height}")


def scale_to(size_px: tuple[int, int], width: int, height: int) -> float:
    """The one factor from the picture of a calibration to that of a video; `BadInput` names both without one."""
    if size_px[0] * height != size_px[1] * width:
        raise BadInput(
            f"the calibration is of a picture of {size_px[0]}x{size_px[1]} and the video has {width}x{height}, "
            "which is not the same picture at another size",
            code="calibration_size",
            where="camera.size_px",
        )
    return width / size_px[0]


class ColmapCamera(Protocol):
    """What is read of a `pycolmap.Camera`: the settings import this module, and the API loads no vision library."""

    @property
    def model_name(self) -> str:
        """One of `PARAMETERS`."""

    @property
    def params(self) -> Iterable[float]:
        """In COLMAP's order."""


def lens_of(camera: ColmapCamera) -> Lens:
    """The lens of a camera of COLMAP."""
    return make_lens(camera.model_name, [float(value) for value in camera.params])
