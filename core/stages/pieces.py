"""Stage `pieces`: further models of the frames that could not be joined to the first."""

from __future__ import annotations

from core.checks.model import is_wrong
from core.io.sparse import read_model, write_model
from core.products.front import FramesProduct
from core.products.search import SubmodelsProduct
from core.scene.case import GRAPHS
from core.sparse.submodels import find_submodels
from core.stage import StageTask
from core.viewgraph import read_graph


def run(task: StageTask) -> SubmodelsProduct:
    """Write ``N/model`` for N = 1, 2, ...: strong models of frames that no earlier one has."""
    graph, n_frames = task.input(*GRAPHS), task.products.of(FramesProduct, "frames").n_frames
    table = read_graph(graph)
    first = read_model(task.input("extend"))
    taken = {int(image_id) - 1 for image_id in first.reg_image_ids()}

    found = find_submodels(
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
        write_model(task.out, model, number)
    return SubmodelsProduct(
        n_pieces=len(found),
        registered_images=tuple(int(model.num_reg_images()) for model in found),
        registered_first=len(taken),
    )
