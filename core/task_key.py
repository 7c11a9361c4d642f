"""Task keys: the names of tasks in a plan, made and read here only.

A key is ``stage``, or ``stage/part`` where many tasks of a stage run side by side. A task that works on a further
model has that model's number behind its stage: ``mesh@1``, ``depth@1/000``.
"""

from __future__ import annotations

from collections.abc import Iterable

_PART_MARK = "/"
_SUBMODEL_MARK = "@"
_FILE_MARK = "__"
"""Stands for the part mark in a file name."""


def key_of(stage: str, submodel: int = 0, part: str = "") -> str:
    """Key of a task: its stage, the number of the model (0 is the run's own), and which of many it is."""
    model = f"{stage}{_SUBMODEL_MARK}{submodel}" if submodel else stage
    return f"{model}{_PART_MARK}{part}" if part else model


def chunk_key(stage: str, number: int, submodel: int = 0) -> str:
    """Key of the task that works on one chunk of frames or views, e.g. ``features/003``."""
    return key_of(stage, submodel, f"{number:03d}")


def stage_of(key: str) -> str:
    """Name of the stage of a task."""
    return _model_and_part(key)[0].split(_SUBMODEL_MARK, 1)[0]


def submodel_of(key: str) -> int:
    """Number of the model that a task works on; 0 is the run's own."""
    return int(_model_and_part(key)[0].partition(_SUBMODEL_MARK)[2] or 0)


def part_of(key: str) -> str:
    """Which of the many tasks of its stage it is, e.g. the name of a case; empty for the only one."""
    return _model_and_part(key)[1]


def parts_of(keys: Iterable[str], stage: str, submodel: int = 0) -> list[str]:
    """Those of `keys` that are one of many tasks of `stage` for a model, sorted."""
    return sorted(key for key in keys if part_of(key) and key_of(stage, submodel) == _model_and_part(key)[0])


def file_stem(key: str) -> str:
    """The key as a file name without suffix, e.g. ``coarse__seg_000_0000_0180``."""
    return key.replace(_PART_MARK, _FILE_MARK)


def key_of_stem(stem: str) -> str:
    """The key that `file_stem` made a file name of."""
    return stem.replace(_FILE_MARK, _PART_MARK)


def _model_and_part(key: str) -> tuple[str, str]:
    model, _, part = key.partition(_PART_MARK)
    return model, part
