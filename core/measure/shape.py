"""Length, width and area of a region of a surface, measured along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from core.measure.patch import SurfacePatch

F64 = NDArray[np.float64]
I64 = NDArray[np.int64]

DIRECTIONS = 16
"""Pairs of border points that are tried as ends of the length: the farthest ones in so many directions."""
MAX_BORDER = 400
"""Points of a border that distances are asked between."""


@dataclass(frozen=True)
class Straight:
    """Extents of a region by straight lines."""

    length: float
    """Largest distance between two points of the border."""
    width: float
    """Extent across that line, within the surface."""
    ends: tuple[int, int]
    """Rows of the border that are the ends of the length."""
    sides: tuple[int, int]
    """Rows of the border that lie farthest to both sides of it."""


@dataclass(frozen=True)
class Region:
    """Where a level over a patch is positive: its largest part that hangs together."""

    patch: SurfacePatch
    level: F64
    """(n,) of the vertices, -inf outside of this part."""
    border: F64
    """(k, 3) points where the level passes through zero, at least three."""
    nearest: I64
    """(k,) vertex of the patch inside the region next to each point of the border."""
    area: float
    straight: Straight

    @property
    def middle(self) -> F64:
        """(3,) mean of the border."""
        centre: F64 = self.border.mean(axis=0)
        return centre

    @property
    def normal(self) -> F64:
        """(3,) mean unit normal of the surface inside."""
        total = self.patch.normals[self.level > 0].sum(axis=0)
        return np.asarray(total / max(float(np.linalg.norm(total)), 1e-300), np.float64)

    @property
    def at_rim(self) -> bool:
        """Whether it reaches to where the patch was cut off, and may go on there."""
        away = np.linalg.norm(self.border - self.patch.place, axis=1)
        return bool((away > 0.93 * self.patch.reach).any())

    def bends(self) -> tuple[float, float]:
        """Lengths along the surface over straight ones, at least 1: of the length, and of the width.

        The end of the length along the surface is looked for from both ends of the straight one (double sweep).
        """
        a, b = self.straight.ends
        ways = self._from(a)
        far = int(ways.argmax())
        length = max(float(ways[b]), float(self._from(far).max()), self.straight.length)
        left, right = self.straight.sides
        across = float(np.linalg.norm(self.border[left] - self.border[right]))
        side = max(float(self._from(left)[right]), across)
        return length / self.straight.length, side / across if across > 0 else 1.0

    def _from(self, row: int) -> F64:
        """(k,) ways along the surface from one point of the border to all; infinite ways count as straight ones.

        A straight distance times how much longer the way between the vertices next to its ends is than straight.
        """
        vertices = self.patch.vertices[self.nearest]
        ways = self.patch.distances(self.nearest[[row]])[0][self.nearest]
        between = np.linalg.norm(vertices - vertices[row], axis=1)
        straight = np.linalg.norm(self.border - self.border[row], axis=1)
        known = np.isfinite(ways) & (between > 0)
        ratio = np.divide(ways, between, out=np.ones_like(between), where=known)
        found: F64 = straight * np.maximum(ratio, 1.0)
        return found


def region_of(patch: SurfacePatch, level: F64) -> Region | None:
    """The largest part of a patch where a level (n,) is positive (NaN = not); None where it is so nowhere."""
    values = np.where(np.isfinite(level), level, -np.inf)
    inside = values > 0
    if not inside.any():
        return None
    values = _largest(patch, values)
    a, b = patch.edges.T
    cut = (values[a] > 0) != (values[b] > 0)
    first, second = a[cut], b[cut]
    swap = values[second] > 0
    inner, outer = np.where(swap, second, first), np.where(swap, first, second)
    # Where the outside was not seen the border is half way.
    share = np.where(np.isfinite(values[outer]), values[inner] / (values[inner] - values[outer]), 0.5)
    border = patch.vertices[inner] + share[:, None] * (patch.vertices[outer] - patch.vertices[inner])
    border, inner = _with_rim(patch, values, border, inner)
    if len(border) < 3:
        return None
    if len(border) > MAX_BORDER:
        kept = np.linspace(0, len(border) - 1, MAX_BORDER).round().astype(int)
        border, inner = border[kept], inner[kept]
    total = patch.normals[values > 0].sum(axis=0)
    normal = total / max(float(np.linalg.norm(total)), 1e-300)
    straight = straight_extents(border, normal)
    return Region(patch, values, border, inner, _area(patch, values), straight)


def _largest(patch: SurfacePatch, values: F64) -> F64:
    """The values of the part with most vertices, -inf in the others."""
    n = len(values)
    a, b = patch.edges.T
    joined = (values[a] > 0) & (values[b] > 0)
    graph = coo_matrix((np.ones(int(joined.sum())), (a[joined], b[joined])), shape=(n, n))
    _, label = connected_components(graph, directed=False)
    own = int(np.bincount(label[values > 0]).argmax())
    return np.where((values > 0) & (label != own), -np.inf, values)


def _with_rim(patch: SurfacePatch, values: F64, border: F64, inner: I64) -> tuple[F64, I64]:
    """The border, with the vertices inside that lie on an open edge of the surface: there the region ends too."""
    pairs = np.sort(np.concatenate([patch.faces[:, [0, 1]], patch.faces[:, [1, 2]], patch.faces[:, [2, 0]]]), axis=1)
    edges, count = np.unique(pairs, axis=0, return_counts=True)
    open_vertices = np.unique(edges[count == 1])
    rim = open_vertices[values[open_vertices] > 0]
    return np.concatenate([border, patch.vertices[rim]]), np.concatenate([inner, rim])


def _area(patch: SurfacePatch, values: F64) -> float:
    """Of the triangles inside, those on the border cut where the level passes through zero."""
    # Finite stand-ins: a face whose outside was not seen counts up to half way.
    least = float(np.abs(values[np.isfinite(values)]).max(initial=1.0))
    corners = np.sort(np.where(np.isfinite(values), values, -least)[patch.faces], axis=1)
    low, middle, high = corners.T
    with np.errstate(divide="ignore", invalid="ignore"):
        one = high**2 / ((high - middle) * (high - low))
        two = 1.0 - low**2 / ((low - middle) * (low - high))
    share = np.where(low > 0, 1.0, np.where(middle > 0, two, np.where(high > 0, one, 0.0)))
    return float((share * patch.areas).sum())


def straight_extents(border: F64, normal: F64) -> Straight:
    """Extents of (k, 3) points by straight lines; `normal` is the (3,) unit normal of the surface there."""
    low, high = _farthest(border)
    along = border[high] - border[low]
    length = float(np.linalg.norm(along))
    across = np.cross(normal, along)
    size = float(np.linalg.norm(across))
    if length == 0 or size < 1e-9 * length:
        return Straight(length, 0.0, (low, high), (low, low))
    offset = border @ (across / size)
    left, right = int(offset.argmin()), int(offset.argmax())
    return Straight(length, float(offset[right] - offset[left]), (low, high), (left, right))


def _farthest(points: F64) -> tuple[int, int]:
    """Rows of the two points farthest apart."""
    squared = (points**2).sum(axis=1)
    between = squared[:, None] + squared[None] - 2.0 * points @ points.T
    low, high = np.unravel_index(int(between.argmax()), between.shape)
    return int(low), int(high)
