"""Stage `reduce_refine`: a refined case replaces the best coarse one only if strictly better."""

from __future__ import annotations

import shutil

from core.sparse.reduce import case_rows, find_row, reduce_refined
from core.stage import StageResult, StageTask


def run(task: StageTask) -> StageResult:
    """Rank the refined cases against the best coarse one and keep the winner's model.

    The winner is known only here, so its model is copied: later stages need no case by name.
    """
    best = find_row(case_rows(task.facts, "coarse"), str(task.facts["reduce_coarse"]["best"]))
    refined = case_rows(task.facts, "refine")
    facts = reduce_refined(best, refined, task.settings.model.veto)
    shutil.copytree(task.input(f"{facts['kind']}/{facts['best']}") / "model", task.out / "model")
    task.report(1, 1, f"{len(refined)} refined cases ranked")
    return StageResult(facts)
