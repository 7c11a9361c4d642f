"""Stage `reduce_refine`: the choice; a refined case replaces the best coarse one only if strictly better."""

from __future__ import annotations

from core.products.search import BestCase, RefinedProduct
from core.scene.case import CaseKind
from core.sparse.reduce import candidates_of, find_candidate, reduce_refined
from core.stage import StageTask
from core.stages.choice import keep_winner, with_verified


def run(task: StageTask) -> RefinedProduct:
    """Rank the refined cases against the best coarse one and keep the winner's model."""
    chosen = task.products.of(BestCase, "reduce_coarse")
    best = find_candidate(candidates_of(task.products, CaseKind.COARSE), chosen.best)
    cases = [best, *candidates_of(task.products, CaseKind.REFINE)]
    if task.settings.model.prefer_verified:
        cases = with_verified(task, cases)
    choice = reduce_refined(cases[0], cases[1:], task.settings.model.veto)
    keep_winner(task, choice)
    task.report(1, 1, f"{len(cases) - 1} refined cases ranked")
    return choice
