"""`python -m worker.child PARENT_PID`: runs one stage in a process group that dies with its parent.

Two processes: a small guard, and the stage forked from it. The kernel tells the guard when the runner dies
(PR_SET_PDEATHSIG), and the guard then kills the whole group, so that helpers of the stage go too; the stage
itself is killed by the kernel when the guard dies. The description of the task comes as JSON on stdin,
progress and the outcome leave as JSON lines on a pipe.
"""

from __future__ import annotations

import ctypes
import importlib
import json
import os
import resource
import signal
import sys
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, NoReturn

from core.errors import BladeAtlasError, DiskFull, ResourceError
from core.settings import Settings, only_declared
from core.stage import StageResult, StageTask
from store.disk import NO_SPACE, disk_is_full
from worker.results import seal

_PR_SET_PDEATHSIG = 1
_PROGRESS_EVERY_S = 0.5


def die_with(parent: int, with_signal: signal.Signals) -> None:
    """Ask the kernel for `with_signal` when the parent dies; leave at once if it is dead already."""
    ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_PDEATHSIG, int(with_signal), 0, 0, 0)
    if os.getppid() != parent:
        os._exit(1)


class Channel:
    """JSON lines to the runner."""

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._sent_at = 0.0

    def send(self, message: dict[str, Any]) -> None:
        """Write one line; a runner that is gone is not this process's problem, it will be killed."""
        data = memoryview((json.dumps(message, allow_nan=False) + "\n").encode())
        with suppress(BrokenPipeError):
            while data:
                data = data[os.write(self._descriptor, data) :]

    def progress(self, fraction: float, message: str) -> None:
        """Report progress, but not more often than anyone can look."""
        now = time.monotonic()
        if now - self._sent_at >= _PROGRESS_EVERY_S:
            self._sent_at = now
            self.send({"progress": min(1.0, max(0.0, fraction)), "message": message})


def main() -> NoReturn:
    """Guard one stage."""
    runner = int(sys.argv[1])
    watched = {signal.SIGTERM, signal.SIGCHLD}
    # Blocked before the kernel is asked: the notice of the runner's death must wait, not kill the guard alone.
    signal.pthread_sigmask(signal.SIG_BLOCK, watched)
    die_with(runner, signal.SIGTERM)
    spec = json.load(sys.stdin)
    channel = Channel(int(spec["channel"]))
    guard = os.getpid()
    stage = os.fork()
    if stage == 0:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, watched)
        _stage_process(spec, channel, guard)
    while True:
        arrived = signal.sigwait(watched)
        if arrived == signal.SIGTERM and os.getppid() != runner:
            os.killpg(0, signal.SIGKILL)
        ended, status = os.waitpid(stage, os.WNOHANG)
        if ended:
            if os.WIFSIGNALED(status):
                channel.send({"signal": os.WTERMSIG(status)})
            os._exit(os.waitstatus_to_exitcode(status) & 0xFF)


def _stage_process(spec: dict[str, Any], channel: Channel, guard: int) -> NoReturn:
    """The forked process that becomes the stage."""
    stopped: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _frame: stopped.append(number))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    die_with(guard, signal.SIGKILL)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    code = 0
    try:
        channel.send({"done": _run(spec, channel, lambda: bool(stopped))})
    except BaseException as error:  # noqa: BLE001 - this is the border of the process: everything becomes a message
        code = 1
        traceback.print_exc()
        channel.send({"error": describe(error, str(spec["key"]), Path(spec["out"]))})
    sys.stdout.flush()
    sys.stderr.flush()
    # No interpreter shutdown: destructors of native libraries may hang or crash after the work is safe.
    os._exit(code)


def _run(spec: dict[str, Any], channel: Channel, cancelled: Callable[[], bool]) -> dict[str, Any]:
    started = time.monotonic()
    module, _, function = str(spec["entry"]).partition(":")
    run: Callable[[StageTask], StageResult] = getattr(importlib.import_module(module), function)
    out = Path(spec["out"])
    task = StageTask(
        key=spec["key"],
        args=spec["args"],
        settings=only_declared(Settings.model_validate(spec["settings"]), spec["declared"]),
        inputs={key: Path(path) for key, path in spec["inputs"].items()},
        facts=spec["facts"],
        video=Path(spec["video"]),
        annotations=Path(spec["annotations"]) if spec["annotations"] else None,
        out=out,
        threads=spec["threads"],
        max_frame_pixels=spec["max_frame_pixels"],
        progress=channel.progress,
        cancelled=cancelled,
    )
    facts = json.loads(json.dumps(run(task).facts, allow_nan=False))
    manifest = seal(
        out,
        fingerprint=spec["fingerprint"],
        key=task.key,
        version=spec["version"],
        facts=facts,
        seconds=round(time.monotonic() - started, 3),
        rss=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
    )
    return {"digest": manifest.digest}


def describe(error: BaseException, key: str, out: Path) -> dict[str, Any]:
    """An error as JSON: expected ones as they are, the others by what they mean for the runner."""
    if out.is_dir() and disk_is_full(out):
        return DiskFull("no space left on the disk of the output folder", where=key).to_dict()
    if isinstance(error, BladeAtlasError):
        return error.to_dict()
    if isinstance(error, MemoryError):
        return ResourceError("not enough memory for this task", code="oom", where=key).to_dict()
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, OSError) and cause.errno in NO_SPACE:
            reason = os.strerror(cause.errno or 0).lower()
            return DiskFull(f"the output folder cannot be written: {reason}", where=key).to_dict()
        cause = cause.__cause__ or cause.__context__
    name = type(error).__name__
    return BladeAtlasError(f"{name}: {error}".strip()[:2000], where=key).to_dict()


if __name__ == "__main__":
    main()
