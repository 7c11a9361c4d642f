"""A calibrated lens on the picture that it was calibrated on, however its file wrote it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from core.errors import BadInput
from core.geometry.boxes import in_box
from core.geometry.fisheye import fisheye_radius
from core.geometry.lens import Lens, LensModel, check_told, make_lens

F64 = NDArray[np.float64]

CODE = "bad_calibration"
MAX_REFIT_PX = 0.5
"""Largest difference in the picture between a perspective lens with a third radial term and one of a model in use."""
_GRID = 101


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


def refitted(lens: Lens, k3: float, size_px: tuple[int, int], where: str) -> Lens:
    """The lens of a model in use that shows what a perspective one with k3 beside its terms shows.

    A fisheye and a perspective lens without k3 are fitted by least squares over the picture (Levenberg and Marquardt),
    and the closer one is taken.

    Raises:
        BadInput: `bad_calibration` when it is more than `MAX_REFIT_PX` off somewhere in the picture, or when the
            given lens turns back within it.
    """
    from scipy.optimize import least_squares  # half a second to load; `api` reads calibrations and seldom fits one

    corner = np.hypot(max(lens.cx, size_px[0] - lens.cx) / lens.fx, max(lens.cy, size_px[1] - lens.cy) / lens.fy)
    # Where the picture of a strong barrel lens ends, the tangents are far larger than the distances in the picture.
    side = np.linspace(-3.0 * corner, 3.0 * corner, _GRID)
    tangents = np.stack(np.meshgrid(side, side), axis=-1).reshape(-1, 2)
    powers = np.array([7.0 * k3, 5.0 * lens.radial[1], 3.0 * lens.radial[0], 1.0])
    folds = [root.real for root in np.roots(powers) if abs(root.imag) < 1e-12 and root.real > 0]
    tangents = tangents[np.hypot(*tangents.T) ** 2 < min(folds, default=np.inf)]
    seen = _perspective(
        tangents, np.array([lens.fx, lens.fy, lens.cx, lens.cy, *lens.radial[:2], *lens.tangential]), k3
    )
    shown = in_box(seen, (0, 0, *size_px))
    tangents, seen = tangents[shown], seen[shown]
    # A lens that turns back within the picture has no tangent for its corners.
    if not len(seen) or np.hypot(*((seen - [lens.cx, lens.cy]) / [lens.fx, lens.fy]).T).max() < 0.9 * corner:
        raise BadInput("the lens turns back within its picture", code=CODE, where=where)
    fits: list[tuple[float, Lens]] = []
    for fisheye, project in ((False, _perspective), (True, _fisheye)):
        start = np.array(
            [lens.fx, lens.fy, lens.cx, lens.cy, *([0.0] * 4 if fisheye else [*lens.radial[:2], *lens.tangential])]
        )
        scale = [lens.fx, lens.fy, lens.fx, lens.fy, 1.0, 1.0, 1.0, 1.0]
        found = least_squares(_apart, start, x_scale=scale, args=(project, tangents, seen))
        apart = float(np.linalg.norm(project(tangents, found.x) - seen, axis=1).max())
        fx, fy, cx, cy, *terms = (float(value) for value in found.x)
        radial, tangential = (terms, [0.0, 0.0]) if fisheye else ([*terms[:2], 0.0, 0.0], terms[2:])
        k1, k2, k3_, k4 = radial
        fits.append((apart, Lens(fx, fy, cx, cy, (k1, k2, k3_, k4), (tangential[0], tangential[1]), fisheye)))
    apart, closest = min(fits, key=lambda fit: fit[0])
    if not apart <= MAX_REFIT_PX:
        raise BadInput(
            f"no lens in use shows what the third radial term {k3:g} does: the closest is {apart:.2f} px off; "
            "calibrate without it (CALIB_FIX_K3), or as a fisheye",
            code=CODE,
            where=where,
        )
    return closest


def _apart(values: F64, project: Callable[[F64, F64], F64], tangents: F64, seen: F64) -> F64:
    """(2n,) differences between where a lens shows points and where they are seen, px."""
    return np.asarray((project(tangents, values) - seen).ravel())


def _perspective(tangents: F64, values: F64, k3: float = 0.0) -> F64:
    """(n, 2) px of (n, 2) points x / z, y / z; fx, fy, cx, cy, k1, k2, p1, p2 and k3 of OpenCV."""
    fx, fy, cx, cy, k1, k2, p1, p2 = values
    x, y = tangents.T
    r2 = x * x + y * y
    radial = 1.0 + k1 * r2 + k2 * r2 * r2 + k3 * r2 * r2 * r2
    u = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    v = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    return np.column_stack([cx + fx * u, cy + fy * v])


def _fisheye(tangents: F64, values: F64) -> F64:
    """(n, 2) px of the same points; fx, fy, cx, cy, k1 to k4 of OpenCV's fisheye."""
    radius = np.hypot(*tangents.T)
    scale = fisheye_radius(np.arctan(radius), values[4:]) / np.maximum(radius, 1e-12)
    scale[radius < 1e-12] = 1.0
    return np.asarray(values[2:4] + values[:2] * tangents * scale[:, None])
