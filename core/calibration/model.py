"""A calibrated lens on the picture that it was calibrated on, however its file wrote it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares

from core.errors import BadInput
from core.geometry.boxes import in_box
from core.geometry.lens import Lens, LensModel, check_told, make_lens

F64 = NDArray[np.float64]

CODE = "bad_calibration"
MAX_REFIT_PX = 0.3
"""Largest difference that leaving out the third radial term of a perspective lens may make anywhere in the picture."""
_GRID = 25


@dataclass(frozen=True)
class Calibration:
    """A lens of one of the models that a run can use."""

    model: LensModel
    params: tuple[float, ...]
    """In COLMAP's order, px where lengths; pixel centres at (0.5, 0.5)."""
    size_px: tuple[int, int]
    """Width and height of the picture."""

    @property
    def lens(self) -> Lens:
        """The lens, in the form that all models share."""
        return make_lens(self.model, self.params)

    def options(self) -> dict[str, object]:
        """The options of a run that say the same; the lens is then held."""
        return {
            "camera.model": str(self.model),
            "camera.params": list(self.params),
            "camera.size_px": list(self.size_px),
        }


def calibration_of(lens: Lens, size_px: tuple[int, int], where: str) -> Calibration:
    """The calibration of a lens by the smallest model that has all its terms.

    Raises:
        BadInput: `bad_calibration` for what no lens has.
    """
    if lens.fisheye:
        model = LensModel.OPENCV_FISHEYE
    elif any(lens.radial) or any(lens.tangential):
        model = LensModel.OPENCV
    else:
        model = LensModel.PINHOLE
    params = tuple(lens.params(model))
    try:
        check_told(model, params, size_px)
    except ValueError as error:
        raise BadInput(str(error), code=CODE, where=where) from None
    return Calibration(model, params, size_px)


def without_third_term(lens: Lens, k3: float, size_px: tuple[int, int], where: str) -> Lens:
    """A perspective lens of k1, k2, p1, p2 that shows what one with k3 beside them shows, within `MAX_REFIT_PX`.

    The focal lengths and the four terms are fitted by least squares over the picture (Levenberg and Marquardt).

    Raises:
        BadInput: `bad_calibration` when no such lens comes close.
    """
    reach = 1.05 * np.hypot(max(lens.cx, size_px[0] - lens.cx) / lens.fx, max(lens.cy, size_px[1] - lens.cy) / lens.fy)
    side = np.linspace(-reach, reach, 2 * _GRID + 1)
    tangents = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    seen = _projected(tangents, [lens.fx, lens.fy, *lens.radial[:2], *lens.tangential], k3)
    shown = in_box(seen + np.array([lens.cx, lens.cy]), (0, 0, *size_px))
    tangents, seen = tangents[shown], seen[shown]
    start = np.array([lens.fx, lens.fy, *lens.radial[:2], *lens.tangential])
    found = least_squares(
        lambda x: (_projected(tangents, x, 0.0) - seen).ravel(), start, x_scale=[lens.fx, lens.fy, *[1.0] * 4]
    )
    apart = float(np.linalg.norm(_projected(tangents, found.x, 0.0) - seen, axis=1).max(initial=0.0))
    if not apart <= MAX_REFIT_PX:
        raise BadInput(
            f"the third radial term {k3:g} bends the picture by {apart:.2f} px more than the model OPENCV can; "
            "calibrate without it (CALIB_FIX_K3), or as a fisheye",
            code=CODE,
            where=where,
        )
    fx, fy, k1, k2, p1, p2 = (float(value) for value in found.x)
    return Lens(fx, fy, lens.cx, lens.cy, (k1, k2, 0.0, 0.0), (p1, p2), fisheye=False)


def _projected(tangents: F64, values: F64 | list[float], k3: float) -> F64:
    """(n, 2) px off the principal point of (n, 2) points x / z, y / z; OpenCV's model with k1, k2, p1, p2, k3."""
    fx, fy, k1, k2, p1, p2 = values
    x, y = tangents.T
    r2 = x * x + y * y
    radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2
    u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    return np.column_stack([fx * u, fy * v])
