"""Stage `pieces`: further models of the frames that could not be joined to the first."""

from __future__ import annotations

import pycolmap

from core.checks.model import is_wrong
from core.sparse.pieces import find_pieces
from core.stage import StageResult, StageTask
from core.viewgraph import read_table


def run(task: StageTask) -> StageResult:
    """Write ``N/model`` for N = 1, 2, ...: strong models of frames that no earlier one has."""
    graph, n_frames = task.input("graph"), int(task.facts["frames"]["n_frames"])
    table = read_table(graph / "graph.npz")
    first = pycolmap.Reconstruction(task.input("extend") / "model")
    taken = {int(image_id) - 1 for image_id in first.reg_image_ids()}

    found = find_pieces(
        graph,
        table,
        taken,
        n_frames,
        task.settings.mapper,
        seed=task.settings.seed,
        limit=task.settings.model.further,
        is_wrong=lambda model: is_wrong(model, table, n_frames),
        progress=lambda done, total: task.report(done, total, f"piece {done} of {total}"),
    )
    for number, model in enumerate(found, start=1):
        folder = task.out / str(number) / "model"
        folder.mkdir(parents=True)
        model.write_binary(folder)
    return StageResult(
        {
            "n_pieces": len(found),
            "registered_images": [int(model.num_reg_images()) for model in found],
            "registered_first": len(taken),
        }
    )
