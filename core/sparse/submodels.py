"""What the final model leaves over: frames that hang together among themselves, mapped as models of their own."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from core.matching.bridges import components_of, is_strong, select
from core.scene.frame import image_name
from core.settings.groups import MapperSettings
from core.sparse.cases import Case, run_case
from core.sparse.mapper import restrict_model
from core.viewgraph import PairTable

if TYPE_CHECKING:
    import pycolmap

MIN_FRAMES = 12
"""A submodel with fewer frames of its own shows too little to stand for itself."""


def find_submodels(
    graph: Path,
    table: PairTable,
    taken: Collection[int],
    n_frames: int,
    settings: MapperSettings,
    *,
    seed: int,
    limit: int,
    is_wrong: Callable[[pycolmap.Reconstruction], bool],
    progress: Callable[[int, int], None],
) -> list[pycolmap.Reconstruction]:
    """Models (`pycolmap.Reconstruction`, image_id = index + 1) of frames outside `taken`, the largest group first.

    Args:
        graph: result folder of stage `graph`.
        table: its pairs.
        taken: frames of the final model.
        n_frames: frames in the database.
        settings: of the mapper.
        seed: of its random choices.
        limit: models, at most.
        is_wrong: rejection by the checks.
        progress: called with groups done and groups in all.
    """
    left = np.array([frame not in taken for frame in range(n_frames)])
    groups = groups_of(table, left)
    models: list[pycolmap.Reconstruction] = []
    for done, group in enumerate(groups):
        progress(done, len(groups))
        if len(models) == limit:
            break
        own = np.flatnonzero(left)
        own = own[np.isin(own, group)]
        if len(own) < MIN_FRAMES:
            continue
        model = run_case(Case(graph, int(own.min()), int(own.max()) + 1, settings, seed)).model
        if model is None:
            continue
        # The window may reach over frames of an earlier model: these stay there.
        model = restrict_model(model, [image_name(int(frame)) for frame in np.flatnonzero(left)])
        if model.num_reg_images() < MIN_FRAMES or is_wrong(model):
            continue
        models.append(model)
        left[[int(image_id) - 1 for image_id in model.reg_image_ids()]] = False
    return models


def groups_of(table: PairTable, left: NDArray[np.bool_]) -> list[NDArray[np.int64]]:
    """Frames that strong pairs join without the help of frames outside `left`, the largest group first."""
    inside = select(table, is_strong(table) & left[table.pairs].all(axis=1))
    labels = components_of(inside, len(left))
    sizes = np.bincount(labels[left], minlength=1)
    order = np.argsort(-sizes, kind="stable")
    return [np.flatnonzero(left & (labels == label)) for label in order if sizes[label] >= MIN_FRAMES]
