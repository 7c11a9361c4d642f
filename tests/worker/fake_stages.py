"""Stages without vision: they take a moment, write a file, and misbehave when told to.

What a stage shall do beside its work stands in ``control.json`` next to the video, so that it is no part of
a fingerprint: ``{"part/002": {"sleep_s": 1, "die": 9, "raise": "disk", "times": 2, ...}}``. Every start is
noted in ``journal.txt``, every end in the same file.
"""

from __future__ import annotations

import ctypes
import errno
import hashlib
import json
import os
import socket
import subprocess
import sys
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from core.errors import NoReconstruction, StageFailed
from core.graph import TaskSpec
from core.products.contract import Facts, Product, Products
from core.settings import Settings
from core.stage import StageTask
from core.stage_specs import StageSpec
from store.graph import Graph


@dataclass(frozen=True, kw_only=True)
class SplitProduct(Product):
    n: int


@dataclass(frozen=True, kw_only=True)
class PartProduct(Product):
    i: int
    size: int


@dataclass(frozen=True, kw_only=True)
class JoinProduct(Product):
    parts: int
    trim: float


@dataclass(frozen=True, kw_only=True)
class LastProduct(Product):
    said: str


def _expand(settings: Settings, facts: Mapping[str, Facts]) -> list[TaskSpec]:
    tasks = [TaskSpec("split")]
    if "split" not in facts:
        return tasks
    n = Products(facts).of(SplitProduct, "split").n
    parts = [TaskSpec(f"part/{i:03d}", ("split",), {"i": i}, optional=True) for i in range(n)]
    keys = tuple(part.key for part in parts)
    return [*tasks, *parts, TaskSpec("join", ("split", *keys)), TaskSpec("last", ("join",))]


def _spec(name: str, product: type[Product], setting: str, **more: Any) -> StageSpec:
    return StageSpec(name, 1, f"tests.worker.fake_stages:{name}", product, (setting,), **more)


GRAPH = Graph(
    {
        "split": _spec("split", SplitProduct, "matching.window", reads_video=True),
        "part": _spec("part", PartProduct, "mapper.min_model_size", fan_out=True, weight=10),
        "join": _spec("join", JoinProduct, "mesh.poisson_trim"),
        "last": _spec("last", LastProduct, "timeline.radius_fraction", reads_annotations=True),
    },
    _expand,
    serves_from=("join",),
)


SMALL = {"matching.window": 2}
"""Options of the tests' runs: two parts, because every task is a process and tests should be quick."""


def split(task: StageTask) -> SplitProduct:
    """How many parts: the setting says."""
    _behave(task)
    (task.out / "video.txt").write_text(hashlib.sha256(task.recordings[0].video.read_bytes()).hexdigest())
    _note(task, "end")
    return SplitProduct(n=task.settings.matching.window)


def part(task: StageTask) -> PartProduct:
    """A folder with some bytes that follow from the input."""
    _behave(task)
    seed = (task.input("split") / "video.txt").read_text() + str(task.args["i"])
    folder = task.out / "model"
    folder.mkdir()
    (folder / "points.bin").write_bytes(hashlib.sha256(seed.encode()).digest() * 4000)
    _note(task, "end")
    return PartProduct(i=task.args["i"], size=task.settings.mapper.min_model_size)


def join(task: StageTask) -> JoinProduct:
    """Hash of all parts that there are."""
    _behave(task)
    digest = hashlib.sha256()
    found = task.fan_in("part")
    for _, folder in found:
        digest.update((folder / "model" / "points.bin").read_bytes())
    (task.out / "joined.txt").write_text(digest.hexdigest())
    _note(task, "end")
    return JoinProduct(parts=len(found), trim=task.settings.mesh.poisson_trim)


def last(task: StageTask) -> LastProduct:
    """What the annotations said, beside the joined hash."""
    _behave(task)
    notes = task.recordings[0].annotations
    said = notes.read_text() if notes else ""
    (task.out / "last.txt").write_text((task.input("join") / "joined.txt").read_text() + said)
    _note(task, "end")
    return LastProduct(said=said)


def _note(task: StageTask, what: str) -> None:
    line = f"{what} {task.key} {os.getpid()} {task.threads}\n".encode()
    descriptor = os.open(task.recordings[0].video.parent / "journal.txt", os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    os.write(descriptor, line)
    os.close(descriptor)


def _behave(task: StageTask) -> None:
    path = task.recordings[0].video.parent / "control.json"
    control = json.loads(path.read_text()) if path.exists() else {}
    wish = {**control.get("all", {}), **control.get(task.key, {})}
    starts = journal(task.recordings[0].video).count(f"start {task.key}")
    _note(task, "start")
    if starts >= wish.get("times", 1000):
        return
    if wish.get("tell"):
        (task.recordings[0].video.parent / "told.json").write_text(json.dumps(_what_a_child_knows()))
    if "reach" in wish:
        (task.recordings[0].video.parent / "reached.txt").write_text(_reach(wish["reach"]))
    if wish.get("helper"):
        helper = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(100)"])
        _note(task, f"helper {helper.pid}")
    _pass_time(task, float(wish.get("sleep_s", 0.0)), bool(wish.get("deaf")))
    if "die" in wish:
        os.kill(os.getpid(), wish["die"])
    if "megabytes" in wish:
        ballast = bytearray(wish["megabytes"] << 20)
        _pass_time(task, 5.0, True)
        del ballast
    if "native_megabytes" in wish:
        ctypes.CDLL("libstdc++.so.6")._Znwm(ctypes.c_size_t(wish["native_megabytes"] << 20))  # operator new
    if "file_megabytes" in wish:
        (task.out / "large").write_bytes(bytes(wish["file_megabytes"] << 20))
    while "burn" in wish:
        pass
    if "reads" in wish:
        getattr(task.settings, wish["reads"])
    errors: dict[str, Exception] = {
        "no_reconstruction": NoReconstruction("nothing moves", code="no_reconstruction"),
        "stage": StageFailed("no surface"),
        "memory": MemoryError(),
        "disk": OSError(errno.ENOSPC, "No space left on device"),
        "library": RuntimeError("the matrix is singular"),
        "bug": ZeroDivisionError("division by zero"),
    }
    if "raise" in wish:
        raise errors[wish["raise"]]


def _reach(port: int) -> str:
    """What becomes of a connection to a port of this machine."""
    try:
        socket.create_connection(("127.0.0.1", port), timeout=5).close()
    except OSError as error:
        return type(error).__name__
    return "connected"


def _what_a_child_knows() -> dict[str, Any]:
    """Everything that this process and its guard were given: environments, also as they began, and the document."""
    frame = sys._getframe()
    while "spec" not in frame.f_locals:
        assert frame.f_back is not None
        frame = frame.f_back
    return {
        "environment": dict(os.environ),
        "document": frame.f_locals["spec"],
        "initial": Path("/proc/self/environ").read_text(),
        "guard": _environment(os.getppid()),
        "arguments": Path(f"/proc/{os.getppid()}/cmdline").read_text(),
    }


def _environment(process: int) -> str:
    """As another process began; of root's processes those with fewer rights read nothing."""
    try:
        return Path(f"/proc/{process}/environ").read_text()
    except PermissionError:
        return "not to be read"


def _pass_time(task: StageTask, seconds: float, deaf: bool) -> None:
    """Sleep; a deaf stage does not look whether it was cancelled, as native code does not."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        time.sleep(min(0.02, left))
        if not deaf:
            task.report(seconds - left, seconds, "sleeping")


def journal(video: Path) -> list[str]:
    """``start KEY`` and ``end KEY`` lines in order."""
    path = video.parent / "journal.txt"
    lines = path.read_text().splitlines() if path.exists() else []
    return [" ".join(line.split()[:2]) for line in lines]
