"""What was seen of every blade: without it, no finding and not looked at would read the same."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.mapping.surface import Surface
from core.row.model import Coverage
from core.row.sample import SurfaceSample
from core.scene.views import Views

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

USABLE_COSINE = 0.5
"""Of the angle between the surface's normal and the way to the camera: 60 degrees."""
LEAST_VIEWS = (2, 3, 5)


def sightings(sample: SurfaceSample, views: Views, surface: Surface) -> NDArray[np.bool_]:
    """(n, f) whether a view has a point in its picture, at a usable angle and with nothing before it.

    Args:
        sample: with normals towards the cameras.
        views: of the model.
        surface: what may hide a point; one that lies within two spacings before it is its own.
    """
    _, inside = views.project(sample.points)
    centers = views.centers
    way = centers[None] - sample.points[:, None]
    way /= np.maximum(np.linalg.norm(way, axis=2, keepdims=True), 1e-300)
    seen: NDArray[np.bool_] = inside & ((way * sample.normals[:, None]).sum(axis=2) > USABLE_COSINE)
    point, view = np.nonzero(seen)
    seen[point, view] = surface.clear(centers[view], sample.points[point], 2.0 * sample.spacing)
    return seen


def coverage_of(seen: NDArray[np.bool_], blade: I64, numbers: dict[int, int]) -> tuple[Coverage, ...]:
    """Coverage by blade, in the order of the numbers.

    Args:
        seen: (n, f) of `sightings`.
        blade: (n,) index of each point's blade.
        numbers: of the blades seen, by index.
    """
    most = max(int((blade == index).sum()) for index in numbers)
    found = []
    for index, number in sorted(numbers.items(), key=lambda item: item[1]):
        own = seen[blade == index]
        counts = own.sum(axis=1)
        by_views = {least: float((counts >= least).mean()) for least in LEAST_VIEWS}
        found.append(Coverage(number, int(own.any(axis=0).sum()), len(own) / most, by_views))
    return tuple(found)


def in_order(seen: NDArray[np.bool_], blade: I64, blades: I64) -> dict[int, int]:
    """Numbers from 1 along the row by index, counted from the end that appears first."""
    middle = []
    for index in blades:
        per_view = seen[blade == index].sum(axis=0)
        middle.append(float((per_view * np.arange(len(per_view))).sum() / max(int(per_view.sum()), 1)))
    backwards = float(np.corrcoef(blades, middle)[0, 1]) < 0 if np.ptp(middle) > 0 else False
    first = int(blades.max() if backwards else blades.min())
    return {int(index): 1 + abs(int(index) - first) for index in blades}
