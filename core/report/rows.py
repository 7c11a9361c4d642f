"""Rows of frames.csv, cases.csv and the detections of a run that never came to mapping."""

from __future__ import annotations

from dataclasses import asdict

from core.products.contract import read_product
from core.products.search import CaseProduct, ReducerProduct
from core.report.record import RunRecord, TaskRecord
from core.scene.case import REDUCERS, CaseKind, CaseRow, CaseStatus
from core.scene.detection import DetectionRow, rows_without_model
from core.scene.frame import FrameRow
from core.states import TaskState
from core.task_key import part_of


def frame_rows(record: RunRecord) -> list[FrameRow]:
    """Rows of frames.csv; `model` is the model's number, None for a frame that is in none."""
    model_of = dict.fromkeys(record.tables.registered, 0)
    for number, indices in record.tables.registered_further.items():
        model_of |= {index: number for index in indices if index not in model_of}
    rows = []
    for frame in record.tables.frames:
        model = model_of.get(frame.index)
        rows.append(FrameRow(**asdict(frame), registered=int(model is not None), model=model))
    return rows


def selected_case(record: RunRecord) -> str:
    """Name of the case whose model went on; empty when the search found none."""
    for reducer in REDUCERS:
        found = record.products.find(ReducerProduct, reducer)
        if found is not None and found.best:
            return found.best
    return ""


def case_rows(record: RunRecord) -> list[CaseRow]:
    """Rows of cases.csv for all cases that ended, coarse before refined, by name."""
    chosen = selected_case(record)
    ended = [task for task in record.of_stage(*CaseKind) if task.state in (TaskState.SUCCEEDED, TaskState.FAILED)]
    return [_case_row(task, chosen) for task in sorted(ended, key=lambda task: task.key)]


def _case_row(task: TaskRecord, chosen: str) -> CaseRow:
    name, selected, seconds = part_of(task.key), part_of(task.key) == chosen, round(task.seconds, 3)
    if task.state != TaskState.FAILED:
        return read_product(CaseProduct, task.facts, task.key).row(seconds=seconds, selected=selected)
    start, end = (int(part) for part in name.split("_")[-2:])
    return CaseRow(
        name=name,
        kind=CaseKind(task.stage),
        start=start,
        end=end,
        status=CaseStatus.FAILED,
        reason=task.reason or "stage_failed",
        frames=end - start,
        models=0,
        registered_images=0,
        points3D=0,
        mean_reprojection_error_px=None,
        median_reprojection_error_px=None,
        seconds=seconds,
        start_mode=None,
        selected=int(selected),
        vetoed=0,
    )


def detection_rows(record: RunRecord, refused: bool) -> list[DetectionRow]:
    """Rows of detections.csv: those of mapping; all unplaced when mapping was not reached or is not to be trusted."""
    if record.tables.mapped_rows is not None and not refused:
        return list(record.tables.mapped_rows)
    # Times by the average rate do not say which frame is a detection's own.
    by_pts = record.settings.mapping.time_rule == "pts"
    return rows_without_model(record.tables.detections, record.tables.frames.index_of_source if by_pts else {})
