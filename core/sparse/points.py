"""Points moved to where fixed cameras see them: each for itself, in a twentieth of the time of a bundle adjuster.

Levenberg and Marquardt's method with Cauchy's loss, weighted anew at each step. The lens is any of
`core.geometry.lens.PARAMETERS`, as the vector of `Lens.vector`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.geometry.fisheye import fisheye_radius_and_slope
from core.geometry.lens import lens_of
from core.jit import compiled

if TYPE_CHECKING:
    import pycolmap

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

_fisheye = compiled(fisheye_radius_and_slope)

MAX_STEPS = 25
CONVERGED = 1e-6
"""Steps of a point end when one lowers its cost by less than this share."""
MAX_DAMPING = 1e8
"""Steps that are damped more than so are none."""


@dataclass(frozen=True)
class Observations:
    """What images see of the points of a model; good for as long as its tracks and keypoints stay as they are."""

    point_ids: I64
    """(n,) rising."""
    offsets: I64
    """(n + 1,) first observation of every point."""
    image_ids: I64
    """(f,) rising."""
    image: I64
    """(m,) row of the image of each observation; rising within a point."""
    xy: F64
    """(m, 2) px"""

    @property
    def lengths(self) -> I64:
        """(n,) observations of every point."""
        lengths: I64 = np.diff(self.offsets)
        return lengths

    def first(self, order: I64, wanted: I64) -> I64:
        """Rows of the points in whose turn an image of theirs has fewer than `wanted` of those before them.

        Args:
            order: rows of points, the first choice first.
            wanted: (n,) how many an image needs to do without this point.
        """
        rows: I64 = order[_first(order, self.offsets, self.image, wanted, len(self.image_ids))]
        return rows

    def keep(self, model: pycolmap.Reconstruction, rows: I64) -> None:
        """Delete all other points of the model in place; these observations describe it no longer."""
        for point_id in np.delete(self.point_ids, rows).tolist():
            model.delete_point3D(point_id)


def observe(model: pycolmap.Reconstruction) -> Observations:
    """All observations of a `pycolmap.Reconstruction`."""
    image_ids = sorted(int(i) for i in model.reg_image_ids())
    seen = [model.image(i).get_observation_points2D() for i in image_ids]
    image = np.repeat(np.arange(len(seen)), [len(points) for points in seen])
    point = np.array([p.point3D_id for points in seen for p in points], np.int64)
    xy = np.array([p.xy for points in seen for p in points]).reshape(-1, 2)
    order = np.argsort(point, kind="stable")
    point_ids, counts = np.unique(point, return_counts=True)
    offsets = np.concatenate([[0], np.cumsum(counts)])
    return Observations(point_ids, offsets, np.array(image_ids, np.int64), image[order], xy[order])


def move_points(model: pycolmap.Reconstruction, seen: Observations, loss_px: float) -> F64:
    """Move all points of a model in place; cameras stay.

    Args:
        model: `pycolmap.Reconstruction` whose images share one camera.
        seen: its observations.
        loss_px: scale of Cauchy's loss.

    Returns:
        (n,) mean error of every point in px, in the order of `seen`.
    """
    xyz = _places(model, seen)
    R, t, lens = _cameras(model, seen)
    _move(xyz, seen.offsets, seen.image, seen.xy, R, t, lens, loss_px)
    for point_id, place in zip(seen.point_ids.tolist(), xyz, strict=True):
        model.point3D(point_id).xyz = place
    return _errors(xyz, seen.offsets, seen.image, seen.xy, R, t, lens)


def errors_px(model: pycolmap.Reconstruction, seen: Observations) -> F64:
    """(n,) mean error of every point in px, where it is."""
    return _errors(_places(model, seen), seen.offsets, seen.image, seen.xy, *_cameras(model, seen))


def _places(model: pycolmap.Reconstruction, seen: Observations) -> F64:
    """(n, 3)"""
    return np.array([model.point3D(i).xyz for i in seen.point_ids.tolist()]).reshape(-1, 3)


def _cameras(model: pycolmap.Reconstruction, seen: Observations) -> tuple[F64, F64, F64]:
    """Rotations (f, 3, 3), translations (f, 3) and `Lens.vector`."""
    lens = lens_of(next(iter(model.cameras.values())))
    return *poses_of(model, seen.image_ids.tolist()), lens.vector()


def poses_of(model: pycolmap.Reconstruction, image_ids: Sequence[int]) -> tuple[F64, F64]:
    """cam_from_world of registered images: rotations (f, 3, 3) and translations (f, 3)."""
    poses = [model.image(i).cam_from_world() for i in image_ids]
    R = np.array([pose.rotation.matrix() for pose in poses]).reshape(-1, 3, 3)
    return R, np.array([pose.translation for pose in poses]).reshape(-1, 3)


@compiled
def _first(order: I64, offsets: I64, image: I64, wanted: I64, n_images: int) -> NDArray[np.bool_]:
    counts, taken = np.zeros(n_images, np.int64), np.zeros(len(order), np.bool_)
    for position in range(len(order)):
        point = order[position]
        for k in range(offsets[point], offsets[point + 1]):
            if counts[image[k]] < wanted[point]:
                taken[position] = True
                break
        if taken[position]:
            for k in range(offsets[point], offsets[point + 1]):
                # A track that sees an image twice is one point of it.
                if k == offsets[point] or image[k] != image[k - 1]:
                    counts[image[k]] += 1
    return taken


@compiled
def _project_perspective(x: float, y: float, z: float, R: F64, lens: F64, jacobian: F64) -> tuple[float, float]:
    """As `_project`, of a point in the camera's frame that a perspective lens sees (OpenCV's k1, k2, p1, p2)."""
    # A point in the camera's own plane has no image; the limit keeps the arithmetic finite.
    depth = z if abs(z) > 1e-150 else 1e-150
    a, b = x / depth, y / depth
    k1, k2, p1, p2 = lens[4], lens[5], lens[8], lens[9]
    r2 = a * a + b * b
    radial, slope = 1.0 + r2 * (k1 + r2 * k2), 2.0 * (k1 + 2.0 * k2 * r2)
    bent_a = a * radial + 2.0 * p1 * a * b + p2 * (r2 + 2.0 * a * a)
    bent_b = b * radial + p1 * (r2 + 2.0 * b * b) + 2.0 * p2 * a * b
    aa = radial + a * a * slope + 2.0 * p1 * b + 6.0 * p2 * a
    ab = a * b * slope + 2.0 * p1 * a + 2.0 * p2 * b
    bb = radial + b * b * slope + 6.0 * p1 * b + 2.0 * p2 * a
    for j in range(3):
        da, db = (R[0, j] - a * R[2, j]) / depth, (R[1, j] - b * R[2, j]) / depth
        jacobian[0, j] = lens[0] * (aa * da + ab * db)
        jacobian[1, j] = lens[1] * (ab * da + bb * db)
    return lens[2] + lens[0] * bent_a, lens[3] + lens[1] * bent_b


@compiled
def _project(place: F64, R: F64, t: F64, lens: F64, jacobian: F64) -> tuple[float, float]:
    """Pixel where a camera sees a place (3,); the derivative by the place goes to `jacobian` (2, 3)."""
    x = R[0, 0] * place[0] + R[0, 1] * place[1] + R[0, 2] * place[2] + t[0]
    y = R[1, 0] * place[0] + R[1, 1] * place[1] + R[1, 2] * place[2] + t[1]
    z = R[2, 0] * place[0] + R[2, 1] * place[1] + R[2, 2] * place[2] + t[2]
    if lens[10] == 1.0:
        return _project_perspective(x, y, z, R, lens, jacobian)
    # On the axis the direction from it is any; the limit is that of a very small radius.
    radius = max(np.sqrt(x * x + y * y), 1e-9 * abs(z), 1e-150)
    theta = np.arctan2(radius, z)
    bent, slope = _fisheye(theta, lens[4], lens[5], lens[6], lens[7])
    scale = bent / radius
    square = radius * radius + z * z
    # The two ways in which the pixel's distance from the centre changes: by the radius and by the depth.
    by_radius = (slope * z / square - scale) / (radius * radius)
    by_depth = -slope / square
    for j in range(3):
        across = by_radius * (x * R[0, j] + y * R[1, j]) + by_depth * R[2, j]
        jacobian[0, j] = lens[0] * (scale * R[0, j] + x * across)
        jacobian[1, j] = lens[1] * (scale * R[1, j] + y * across)
    return lens[2] + lens[0] * x * scale, lens[3] + lens[1] * y * scale


@compiled
def _cost(place: F64, begin: int, end: int, image: I64, xy: F64, R: F64, t: F64, lens: F64, loss: float) -> float:
    jacobian, total = np.empty((2, 3)), 0.0
    for k in range(begin, end):
        u, v = _project(place, R[image[k]], t[image[k]], lens, jacobian)
        total += loss * loss * np.log1p(((u - xy[k, 0]) ** 2 + (v - xy[k, 1]) ** 2) / (loss * loss))
    return total


@compiled
def _step(A: F64, b: F64, damping: float, out: F64) -> None:
    """Solve (A + damping diag A) x = b, A symmetric (3, 3), by its cofactors; NaN where it cannot be solved."""
    d0, d1, d2 = A[0, 0] * (1.0 + damping), A[1, 1] * (1.0 + damping), A[2, 2] * (1.0 + damping)
    a, c, e = A[0, 1], A[0, 2], A[1, 2]
    c00, c01, c02 = d1 * d2 - e * e, c * e - a * d2, a * e - c * d1
    c11, c12, c22 = d0 * d2 - c * c, a * c - d0 * e, d0 * d1 - a * a
    determinant = d0 * c00 + a * c01 + c * c02
    if determinant == 0.0:
        out[:] = np.nan
        return
    out[0] = (c00 * b[0] + c01 * b[1] + c02 * b[2]) / determinant
    out[1] = (c01 * b[0] + c11 * b[1] + c12 * b[2]) / determinant
    out[2] = (c02 * b[0] + c12 * b[1] + c22 * b[2]) / determinant


@compiled
def _move(xyz: F64, offsets: I64, image: I64, xy: F64, R: F64, t: F64, lens: F64, loss: float) -> None:
    jacobian, normal, side, step = np.empty((2, 3)), np.empty((3, 3)), np.empty(3), np.empty(3)
    for n in range(len(xyz)):
        begin, end = offsets[n], offsets[n + 1]
        place, damping = xyz[n].copy(), 1e-4
        cost = _cost(place, begin, end, image, xy, R, t, lens, loss)
        for _ in range(MAX_STEPS):
            normal[:], side[:] = 0.0, 0.0
            for k in range(begin, end):
                u, v = _project(place, R[image[k]], t[image[k]], lens, jacobian)
                du, dv = u - xy[k, 0], v - xy[k, 1]
                weight = 1.0 / (1.0 + (du * du + dv * dv) / (loss * loss))
                for i in range(3):
                    side[i] -= weight * (jacobian[0, i] * du + jacobian[1, i] * dv)
                    for j in range(3):
                        normal[i, j] += weight * (jacobian[0, i] * jacobian[0, j] + jacobian[1, i] * jacobian[1, j])
            last = cost
            while damping < MAX_DAMPING:
                _step(normal, side, damping, step)
                moved = place + step
                found = _cost(moved, begin, end, image, xy, R, t, lens, loss)
                if found < cost:
                    place, cost, damping = moved, found, 0.1 * damping
                    break
                damping *= 10.0
            if not last - cost > CONVERGED * last:
                break
        xyz[n] = place


@compiled
def _errors(xyz: F64, offsets: I64, image: I64, xy: F64, R: F64, t: F64, lens: F64) -> F64:
    jacobian, errors = np.empty((2, 3)), np.empty(len(xyz))
    for n in range(len(xyz)):
        total = 0.0
        for k in range(offsets[n], offsets[n + 1]):
            u, v = _project(xyz[n], R[image[k]], t[image[k]], lens, jacobian)
            total += np.sqrt((u - xy[k, 0]) ** 2 + (v - xy[k, 1]) ** 2)
        errors[n] = total / max(1, offsets[n + 1] - offsets[n])
    return errors
