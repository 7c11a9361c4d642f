"""Stages without vision for the quick form of the soak: they take a moment and write bytes that follow from input."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping
from typing import Any

from core.graph import TaskSpec
from core.settings import Settings
from core.stage import Facts, StageResult, StageTask
from core.stage_specs import StageSpec
from core.task_key import chunk_key
from store.graph import Graph

_PARTS = 4
_SECONDS = 0.4


def _expand(settings: Settings, facts: Mapping[str, Facts]) -> list[TaskSpec]:
    tasks = [TaskSpec("split")]
    if "split" not in facts:
        return tasks
    parts = [TaskSpec(chunk_key("part", i), ("split",), {"i": i}, optional=True) for i in range(facts["split"]["n"])]
    keys = tuple(part.key for part in parts)
    return [*tasks, *parts, TaskSpec("join", ("split", *keys)), TaskSpec("confirm", ("join",))]


def _spec(name: str, **more: Any) -> StageSpec:
    return StageSpec(name, 1, f"bench.soak.toy:{name}", ("frames.jpeg_quality",), **more)


GRAPH = Graph(
    {
        "split": _spec("split", reads_video=True),
        "part": _spec("part", fan_out=True, weight=3),
        "join": _spec("join"),
        "confirm": _spec("confirm"),
    },
    _expand,
    serves_from=("join",),
)
"""Fans out and in as the method does; the model of `confirm` is published as ``sparse/``."""


def split(task: StageTask) -> StageResult:
    """Name the video by its content."""
    return _write(task, hashlib.sha256(task.recordings[0].video.read_bytes()).digest(), {"n": _PARTS})


def part(task: StageTask) -> StageResult:
    """One of several that run side by side."""
    return _write(task, (task.input("split") / "model/points3D.bin").read_bytes() + bytes([task.args["i"]]))


def join(task: StageTask) -> StageResult:
    """All parts that there are; fewer of them give another result."""
    found = task.fan_in("part")
    data = b"".join((folder / "model/points3D.bin").read_bytes() for _, folder in found)
    return _write(task, data, {"parts": len(found)})


def confirm(task: StageTask) -> StageResult:
    """What is published."""
    return _write(task, (task.input("join") / "model/points3D.bin").read_bytes())


def _write(task: StageTask, data: bytes, facts: Facts | None = None) -> StageResult:
    end = time.monotonic() + _SECONDS
    while (left := end - time.monotonic()) > 0:
        time.sleep(min(0.05, left))
        task.report(_SECONDS - left, _SECONDS)
    folder = task.out / "model"
    folder.mkdir()
    seed = f"{task.key} {task.settings.frames.jpeg_quality} ".encode() + data
    (folder / "points3D.bin").write_bytes(hashlib.sha256(seed).digest() * 2000)
    return StageResult(facts or {})
