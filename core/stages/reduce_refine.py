"""Stage `reduce_refine`: the final choice; a refined case replaces the best coarse one only if strictly better."""

from __future__ import annotations

import shutil
from collections.abc import Sequence

from core.io.annotations import read_detections
from core.io.frames import read_crop, read_frames
from core.io.sparse import model_folder, read_model
from core.mapping.support import boxes_by_frame
from core.mapping.verified import verified_detections
from core.scene.case import CaseKind, CaseStatus
from core.sparse.reduce import Row, case_rows, find_row, reduce_refined
from core.stage import StageResult, StageTask
from core.task_key import key_of


def run(task: StageTask) -> StageResult:
    """Rank the refined cases against the best coarse one and keep the winner's model.

    The winner is known only here, so its model is copied: later stages need no case by name.
    """
    best = find_row(case_rows(task.facts, CaseKind.COARSE), str(task.facts["reduce_coarse"]["best"]))
    rows = [best, *case_rows(task.facts, CaseKind.REFINE)]
    if task.settings.model.prefer_verified:
        rows = _with_verified(task, rows)
    facts = reduce_refined(rows[0], rows[1:], task.settings.model.veto)
    winner = task.input(key_of(str(facts["kind"]), part=str(facts["best"])))
    shutil.copytree(model_folder(winner), model_folder(task.out))
    task.report(1, 1, f"{len(rows) - 1} refined cases ranked")
    return StageResult(facts)


def _with_verified(task: StageTask, rows: Sequence[Row]) -> list[Row]:
    """The rows with the detections that each case's model verifies; none without a model."""
    frames = task.input("frames")
    detections = read_detections(task.input("annotations"))
    boxes = boxes_by_frame(detections, (), read_frames(frames).index_of_source, read_crop(frames))
    found: list[Row] = []
    for number, row in enumerate(rows):
        task.report(number, len(rows), f"detections of {row['name']}")
        count = 0
        if row["status"] == CaseStatus.SUCCEEDED:
            model = read_model(task.input(key_of(str(row["kind"]), part=str(row["name"]))))
            count = verified_detections(model, boxes)
        found.append({**row, "verified_detections": count})
    return found
