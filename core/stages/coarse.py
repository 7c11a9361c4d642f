"""Stage `coarse`: one coarse window."""

from __future__ import annotations

from core.products.search import CaseProduct
from core.scene.case import CaseKind
from core.sparse.case_stage import run_case_task
from core.stage import StageTask


def run(task: StageTask) -> CaseProduct:
    """Map the window; see `core.sparse.cases.run_case`."""
    return run_case_task(task, CaseKind.COARSE)
