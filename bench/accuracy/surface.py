"""Accuracy, completeness and F1 of a surface against the part of the truth that the clip shows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import open3d as o3d
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.accuracy.truth import Truth
from core.geometry.similarity import Similarity
from core.surface.ply import Mesh

F64 = NDArray[np.float64]
I32 = NDArray[np.int32]
I64 = NDArray[np.int64]

N_SAMPLES = 200_000
REFERENCE_FRAMES = 60
REFERENCE_STEP_PX = 3
REFERENCE_MIN_FRAMES = 2
TAU_SHARES = (0.0025, 0.005, 0.01)


@dataclass(frozen=True)
class TriangleSurface:
    """Triangles ready for rays and distances; kept relative to their middle, because Open3D counts in float32."""

    scene: Any
    origin: F64

    def distances(self, points: F64) -> F64:
        """(n,) distances from (n, 3) points to the surface."""
        return np.asarray(self.scene.compute_distance(_f32(points - self.origin)).numpy(), np.float64)


def triangle_surface(vertices: F64, faces: I32) -> TriangleSurface:
    """Index a triangle mesh with at least one face."""
    origin = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    scene = o3d.t.geometry.RaycastingScene()
    scene.add_triangles(_f32(vertices - origin), o3d.core.Tensor.from_numpy(faces.astype(np.uint32)))
    return TriangleSurface(scene, origin)


def reference_faces(truth: Truth, surface: TriangleSurface) -> NDArray[np.int64]:
    """Faces of the true surface seen by at least 2 of 60 frames spread evenly over the whole clip."""
    x0, y0, x1, y1 = truth.roi
    lens = truth.lens
    # The crop truncates to whole pixels; a pixel's centre lies half a pixel inside.
    xs = np.arange(int(x0 * lens.width), int(x1 * lens.width), REFERENCE_STEP_PX) + 0.5
    ys = np.arange(int(y0 * lens.height), int(y1 * lens.height), REFERENCE_STEP_PX) + 0.5
    grid_x, grid_y = (axis.ravel() for axis in np.meshgrid(xs, ys))
    directions = lens.rays(grid_x, grid_y)
    count = np.zeros(len(truth.faces), np.int64)
    n_views = min(REFERENCE_FRAMES, truth.n_frames)
    for frame in np.unique(np.linspace(0, truth.n_frames - 1, n_views).round().astype(int)):
        rays = np.empty((len(directions), 6), np.float32)
        rays[:, :3] = truth.centers[frame] - surface.origin
        rays[:, 3:] = directions @ truth.rotations[frame].T
        hits = surface.scene.cast_rays(o3d.core.Tensor.from_numpy(rays))["primitive_ids"].numpy()
        count[np.unique(hits[hits != surface.scene.INVALID_ID])] += 1
    return np.flatnonzero(count >= REFERENCE_MIN_FRAMES)


def sample_triangles(vertices: F64, faces: I32, count: int, seed: int) -> F64:
    """(count, 3) points of `drawn_on`."""
    return drawn_on(vertices[faces], count, seed)[1]


def drawn_on(corners: F64, count: int, seed: int) -> tuple[I64, F64]:
    """Area-uniform random points on triangles (square-root map of the unit square).

    Args:
        corners: (m, 3, 3), not all without area.
        count: points to draw.
        seed: of the draw.

    Returns:
        (count,) the triangle that each lies on; (count, 3) the points.
    """
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    rng = np.random.default_rng(seed)
    rows = np.searchsorted(np.cumsum(areas), rng.random(count) * areas.sum(), side="right")
    root, share = np.sqrt(rng.random(count))[:, None], rng.random(count)[:, None]
    a, b, c = (corners[rows, k] for k in range(3))
    return rows, np.asarray((1 - root) * a + root * (1 - share) * b + root * share * c)


@dataclass(frozen=True)
class Reference:
    """The true surface and the samples of its visible part, made once per truth."""

    surface: TriangleSurface
    samples: F64
    visible_faces: int
    chord: float


def make_reference(truth: Truth, seed: int = 0) -> Reference:
    """Index the truth and draw the samples that completeness is measured on."""
    surface = triangle_surface(truth.vertices, truth.faces)
    visible = reference_faces(truth, surface)
    samples = sample_triangles(truth.vertices, truth.faces[visible], N_SAMPLES, seed) if len(visible) else _NONE
    return Reference(surface, samples, len(visible), truth.chord)


_NONE: F64 = np.zeros((0, 3))


def score_surface(result: Mesh, sim3: Similarity, reference: Reference, seed: int = 1) -> dict[str, Any]:
    """Score a mesh, or a cloud (no faces), as it is: distances in mm and precision, recall, F1 per tau."""
    vertices = sim3.apply(result.vertices)
    if not len(vertices):
        return {"n_vertices": 0, "n_faces": 0}
    if len(result.faces):
        to_truth = reference.surface.distances(sample_triangles(vertices, result.faces, N_SAMPLES, seed))
        to_result = triangle_surface(vertices, result.faces).distances(reference.samples)
    else:
        to_truth = reference.surface.distances(vertices)
        to_result = np.asarray(cKDTree(vertices).query(reference.samples)[0], np.float64)
    scores: dict[str, Any] = {"n_vertices": len(vertices), "n_faces": len(result.faces)}
    scores["accuracy_median_mm"] = float(np.median(to_truth))
    scores["accuracy_p95_mm"] = float(np.percentile(to_truth, 95))
    scores["completeness_median_mm"] = float(np.median(to_result)) if len(to_result) else None
    for share in TAU_SHARES:
        tau = share * reference.chord
        precision = float((to_truth < tau).mean())
        recall = float((to_result < tau).mean()) if len(to_result) else 0.0
        total = precision + recall
        scores[f"{share * 100:g}%"] = {
            "tau_mm": tau,
            "precision": precision,
            "recall": recall,
            "f1": 2 * precision * recall / total if total else 0.0,
        }
    return scores


def _f32(points: F64) -> Any:
    return o3d.core.Tensor.from_numpy(np.ascontiguousarray(points, np.float32))
