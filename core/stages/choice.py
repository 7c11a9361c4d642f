"""What the last reducers share: the detections that each case verifies, and the winner's model."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from dataclasses import replace

from core.io.annotations import read_detections
from core.io.frames import read_crop, read_frames
from core.io.sparse import model_folder, read_model
from core.mapping.support import boxes_by_frame, verified_detections
from core.products.search import ChoiceProduct
from core.sparse.reduce import Candidate
from core.stage import StageTask
from core.task_key import key_of


def keep_winner(task: StageTask, choice: ChoiceProduct) -> None:
    """Copy the model of the case that a reducer chose: later stages need no case by name."""
    winner = task.input(key_of(choice.kind, part=choice.best))
    shutil.copytree(model_folder(winner), model_folder(task.out))


def with_verified(task: StageTask, cases: Sequence[Candidate]) -> list[Candidate]:
    """The cases with the detections that each one's model verifies; none without a model."""
    frames = task.input("frames")
    detections = read_detections(task.input("annotations"))
    boxes = boxes_by_frame(detections, (), read_frames(frames).index_of_source, read_crop(frames))
    found: list[Candidate] = []
    for number, case in enumerate(cases):
        task.report(number, len(cases), f"detections of {case.name}")
        count = 0
        if case.row.succeeded:
            count = verified_detections(read_model(task.input(key_of(case.row.kind, part=case.name))), boxes)
        found.append(replace(case, verified=count))
    return found
