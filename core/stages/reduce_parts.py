"""Stage `reduce_parts`: after every case was rejected, the part that the inspection goes on with."""

from __future__ import annotations

from core.errors import NoReconstruction
from core.products.search import NoPartProduct, PassedProduct, RefinedProduct
from core.scene.case import CaseKind
from core.sparse.reduce import candidates_of, reduce_parts
from core.stage import StageTask
from core.stages.choice import keep_winner, with_verified


def run(task: StageTask) -> PassedProduct | NoPartProduct:
    """Rank the parts and keep the winner's model.

    When the checks let none pass this is `NoReconstruction`, or, where another lens is tried next, no best part and
    why.
    """
    parts = candidates_of(task.products, CaseKind.SECTION)
    if task.settings.model.prefer_verified:
        parts = with_verified(task, parts)
    try:
        choice = reduce_parts(task.products.of(RefinedProduct, "reduce_refine"), parts)
    except NoReconstruction as none:
        if not task.args.get("another_lens"):
            raise
        return NoPartProduct(why=none.message)
    keep_winner(task, choice)
    task.report(1, 1, f"{len(parts)} parts ranked")
    return choice
