"""Detections of registered frames cast onto the supported surface, and checked by the other views."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from core.geometry.boxes import Box, in_box
from core.mapping.candidates import MIN_SHARE, Candidate, choose, is_depth_consistent
from core.mapping.confidence import Parts
from core.mapping.consensus import ViewConsensus, view_consensus
from core.mapping.depth_consistency import seen_share
from core.mapping.patches import Patch, split_patches
from core.mapping.pixels import Footprint
from core.mapping.scene import Scene, places_nearest
from core.mapping.sigma import place_sigma
from core.mapping.surface import Hits
from core.scene.detection import Reason

F64 = NDArray[np.float64]

AGREE_SPACINGS = 6.0
"""Depths agree within this many point spacings,"""
AGREE_SHARE = 0.02
"""or within this share of the distance."""
MIN_POINTS = 3
"""With fewer points nothing is said about agreement."""


@dataclass(frozen=True)
class Agreement:
    """How many depths were compared with a place, and which share of them agrees with it."""

    share: float | None
    """None with fewer than `MIN_POINTS` depths."""
    count: int


def depth_agreement(distances: F64, expected: float, spacing: float) -> Agreement:
    """Compare the depths of sparse points in a detection's box with that of its patch.

    Points behind the patch are no contradiction where the detection shows two surfaces: only what lies
    before it, or on it, is counted against or for it.

    Args:
        distances: (n,) from the camera, scene units, of the sparse points in the box.
        expected: of the patch.
        spacing: of the fused cloud.
    """
    tolerance = max(AGREE_SPACINGS * spacing, AGREE_SHARE * expected)
    counted = distances[distances < expected + tolerance]
    if len(counted) < MIN_POINTS:
        return Agreement(None, len(counted))
    return Agreement(float((np.abs(counted - expected) <= tolerance).mean()), len(counted))


I64 = NDArray[np.int64]

MIN_VISIBLE = 5
"""Fewer views that could see a place do not contradict it."""
MAX_CHANCE = 0.01
"""A place is contradicted when so many misses in a row, of this detector at other places, have less chance."""


@dataclass(frozen=True)
class RayBundle:
    """A detection as a view sees it. The view need not be registered: its pose may be an estimate."""

    detection: int
    """Row of the caller's list."""
    label: str
    score: float | None
    box_px: Box
    samples: Footprint
    origin: F64
    """(3,) projection centre."""
    R: F64
    """(3, 3) cam_from_world."""
    view: int | None
    """Row of the registered view with this pose; None = an estimate."""
    frame: int
    """Index of the frame, or of the registered one nearest in time: depth maps near it are asked."""


@dataclass(frozen=True)
class Cast:
    """Where a ray bundle meets the surface."""

    place: F64
    """(3,) point of the mesh."""
    normal: F64
    patch: Patch
    parts: Parts
    sigma: float
    contradicted: bool
    point_ids: I64
    """Sparse points in the box that lie on the patch."""
    points: F64
    """(n, 3) of them."""


@dataclass(frozen=True)
class Missed:
    """Why a ray bundle has no place on the surface."""

    reason: Reason
    """`OFF_SURFACE`, also where something nearer than any surface is seen; `OCCLUDED` when only the back of the
    surface lies there."""


@dataclass(frozen=True)
class _Sparse:
    """Sparse points in the box of a ray bundle."""

    ids: I64
    """(n,)"""
    points: F64
    """(n, 3)"""
    distance: F64
    """(n,) from the camera."""


def cast_bundles(scene: Scene, bundles: Sequence[RayBundle]) -> list[Cast | Missed]:
    """Place every ray bundle, in order."""
    candidates: list[Candidate] = []
    outcome: list[Cast | Missed] = [Missed(Reason.OFF_SURFACE) for _ in bundles]
    boxed = [_sparse_in_box(scene, bundle) for bundle in bundles]
    for row, bundle in enumerate(bundles):
        found, blocked = _candidates(scene, row, bundle, boxed[row])
        if not found and blocked:
            outcome[row] = Missed(Reason.OCCLUDED)
        candidates += found
    places = places_nearest(scene.surface, [candidate.place for candidate in candidates])
    candidates = [replace(candidate, place=place) for candidate, place in zip(candidates, places, strict=True)]
    consensus = _ask(scene, bundles, candidates)
    chosen = choose(candidates, consensus, maps=len(scene.depth.frames) > 0)
    recall = _recall(consensus, [row for row, _ in chosen.values()])
    for detection, (row, lead) in chosen.items():
        bundle, sparse = bundles[detection], boxed[detection]
        outcome[detection] = _cast(scene, bundle, sparse, candidates[row], consensus, row, lead, recall)
    return outcome


def _candidates(scene: Scene, row: int, bundle: RayBundle, boxed: _Sparse) -> tuple[list[Candidate], bool]:
    """Patches large enough, and whether the pixels meet only the back of the surface.

    No camera sees the back of a solid, so rays go on through backs. But where a thin blade was seen from both sides
    its two sheets can come out as one, turned either way: the first hits count as well, whatever their side, where
    depth maps or sparse points say that this is what was seen.
    """
    rays = scene.views.rays(bundle.samples.xy, bundle.R)
    origins = np.broadcast_to(bundle.origin, rays.shape)
    first = scene.surface.cast(origins, rays)
    front = scene.surface.cast_front(first, origins, rays, 0.5 * scene.spacing)
    found = [_candidate(scene, row, bundle, patch, boxed) for patch in _large(scene, bundle, rays, front)]
    if (first.cosine[first.hit] < 0).any():
        turned = _large(scene, bundle, rays, replace(first, cosine=np.abs(first.cosine)))
        found += filter(is_depth_consistent, (_candidate(scene, row, bundle, patch, boxed) for patch in turned))
    nearest = min((candidate.patch.distance for candidate in found), default=0.0)
    found = [replace(candidate, nearest=candidate.patch.distance == nearest) for candidate in found]
    return found, bool((front.hit & (front.cosine <= 0)).any())


def _large(scene: Scene, bundle: RayBundle, rays: F64, hits: Hits) -> list[Patch]:
    patches = split_patches(bundle.samples, bundle.origin, rays, hits, scene.spacing)
    return [patch for patch in patches if patch.share >= MIN_SHARE]


def _candidate(scene: Scene, row: int, bundle: RayBundle, patch: Patch, boxed: _Sparse) -> Candidate:
    depth = seen_share(scene.depth, bundle.frame, patch.points, scene.spacing)
    sparse = depth_agreement(boxed.distance, patch.distance, scene.spacing).share
    return Candidate(row, patch, patch.centroid, _normal(scene, patch, bundle.origin), False, depth, sparse)


def _normal(scene: Scene, patch: Patch, origin: F64) -> F64:
    """Mean normal towards the camera, whichever way the faces are turned."""
    normals = scene.face_normals[patch.faces]
    side = np.where(((origin - patch.points) * normals).sum(axis=1) < 0, -1.0, 1.0)
    total = (patch.weights * side) @ normals
    length = float(np.linalg.norm(total))
    normal: F64 = total / length if length > 0 else total
    return normal


def _ask(scene: Scene, bundles: Sequence[RayBundle], candidates: Sequence[Candidate]) -> ViewConsensus:
    own = [bundles[c.detection].view for c in candidates]
    return view_consensus(
        np.array([c.place for c in candidates]).reshape(-1, 3),
        np.array([c.normal for c in candidates]).reshape(-1, 3),
        [bundles[c.detection].label for c in candidates],
        [-1 if view is None else view for view in own],
        scene.views,
        scene.frames,
        scene.surface,
        scene.tolerance,
    )


def _recall(consensus: ViewConsensus, rows: Sequence[int]) -> float:
    """How often this detector finds what it could see: over the places that anything at all supports."""
    visible, support = consensus.n_visible[list(rows)], consensus.n_support[list(rows)]
    known = support > 0
    return float(support[known].sum() / visible[known].sum()) if known.any() else 0.0


def _cast(
    scene: Scene,
    bundle: RayBundle,
    boxed: _Sparse,
    candidate: Candidate,
    consensus: ViewConsensus,
    row: int,
    lead: float,
    recall: float,
) -> Cast:
    visible, support = int(consensus.n_visible[row]), int(consensus.n_support[row])
    near = np.abs(boxed.distance - candidate.patch.distance) <= max(2.0 * candidate.patch.radius, scene.tolerance)
    cloud, _ = scene.cloud.query(candidate.place)
    x1, y1, x2, y2 = bundle.box_px
    in_cam = bundle.R @ (candidate.place - bundle.origin)
    parts = Parts(
        visible=visible,
        support=support,
        same_label=int(consensus.same_label[row].sum()),
        share=candidate.patch.share,
        cosine=candidate.patch.cosine,
        lead=lead,
        sparse=candidate.sparse,
        depth=candidate.depth,
        cloud_spacings=float(cloud) / scene.spacing if scene.spacing > 0 else 0.0,
        score=bundle.score,
    )
    pose = None if bundle.view is None else scene.pose_covariance(bundle.view)
    side = (x2 - x1 + y2 - y1) / 2
    return Cast(
        place=candidate.place,
        normal=candidate.normal,
        patch=candidate.patch,
        parts=parts,
        sigma=place_sigma(in_cam, pose, side, bundle.samples.outline, scene.focal_px, scene.spacing),
        contradicted=support == 0 and visible >= MIN_VISIBLE and (1.0 - recall) ** visible < MAX_CHANCE,
        point_ids=boxed.ids[near],
        points=boxed.points[near],
    )


def _sparse_in_box(scene: Scene, bundle: RayBundle) -> _Sparse:
    """None where the pose is an estimate: no point was observed there."""
    if bundle.view is None:
        return _Sparse(np.zeros(0, np.int64), np.zeros((0, 3)), np.zeros(0))
    xy, ids, points = scene.sparse.of(int(scene.views.frame_index[bundle.view]))
    inside = in_box(xy, bundle.box_px)
    distance = np.linalg.norm(points[inside] - bundle.origin, axis=1)
    return _Sparse(ids[inside], points[inside], distance)
