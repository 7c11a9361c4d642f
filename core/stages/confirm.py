"""Stage `confirm`: a winner that went on from another case's model is mapped again from scratch."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from core.checks.model import is_wrong
from core.checks.stats import model_stats
from core.io.sparse import read_model, write_model
from core.products.search import ChoiceProduct, ConfirmProduct
from core.scene.case import GRAPHS, REDUCERS, ConfirmedModel, StartMode
from core.sparse.cases import Case, confirmed_or_searched
from core.stage import StageTask
from core.viewgraph import read_graph

if TYPE_CHECKING:
    import pycolmap


def _rejection(case: Case) -> Callable[[pycolmap.Reconstruction], bool]:
    table = read_graph(case.graph)
    return lambda model: is_wrong(model, table, case.end - case.start)


def run(task: StageTask) -> ConfirmProduct:
    """Write the model to go on with: the searched one as it is when it comes from scratch, or `model.confirm` is off.

    A warm model inherits what was wrong with the one that it started from; one from scratch has nothing to confirm.
    """
    reducer = next(name for name in REDUCERS if task.has(name))
    winner = task.products.of(ChoiceProduct, reducer)
    from_scratch = winner.start_mode == StartMode.SCRATCH
    model, kept = read_model(task.input(reducer)), ConfirmedModel.SEARCHED
    if task.settings.model.confirm and not from_scratch:
        # One thread: with a fixed seed COLMAP's mapper is then repeatable to the last bit.
        case = Case(
            task.input(*GRAPHS),
            winner.start,
            winner.end,
            task.settings.mapper,
            task.settings.seed,
        )
        model, kept = confirmed_or_searched(
            case,
            model,
            lambda registered, offered: task.report(registered, offered, f"{registered} of {offered}"),
            is_wrong=_rejection(case) if task.settings.model.veto else None,
        )
    write_model(task.out, model)
    stats = model_stats(model)
    return ConfirmProduct(
        name=winner.best,
        registered_images=stats.registered_images,
        points3D=stats.points3D,
        mean_reprojection_error_px=stats.mean_reprojection_error_px,
        median_reprojection_error_px=stats.median_reprojection_error_px,
        start_mode=StartMode.SCRATCH if kept == ConfirmedModel.CONFIRMED or from_scratch else winner.start_mode,
        kept=kept,
    )
