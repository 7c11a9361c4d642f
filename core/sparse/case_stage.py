"""What the stages `coarse` and `refine` share: a task in, a model folder and a row of cases.csv out."""

from __future__ import annotations

from collections.abc import Sequence

import cv2  # noqa: F401  (before pycolmap: the other order aborts in PNG writing)
import pycolmap

from core.checks.model import check_model
from core.flags import Flag, Severity, worst
from core.io.sparse import has_model, read_model, write_model
from core.products.search import CaseProduct
from core.scene.case import GRAPHS, CaseKind, CaseStatus
from core.sparse.cases import Case, CaseResult, run_case
from core.stage import StageTask
from core.task_key import key_of
from core.viewgraph import read_graph


def run_case_task(task: StageTask, kind: CaseKind) -> CaseProduct:
    """Map the window of a task; no model is an outcome, not an error."""
    case = Case(
        task.input(*GRAPHS),
        int(task.args["start"]),
        int(task.args["end"]),
        task.settings.mapper,
        task.settings.seed,
        task.threads,
    )

    def progress(registered: int, offered: int) -> None:
        task.report(registered, offered, f"{registered} of {offered} images")

    result = run_case(case, _start_model(task), progress)
    if result.model is not None:
        write_model(task.out, result.model)
    return _product(task, kind, result, case_checks(result, case))


def _start_model(task: StageTask) -> pycolmap.Reconstruction | None:
    """The model named by the plan; None without one, or when that case failed or has no model."""
    name = task.args.get("warm_from")
    folder = task.inputs.get(key_of(CaseKind.COARSE, part=str(name))) if name else None
    return read_model(folder) if folder is not None and has_model(folder) else None


def case_checks(result: CaseResult, case: Case) -> list[Flag]:
    """What speaks against the model of a case, by the same checks as for the final model; none without a model."""
    if result.model is None:
        return []
    table = read_graph(case.graph)
    return check_model(result.model, result.stats, table, result.frames)


def is_rejected(checks: Sequence[Flag]) -> bool:
    """Whether a model is rejected: by a finding of severity `error`."""
    return worst(checks) == Severity.ERROR


def _product(task: StageTask, kind: CaseKind, result: CaseResult, checks: Sequence[Flag]) -> CaseProduct:
    stats = result.stats
    return CaseProduct(
        name=task.args["name"],
        kind=kind,
        start=int(task.args["start"]),
        end=int(task.args["end"]),
        status=CaseStatus.NO_MODEL if result.model is None else CaseStatus.SUCCEEDED,
        reason=result.reason or "",
        frames=result.frames,
        models=result.models,
        registered_images=stats.registered_images,
        points3D=stats.points3D,
        mean_reprojection_error_px=stats.mean_reprojection_error_px,
        median_reprojection_error_px=stats.median_reprojection_error_px,
        start_mode=result.start_mode,
        checks=tuple(checks),
        vetoed=int(is_rejected(checks)),
    )
