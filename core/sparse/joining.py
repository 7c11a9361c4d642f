"""Pieces that registration left over, joined to the model through images that both have.

The similarity between two models is fitted on every other shared image and must hold on those left out. A joined model
that the checks reject, or that is not better supported than its parts, is not used.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import pycolmap
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from core.checks.stats import model_stats
from core.geometry.similarity import Similarity
from core.settings.groups import MapperSettings
from core.sparse.cases import MIN_MATCHES, Case, run_case
from core.sparse.densify import densify, transfer_poses
from core.sparse.mapper import mapper_options, open_cache
from core.sparse.submodels import groups_of
from core.sparse.tracks import build_tracks
from core.sparse.view_graph import read_frames
from core.viewgraph import PairTable, database_of

F64 = NDArray[np.float64]

OVERLAP = 12
"""Frames beside a submodel that are mapped with it: those that the model has are shared."""
MIN_SHARED = 6
"""Fewer shared images do not fix a similarity that can be checked on images left out."""
MAX_TURN_DEG = 2.0
"""Largest median angle between the cameras of the two models on the images left out of the alignment, in degrees."""
MAX_SHIFT = 0.05
"""Largest median distance of their centres, as a share of the extent of the shared centres."""
MAX_SCALE = 0.05
"""Largest difference of the scales that two halves of the shared images give, as a share."""

Outcome = Literal["joined", "no_model", "no_shared_images", "disagree", "vetoed", "not_better"]

_NO_MODEL: Outcome = "no_model"


@dataclass(frozen=True)
class Attempt:
    """What became of a submodel."""

    first_frame: int
    last_frame: int
    shared: int
    outcome: Outcome

    def to_dict(self) -> dict[str, object]:
        """JSON form."""
        return asdict(self)


@dataclass(frozen=True)
class Poses:
    """Cameras of images that two models share, in one of them."""

    rotations: F64
    """(n, 3, 3) cam_from_world."""
    centers: F64
    """(n, 3)"""

    def rows(self, which: slice) -> Poses:
        """The poses of a slice of the rows."""
        return Poses(self.rotations[which], self.centers[which])


def poses_of(model: pycolmap.Reconstruction, image_ids: Sequence[int]) -> Poses:
    """Of registered images of a `pycolmap.Reconstruction`."""
    images = [model.image(image_id) for image_id in image_ids]
    return Poses(
        np.array([image.cam_from_world().rotation.matrix() for image in images]).reshape(-1, 3, 3),
        np.array([image.projection_center() for image in images]).reshape(-1, 3),
    )


def fit_similarity(first: Poses, second: Poses) -> Similarity:
    """From the same images in two models: rotations averaged without their outliers, then scale and shift.

    Centres alone would leave the turn about a straight path open.
    """
    turns = Rotation.from_matrix(np.swapaxes(first.rotations, 1, 2) @ second.rotations)
    mean = turns.mean()
    for _ in range(3):
        off = (mean.inv() * turns).magnitude()
        mean = turns[np.flatnonzero(off <= 2.0 * np.median(off) + 1e-9)].mean()
    rotation = mean.as_matrix()
    scale = _scale(first.centers, second.centers @ rotation.T)
    return Similarity(scale, rotation, first.centers.mean(axis=0) - scale * (second.centers @ rotation.T).mean(axis=0))


def _scale(first: F64, turned: F64) -> float:
    a, b = first - first.mean(axis=0), turned - turned.mean(axis=0)
    return float((a * b).sum() / max(float((b * b).sum()), 1e-300))


def holds(similarity: Similarity, first: Poses, second: Poses) -> bool:
    """Whether a similarity fits images that it was not fitted on."""
    moved = similarity.apply(second.centers)
    extent = float(np.linalg.norm(np.ptp(first.centers, axis=0)))
    turned = first.rotations @ similarity.rotation @ np.swapaxes(second.rotations, 1, 2)
    angle = float(np.degrees(np.median(Rotation.from_matrix(turned).magnitude())))
    distance = float(np.median(np.linalg.norm(moved - first.centers, axis=1)))
    own = _scale(first.centers, second.centers @ similarity.rotation.T)
    return (
        similarity.scale > 0
        and angle <= MAX_TURN_DEG
        and distance <= MAX_SHIFT * extent
        and abs(own / similarity.scale - 1.0) <= MAX_SCALE
    )


def join_rest(
    graph: Path,
    model: pycolmap.Reconstruction,
    table: PairTable,
    n_frames: int,
    settings: MapperSettings,
    *,
    seed: int,
    is_wrong: Callable[[pycolmap.Reconstruction], bool],
    threads: int = 1,
) -> tuple[pycolmap.Reconstruction, list[Attempt]]:
    """`model` with every left-over submodel that can be joined to it, and what became of each.

    Args:
        graph: result folder of stage `graph`.
        model: `pycolmap.Reconstruction`, image_id = index + 1; not changed.
        table: pairs of the graph.
        n_frames: frames in the database.
        settings: of the mapper.
        seed: of its random choices.
        is_wrong: rejection by the checks.
        threads: of the bundle adjustment.
    """
    left = np.ones(n_frames, bool)
    left[[int(image_id) - 1 for image_id in model.reg_image_ids()]] = False
    attempts = []
    for group in groups_of(table, left):
        low, high = int(group.min()), int(group.max())
        window = max(0, low - OVERLAP), min(n_frames, high + 1 + OVERLAP)
        submodel = run_case(Case(graph, *window, settings, seed)).model
        shared, outcome = 0, _NO_MODEL
        if submodel is not None:
            model, shared, outcome = _join(graph, model, submodel, table, n_frames, settings, seed, is_wrong, threads)
        attempts.append(Attempt(low, high, shared, outcome))
    return model, attempts


def _join(
    graph: Path,
    model: pycolmap.Reconstruction,
    submodel: pycolmap.Reconstruction,
    table: PairTable,
    n_frames: int,
    settings: MapperSettings,
    seed: int,
    is_wrong: Callable[[pycolmap.Reconstruction], bool],
    threads: int,
) -> tuple[pycolmap.Reconstruction, int, Outcome]:
    shared = sorted(set(model.reg_image_ids()) & set(submodel.reg_image_ids()))
    if len(shared) < MIN_SHARED:
        return model, len(shared), "no_shared_images"
    first, second = poses_of(model, shared), poses_of(submodel, shared)
    even, odd = slice(0, None, 2), slice(1, None, 2)
    if not holds(fit_similarity(first.rows(even), second.rows(even)), first.rows(odd), second.rows(odd)):
        return model, len(shared), "disagree"
    cache = open_cache(database_of(graph), (), MIN_MATCHES)
    together = _with_poses(cache, model, submodel, fit_similarity(first, second))
    options = mapper_options(settings, threads=threads, seed=seed, tuned=True)
    joined = densify(cache, together, build_tracks(table), read_frames(database_of(graph), 0, n_frames), options)
    adjustment = pycolmap.BundleAdjustmentOptions()
    adjustment.print_summary = False
    adjustment.refine_focal_length = adjustment.refine_extra_params = settings.refine_lens
    adjustment.ceres.solver_options.num_threads = threads
    pycolmap.bundle_adjustment(joined, adjustment)
    stats, parts = model_stats(joined), (model_stats(model), model_stats(submodel))
    better = stats.registered_images > parts[0].registered_images
    better = better and stats.points3D >= max(part.points3D for part in parts)
    if not better:
        return model, len(shared), "not_better"
    return (model, len(shared), "vetoed") if is_wrong(joined) else (joined, len(shared), "joined")


def _with_poses(
    cache: pycolmap.DatabaseCache,
    model: pycolmap.Reconstruction,
    submodel: pycolmap.Reconstruction,
    similarity: Similarity,
) -> pycolmap.Reconstruction:
    """Copy of `model` without points, with the images that only `piece` has put into its frame."""
    together = transfer_poses(cache, model)
    camera_id = next(iter(together.cameras))
    for image_id in sorted(set(submodel.reg_image_ids()) - set(model.reg_image_ids())):
        pose = submodel.image(image_id).cam_from_world()
        rotation = pose.rotation.matrix() @ similarity.rotation.T
        shift = similarity.scale * np.asarray(pose.translation) - rotation @ similarity.shift
        image = together.image(image_id)
        placed = pycolmap.Rigid3d(pycolmap.Rotation3d(rotation), shift)
        together.frame(image.frame_id).set_cam_from_world(camera_id, placed)
        together.register_frame(image.frame_id)
    return together
