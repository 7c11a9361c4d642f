"""Stage `reduce_coarse`: the best coarse case by the thesis's score."""

from __future__ import annotations

from core.products.search import ChoiceProduct
from core.scene.case import CaseKind
from core.sparse.reduce import candidates_of, reduce_cases
from core.stage import StageTask


def run(task: StageTask) -> ChoiceProduct:
    """Rank the coarse cases; `NoReconstruction` when none has a model."""
    cases = candidates_of(task.products, CaseKind.COARSE)
    task.report(1, 1, f"{len(cases)} cases ranked")
    return reduce_cases(cases, task.settings.model.veto)
