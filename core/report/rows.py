"""Rows of frames.csv, cases.csv and the detections of a run that never came to mapping."""

from __future__ import annotations

from typing import Any

from core.mapping.rows import Detection, rows_without_model
from core.report.record import RunRecord, TaskRecord
from core.states import TaskState
from core.task_key import part_of

Row = dict[str, Any]

FRAME_COLUMNS = ("index", "source_index", "pts", "time_s", "sha256", "role", "registered", "model")
CASE_COLUMNS = (
    "name",
    "kind",
    "start",
    "end",
    "status",
    "reason",
    "frames",
    "models",
    "registered_images",
    "points3D",
    "mean_reprojection_error_px",
    "median_reprojection_error_px",
    "seconds",
    "start_mode",
    "selected",
    "vetoed",
)


def frame_rows(record: RunRecord) -> list[Row]:
    """Rows of frames.csv; `model` is the model's number, None for a frame that is in none."""
    model_of = dict.fromkeys(record.tables.registered, 0)
    for number, indices in record.tables.registered_further.items():
        model_of |= {index: number for index in indices if index not in model_of}
    rows = []
    for frame in record.tables.frames:
        model = model_of.get(int(frame["index"]))
        row = {name: frame[name] for name in ("index", "source_index", "pts", "time_s", "sha256", "role")}
        rows.append({**row, "registered": int(model is not None), "model": model})
    return rows


def selected_case(record: RunRecord) -> str:
    """Name of the case whose model went on; empty when the search found none."""
    for reducer in ("reduce_refine", "reduce_coarse"):
        facts = record.facts(reducer)
        if facts.get("best"):
            return str(facts["best"])
    return ""


def case_rows(record: RunRecord) -> list[Row]:
    """Rows of cases.csv for all cases that ended, coarse before refined, by name."""
    chosen = selected_case(record)
    ended = [
        task for task in record.of_stage("coarse", "refine") if task.state in (TaskState.SUCCEEDED, TaskState.FAILED)
    ]
    return [_case_row(task, chosen) for task in sorted(ended, key=lambda task: task.key)]


def _case_row(task: TaskRecord, chosen: str) -> Row:
    kind, name = task.stage, part_of(task.key)
    start, end = (int(part) for part in name.split("_")[-2:])
    row: Row = dict.fromkeys(CASE_COLUMNS)
    row.update({"name": name, "kind": kind, "start": start, "end": end, "frames": end - start})
    if task.state == TaskState.FAILED:
        row.update({"status": "failed", "reason": task.reason or "stage_failed", "models": 0})
        row.update({"registered_images": 0, "points3D": 0})
    else:
        row.update({column: task.facts[column] for column in CASE_COLUMNS if column in task.facts})
        row["reason"] = row["reason"] or None
    row["vetoed"] = int(bool(row["vetoed"]))
    row["seconds"] = round(task.seconds, 3)
    row["selected"] = int(name == chosen)
    return row


def detection_rows(record: RunRecord, refused: bool) -> list[Row]:
    """Rows of detections.csv: those of mapping; all unplaced when mapping was not reached or is not to be trusted."""
    if record.tables.mapped_rows is not None and not refused:
        return [dict(row) for row in record.tables.mapped_rows]
    detections = [Detection.from_json(row) for row in record.tables.detections]
    own: dict[int, int] = {}
    if record.settings.mapping.time_rule == "pts":  # average-rate times do not say which frame is a detection's own
        own = {int(frame["source_index"]): int(frame["index"]) for frame in record.tables.frames}
    return [row.to_dict() for row in rows_without_model(detections, own)]
