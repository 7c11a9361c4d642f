"""Stage `reduce_refine`: the final choice; a refined case replaces the best coarse one only if strictly better."""

from __future__ import annotations

import shutil
from collections.abc import Sequence

from core.json_files import read_json
from core.mapping.rows import Detection
from core.mapping.support import boxes_by_frame, open_model
from core.mapping.verified import verified_detections
from core.roi import Crop
from core.sparse.reduce import Row, case_rows, find_row, reduce_refined
from core.stage import StageResult, StageTask
from core.task_key import key_of


def run(task: StageTask) -> StageResult:
    """Rank the refined cases against the best coarse one and keep the winner's model.

    The winner is known only here, so its model is copied: later stages need no case by name.
    """
    best = find_row(case_rows(task.facts, "coarse"), str(task.facts["reduce_coarse"]["best"]))
    rows = [best, *case_rows(task.facts, "refine")]
    if task.settings.model.prefer_verified:
        rows = _with_verified(task, rows)
    facts = reduce_refined(rows[0], rows[1:], task.settings.model.veto)
    shutil.copytree(task.input(key_of(str(facts["kind"]), part=str(facts["best"]))) / "model", task.out / "model")
    task.report(1, 1, f"{len(rows) - 1} refined cases ranked")
    return StageResult(facts)


def _with_verified(task: StageTask, rows: Sequence[Row]) -> list[Row]:
    """The rows with the detections that each case's model verifies; none without a model."""
    frames = task.input("frames")
    index = {int(row["source_index"]): int(row["index"]) for row in read_json(frames / "frames.json")}
    detections = [Detection.from_json(row) for row in read_json(task.input("annotations") / "detections.json")]
    boxes = boxes_by_frame(detections, (), index, Crop(**read_json(frames / "crop.json")))
    found: list[Row] = []
    for number, row in enumerate(rows):
        task.report(number, len(rows), f"detections of {row['name']}")
        count = 0
        if row["status"] == "succeeded":
            count = verified_detections(
                open_model(task.input(key_of(str(row["kind"]), part=str(row["name"]))) / "model"), boxes
            )
        found.append({**row, "verified_detections": count})
    return found
