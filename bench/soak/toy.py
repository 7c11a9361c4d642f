"""Stages without vision for the quick form of the soak: they take a moment and write bytes that follow from input."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from core.graph import TaskSpec
from core.products.contract import Facts, Product, Products
from core.settings import Settings
from core.stage import StageTask
from core.stage_specs import StageSpec
from core.task_key import chunk_key
from store.graph import Graph

_PARTS = 4
_SECONDS = 0.4


@dataclass(frozen=True, kw_only=True)
class SplitProduct(Product):
    """How many parts there are."""

    n: int


@dataclass(frozen=True, kw_only=True)
class JoinProduct(Product):
    """How many parts were joined."""

    parts: int


def _expand(settings: Settings, facts: Mapping[str, Facts]) -> list[TaskSpec]:
    tasks = [TaskSpec("split")]
    if "split" not in facts:
        return tasks
    n = Products(facts).of(SplitProduct, "split").n
    parts = [TaskSpec(chunk_key("part", i), ("split",), {"i": i}, optional=True) for i in range(n)]
    keys = tuple(part.key for part in parts)
    return [*tasks, *parts, TaskSpec("join", ("split", *keys)), TaskSpec("confirm", ("join",))]


def _spec(name: str, product: type[Product] = Product, **more: Any) -> StageSpec:
    return StageSpec(name, 1, f"bench.soak.toy:{name}", product, ("frames.jpeg_quality",), **more)


GRAPH = Graph(
    {
        "split": _spec("split", SplitProduct, reads_video=True),
        "part": _spec("part", fan_out=True, weight=3),
        "join": _spec("join", JoinProduct),
        "confirm": _spec("confirm"),
    },
    _expand,
    serves_from=("join",),
)
"""Fans out and in as the method does; the model of `confirm` is published as ``sparse/``."""


def split(task: StageTask) -> SplitProduct:
    """Name the video by its content."""
    _write(task, hashlib.sha256(task.recordings[0].video.read_bytes()).digest())
    return SplitProduct(n=_PARTS)


def part(task: StageTask) -> Product:
    """One of several that run side by side."""
    _write(task, (task.input("split") / "model/points3D.bin").read_bytes() + bytes([task.args["i"]]))
    return Product()


def join(task: StageTask) -> JoinProduct:
    """All parts that there are; fewer of them give another result."""
    found = task.fan_in("part")
    data = b"".join((folder / "model/points3D.bin").read_bytes() for _, folder in found)
    _write(task, data)
    return JoinProduct(parts=len(found))


def confirm(task: StageTask) -> Product:
    """What is published."""
    _write(task, (task.input("join") / "model/points3D.bin").read_bytes())
    return Product()


def _write(task: StageTask, data: bytes) -> None:
    end = time.monotonic() + _SECONDS
    while (left := end - time.monotonic()) > 0:
        time.sleep(min(0.05, left))
        task.report(_SECONDS - left, _SECONDS)
    folder = task.out / "model"
    folder.mkdir()
    seed = f"{task.key} {task.settings.frames.jpeg_quality} ".encode() + data
    (folder / "points3D.bin").write_bytes(hashlib.sha256(seed).digest() * 2000)
