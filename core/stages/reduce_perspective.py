"""Stage `reduce_perspective`: after every fisheye case was rejected, whether the perspective one is gone on with."""

from __future__ import annotations

from core.scene.case import CaseKind
from core.sparse.reduce import candidates_of, reduce_perspective
from core.stage import StageResult, StageTask
from core.stages.choice import keep_winner


def run(task: StageTask) -> StageResult:
    """Keep the model of the case that the checks let pass; `NoReconstruction` when there is none."""
    cases = candidates_of(task.facts, CaseKind.PERSPECTIVE)
    facts = reduce_perspective(task.facts["reduce_refine"], str(task.facts["reduce_parts"]["why"]), cases)
    keep_winner(task, facts)
    task.report(1, 1, f"{len(cases)} perspective cases ranked")
    return StageResult(facts)
