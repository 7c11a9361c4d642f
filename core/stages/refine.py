"""Stage `refine`: one refined window around the best coarse case."""

from __future__ import annotations

from core.scene.case import CaseKind
from core.sparse.case_stage import run_case_task
from core.stage import StageResult, StageTask


def run(task: StageTask) -> StageResult:
    """Map the window; see `core.sparse.cases.run_case`."""
    return run_case_task(task, CaseKind.REFINE)
