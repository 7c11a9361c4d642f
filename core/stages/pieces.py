"""Stage `pieces`: further models of the frames that could not be joined to the first."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pycolmap

from core.checks.model import check_model
from core.flags import worst
from core.sparse.mapper import ModelStats, model_stats
from core.sparse.pieces import find_pieces
from core.stage import StageResult, StageTask
from core.viewgraph import read_table


def run(task: StageTask) -> StageResult:
    """Write ``N/model`` for N = 1, 2, ...: strong models of frames that no earlier one has."""
    graph, n_frames = task.input("graph"), int(task.facts["frames"]["n_frames"])
    table = read_table(graph / "graph.npz")
    with np.load(graph / "graph.npz") as arrays:
        pairs = dict(arrays)
    first = pycolmap.Reconstruction(task.input("extend") / "model")
    taken = {int(image_id) - 1 for image_id in first.reg_image_ids()}

    def is_wrong(model: Any) -> bool:
        return worst(check_model(model, model_stats(model), pairs, n_frames)) == "error"

    found = find_pieces(
        graph,
        table,
        taken,
        n_frames,
        task.settings.mapper,
        seed=task.settings.seed,
        limit=task.settings.model.further,
        is_wrong=is_wrong,
        progress=lambda done, total: task.report(done, total, f"piece {done} of {total}"),
    )
    for number, model in enumerate(found, start=1):
        folder = task.out / str(number) / "model"
        folder.mkdir(parents=True)
        model.write_binary(folder)
    (task.out / "pieces.json").write_text(json.dumps([_facts(model_stats(model)) for model in found], indent=1))
    return StageResult(
        {
            "n_pieces": len(found),
            "registered_images": [int(model.num_reg_images()) for model in found],
            "registered_first": len(taken),
        }
    )


def _facts(stats: ModelStats) -> dict[str, float]:
    return {"registered_images": stats.registered_images, "points3D": stats.points3D}
