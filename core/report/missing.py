"""What a result with a model lacks, as flags: a torso must not pass for a whole."""

from __future__ import annotations

from core.flags import Flag, Severity
from core.graph import STAGES
from core.report.record import RunRecord, TaskRecord
from core.scene.detection import Outcome
from core.states import RunState, TaskState
from core.task_key import key_of, piece_of

_NAMES = tuple(STAGES)
AFTER_MODEL = frozenset(_NAMES[_NAMES.index("extend") + 1 :])
"""Stages that work on the final model."""


def missing_parts(record: RunRecord) -> list[Flag]:
    """Flags for stages that failed after the model, for a run without a surface, and for one that placed nothing.

    None without a model to trust: such a run is refused, and other flags say why.
    """
    if record.reason == "no_reconstruction" or not record.facts("extend"):
        return []
    flags = [_failed(task) for task in record.tasks if _failed_after_model(record, task)]
    if record.state != RunState.SUCCEEDED and not flags:
        where = ": ".join(filter(None, (record.failed_stage, record.reason or record.state)))
        flags.append(Flag("incomplete", Severity.WARNING, where=where))
    if not record.facts("mesh").get("n_faces"):
        flags.append(Flag("no_surface", Severity.ERROR, where="mesh"))
    return [*flags, *_nothing_placed(record)]


def _failed_after_model(record: RunRecord, task: TaskRecord) -> bool:
    """A further model that never came to be is no loss; one that lost its surface is."""
    after = task.state == TaskState.FAILED and task.stage in AFTER_MODEL
    return after and bool(record.facts(key_of("extend", piece_of(task.key))))


def _failed(task: TaskRecord) -> Flag:
    piece = piece_of(task.key)
    where = f"{task.stage}: {task.reason or 'failed'}"
    return Flag("incomplete", Severity.WARNING, where=f"model {piece}, {where}" if piece else where)


def _nothing_placed(record: RunRecord) -> list[Flag]:
    in_video = sum(row.source_index is not None for row in record.tables.detections)
    placed = sum(row.outcome == Outcome.MAPPED for row in record.tables.mapped_rows or ())
    return (
        [Flag("nothing_mapped", Severity.ERROR, 0.0, 1.0, f"{in_video} detections")] if in_video and not placed else []
    )
