"""Rows of frames.csv, cases.csv and the detections of a run that never came to mapping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from core.mapping.rows import Detection, rows_without_model
from core.report.columns import column_names
from core.report.record import RunRecord, TaskRecord
from core.states import TaskState
from core.task_key import part_of

Row = dict[str, Any]


@dataclass(frozen=True)
class FrameRow:
    """One row of ``frames.csv``; the fields are its columns, in order."""

    index: int
    """Number of the frame, from 0 by time, which names its image and counts in windows; frames registered afterwards
    continue the numbers."""
    source_index: int
    """Decoded frame of the video, from 0."""
    pts: int
    """Presentation time in the stream's time base."""
    time_s: float
    """Seconds from the first frame of the video, by its presentation time."""
    sha256: str
    """SHA-256 of the decoded RGB24 frame before cropping."""
    role: str
    """Why it takes part: `sampled`, `annotated`, `both`, `neighbour` or `added`."""
    registered: int
    """1 for a frame that is in a model, else 0."""
    model: int | None
    """Number of that model."""


@dataclass(frozen=True)
class CaseRow:
    """One row of ``cases.csv``; the fields are its columns, in order."""

    name: str
    """Name of the case: its segment, first and last frame."""
    kind: str
    """`coarse` or `refine`."""
    start: int
    """First frame of its window."""
    end: int
    """Frame behind the last one of its window."""
    status: str
    """`succeeded`, `no_model` or `failed`."""
    reason: str | None
    """Why it did not succeed, as a code; empty when it did."""
    frames: int
    """Frames of its window."""
    models: int
    """Models found, of which the best stands for the case."""
    registered_images: int
    """Registered images of the best model."""
    points3D: int  # noqa: N815 - the contract's column
    """Points of the best model."""
    mean_reprojection_error_px: float | None
    """Mean reprojection error of the best model, in pixels."""
    median_reprojection_error_px: float | None
    """Median reprojection error of the best model, in pixels."""
    seconds: float
    """Time that the case took."""
    start_mode: str | None
    """How the case started: `scratch`, `warm` or `warm_then_scratch`."""
    selected: int
    """1 for the case whose model went on, else 0."""
    vetoed: int
    """1 where a check of severity `error` calls the model wrong: it wins only where `model.veto` is off."""


FRAME_COLUMNS = column_names(FrameRow)
CASE_COLUMNS = column_names(CaseRow)


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
