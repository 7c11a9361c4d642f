"""Stage `reduce_perspective`: after every fisheye case was rejected, whether the perspective one is gone on with."""

from __future__ import annotations

from core.products.search import NoPartProduct, PassedProduct, RefinedProduct
from core.scene.case import CaseKind
from core.sparse.reduce import candidates_of, reduce_perspective
from core.stage import StageTask
from core.stages.choice import keep_winner


def run(task: StageTask) -> PassedProduct:
    """Keep the model of the case that the checks let pass; `NoReconstruction` when there is none."""
    cases = candidates_of(task.products, CaseKind.PERSPECTIVE)
    rejected, none = task.products.of(RefinedProduct, "reduce_refine"), task.products.of(NoPartProduct, "reduce_parts")
    choice = reduce_perspective(rejected, none.why, cases)
    keep_winner(task, choice)
    task.report(1, 1, f"{len(cases)} perspective cases ranked")
    return choice
