"""Stage `confirm`: a winner that went on from another case's model is mapped again from scratch."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pycolmap

from core.checks.model import is_wrong
from core.checks.stats import model_stats
from core.sparse.cases import Case
from core.sparse.confirm import confirmed_or_searched
from core.stage import StageResult, StageTask
from core.viewgraph import read_table


def _veto(case: Case) -> Callable[[Any], bool]:
    table = read_table(case.graph / "graph.npz")
    return lambda model: is_wrong(model, table, case.end - case.start)


def run(task: StageTask) -> StageResult:
    """Write the model to go on with: the searched one as it is when it comes from scratch, or `model.confirm` is off.

    A warm model inherits what was wrong with the one that it started from; one from scratch has nothing to confirm.
    """
    winner = task.facts["reduce_refine"]
    from_scratch = winner["start_mode"] == "scratch"
    model, kept = pycolmap.Reconstruction(task.input("reduce_refine") / "model"), "searched"
    if task.settings.model.confirm and not from_scratch:
        # One thread: with a fixed seed COLMAP's mapper is then repeatable to the last bit.
        case = Case(
            task.input("graph"), int(winner["start"]), int(winner["end"]), task.settings.mapper, task.settings.seed
        )
        model, kept = confirmed_or_searched(
            case,
            model,
            lambda registered, offered: task.report(registered, offered, f"{registered} of {offered}"),
            is_wrong=_veto(case) if task.settings.model.veto else None,
        )
    folder = task.out / "model"
    folder.mkdir()
    model.write_binary(folder)
    stats = model_stats(model)
    return StageResult(
        {
            "name": winner["best"],
            "registered_images": stats.registered_images,
            "points3D": stats.points3D,
            "mean_reprojection_error_px": stats.mean_reprojection_error_px,
            "median_reprojection_error_px": stats.median_reprojection_error_px,
            "start_mode": "scratch" if kept == "confirmed" or from_scratch else winner["start_mode"],
            "kept": kept,
        }
    )
