"""Stage `reduce_refine`: the choice; a refined case replaces the best coarse one only if strictly better."""

from __future__ import annotations

from core.scene.case import CaseKind
from core.sparse.reduce import candidates_of, find_candidate, reduce_refined
from core.stage import StageResult, StageTask
from core.stages.choice import keep_winner, with_verified


def run(task: StageTask) -> StageResult:
    """Rank the refined cases against the best coarse one and keep the winner's model."""
    best = find_candidate(candidates_of(task.facts, CaseKind.COARSE), str(task.facts["reduce_coarse"]["best"]))
    cases = [best, *candidates_of(task.facts, CaseKind.REFINE)]
    if task.settings.model.prefer_verified:
        cases = with_verified(task, cases)
    facts = reduce_refined(cases[0], cases[1:], task.settings.model.veto)
    keep_winner(task, facts)
    task.report(1, 1, f"{len(cases) - 1} refined cases ranked")
    return StageResult(facts)
