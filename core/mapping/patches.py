"""Hits of one detection split into the separate surfaces that its pixels show."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from core.mapping.pixels import Footprint
from core.mapping.surface import Hits

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

STEEPEST_DEG = 80.0
"""Two neighbouring pixels show one surface when it would not be seen at a flatter angle than this between them."""
MIN_COSINE = 0.17
"""A pixel that sees the surface flatter than 80 degrees counts for its area as if it were 80."""


@dataclass(frozen=True)
class Patch:
    """A connected part of the surface under a detection."""

    points: F64
    """(n, 3) hits."""
    weights: F64
    """(n,) area seen by each pixel, summing to one."""
    faces: I64
    """(n,) of the mesh."""
    share: float
    """Of the detection's sampled pixels."""
    distance: float
    """Median along the rays, scene units."""
    cosine: float
    """Median cosine of incidence."""

    @property
    def centroid(self) -> F64:
        """(3,) area centroid."""
        middle: F64 = self.weights @ self.points
        return middle

    @property
    def radius(self) -> float:
        """Of the disc whose points lie as far from its middle, in root mean square, as the patch's do."""
        squared = ((self.points - self.centroid) ** 2).sum(axis=1)
        return float(np.sqrt(2.0 * (self.weights @ squared)))


def split_patches(samples: Footprint, origin: F64, directions: F64, hits: Hits, spacing: float) -> list[Patch]:
    """Patches of one detection, the nearest to the camera first.

    Args:
        samples: the pixels that were cast.
        origin: (3,) projection centre.
        directions: (n, 3) unit rays of the samples.
        hits: where they met the surface; those on the back of a face do not count.
        spacing: of the fused cloud: steps in depth below two of it are no edges.
    """
    good = np.flatnonzero(hits.hit & (hits.cosine > 0))
    if not len(good):
        return []
    first, second = _neighbours(samples.cell[good])
    a, b = good[first], good[second]
    near = np.minimum(hits.distance[a], hits.distance[b])
    lateral = near * np.linalg.norm(directions[a] - directions[b], axis=1)
    step = np.abs(hits.distance[a] - hits.distance[b])
    joined = step <= np.maximum(lateral * np.tan(np.radians(STEEPEST_DEG)), 2.0 * spacing)
    graph = coo_matrix((np.ones(int(joined.sum())), (first[joined], second[joined])), shape=(len(good), len(good)))
    count, label = connected_components(graph, directed=False)
    patches = [_patch(samples, origin, directions, hits, good[label == k]) for k in range(count)]
    return sorted(patches, key=lambda patch: patch.distance)


def _neighbours(cell: I64) -> tuple[I64, I64]:
    """Rows of the pairs of samples that touch in the grid, sideways or vertically."""
    width = int(cell[:, 0].max()) + 2
    code = cell[:, 1] * width + cell[:, 0]
    order = np.argsort(code)
    pairs = []
    for offset in (1, width):
        at = np.searchsorted(code[order], code + offset).clip(max=len(code) - 1)
        touches = code[order[at]] == code + offset
        pairs.append((np.flatnonzero(touches), order[at[touches]]))
    return np.concatenate([pair[0] for pair in pairs]), np.concatenate([pair[1] for pair in pairs])


def _patch(samples: Footprint, origin: F64, directions: F64, hits: Hits, rows: I64) -> Patch:
    distance, cosine = hits.distance[rows], hits.cosine[rows]
    area = distance**2 / np.maximum(cosine, MIN_COSINE)
    return Patch(
        points=origin + distance[:, None] * directions[rows],
        weights=area / area.sum(),
        faces=hits.face[rows],
        share=len(rows) / max(1, samples.offered),
        distance=float(np.median(distance)),
        cosine=float(np.median(cosine)),
    )
