"""A task's process tree: the runner's view of it, and the guard and the stage that it consists of.

`python -m worker.task PARENT_PID` runs one stage in a process group that dies with its parent. Two processes: a small
guard, and the stage forked from it. The kernel tells the guard when the runner dies (PR_SET_PDEATHSIG), and the guard
then kills the whole group, so that helpers of the stage go too; the stage itself is killed by the kernel when the
guard dies. The description of the task comes as JSON on stdin, progress and the outcome leave as JSON lines on a pipe.
"""

from __future__ import annotations

import errno
import importlib
import json
import os
import resource
import select
import signal
import subprocess
import sys
import time
import traceback
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, NoReturn

import psutil

from core.child_environment import child_environment
from core.confinement import NetworkGuard, ProcessLimits, confine, die_with
from core.errors import BladeAtlasError, DiskFull, ProgrammingError, ResourceError, StageFailed, error_from_dict
from core.products.contract import Product, read_product
from core.settings import Settings, only_declared
from core.stage import StageTask
from core.videos import Recording
from store.disk import NO_SPACE, disk_is_full
from worker.limits import TaskLimits
from worker.results import seal

_MISTAKES = (TypeError, AttributeError, NameError, LookupError, AssertionError, ImportError, NotImplementedError)
"""Errors that code raises because it is wrong; libraries raise others on input that they cannot handle."""
_OUT_OF_MEMORY = (
    "bad_alloc",
    "can't allocate memory",
    "Cannot allocate memory",
    "Insufficient memory",
    "out of memory",
)
"""What libraries say with errors of their own kinds: of C++, of PyTorch, of the system, of OpenCV."""
_LAST_WORDS = 4096
_POLL_S = 0.2
_GRACE_S = 2.0
"""Between the request to stop and the kill: nothing of an unfinished task is worth waiting longer for."""
_PROGRESS_EVERY_S = 0.5


class StopReason(StrEnum):
    """Why a runner stops a task early."""

    INTERRUPTED = "interrupted"
    """The runner itself shall end."""
    CANCELLED = "cancelled"
    LOST = "lost"
    """Its lease is no longer held."""


@dataclass(frozen=True)
class Ended:
    """How a task's process ended."""

    error: BladeAtlasError | None
    """None when the stage finished and its folder is sealed."""
    stopped: StopReason | None
    """Why it was stopped, when it was."""
    seconds: float
    peak_rss_bytes: int


class TaskProcess:
    """One run of `worker.task`."""

    def __init__(self, spec: Mapping[str, Any], log: Path, limits: TaskLimits) -> None:
        self._key = str(spec["key"])
        self._limits = limits
        self._of_process: Mapping[str, int] = spec["limits"]
        self._log, self._log_began = log, log.stat().st_size if log.exists() else 0
        self._oom_kills = _kernel_oom_kills()
        self._last: dict[str, Any] = {}
        self._buffer = b""
        self._peak = 0
        self._started = time.monotonic()
        self._read, write = os.pipe()
        try:
            with log.open("ab") as log_stream:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "worker.task", str(os.getpid())],
                    stdin=subprocess.PIPE,
                    stdout=log_stream,
                    stderr=subprocess.STDOUT,
                    pass_fds=(write,),
                    start_new_session=True,
                    env=child_environment(int(spec["threads"])),
                )
        except BaseException:
            os.close(self._read)
            raise
        finally:
            os.close(write)
        self._hand_over({**spec, "channel": write})

    def _hand_over(self, spec: Mapping[str, Any]) -> None:
        assert self._process.stdin is not None
        with suppress(BrokenPipeError), self._process.stdin as stream:
            stream.write(json.dumps(spec, allow_nan=False).encode())

    def wait(self, on_progress: Callable[[float, str], None], stop: Callable[[], StopReason | None]) -> Ended:
        """Listen until the tree has ended; asks `stop` a few times a second whether to end it early."""
        reason: StopReason | None = None
        beyond: ResourceError | None = None
        try:
            while not self._over():
                self._listen(on_progress)
                reason = stop()
                beyond = self._beyond_limits()
                if reason or beyond:
                    self._terminate()
                    break
        finally:
            seconds, rusage_peak = time.monotonic() - self._started, self._reap()
        self._drain(on_progress)
        os.close(self._read)
        error = None if reason else beyond or self._error()
        return Ended(error, reason, round(seconds, 3), max(self._peak, rusage_peak))

    def _over(self) -> bool:
        """True once the guard has ended; it stays unreaped, so its process group cannot be given to others."""
        options = os.WEXITED | os.WNOHANG | os.WNOWAIT
        return os.waitid(os.P_PID, self._process.pid, options) is not None

    def _listen(self, on_progress: Callable[[float, str], None], wait_s: float = _POLL_S) -> bool:
        """Take in what was written; False at the end of the stream."""
        if not self._readable(wait_s):
            return True
        data = os.read(self._read, 1 << 16)
        *lines, self._buffer = (self._buffer + data).split(b"\n")
        for line in lines:
            message = json.loads(line)
            if "progress" in message:
                on_progress(float(message["progress"]), str(message["message"]))
            else:
                self._last.update(message)
        if not data:
            time.sleep(0.01)  # the stream is over, the guard is about to be
        return bool(data)

    def _drain(self, on_progress: Callable[[float, str], None]) -> None:
        while self._readable(0) and self._listen(on_progress, 0):
            pass

    def _readable(self, wait_s: float) -> bool:
        """Whether something was written, or the stream is over; `select` would take no descriptor above 1023."""
        poll = select.poll()
        poll.register(self._read, select.POLLIN)
        return bool(poll.poll(wait_s * 1000))

    def _terminate(self) -> None:
        self._signal(signal.SIGTERM)
        deadline = time.monotonic() + _GRACE_S
        while not self._over() and time.monotonic() < deadline:
            time.sleep(0.02)

    def _signal(self, number: signal.Signals) -> None:
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)

    def _reap(self) -> int:
        """Kill whatever is left of the group, collect the guard; its peak memory in bytes, children included."""
        self._signal(signal.SIGKILL)
        _, status, usage = os.wait4(self._process.pid, 0)
        self._process.returncode = os.waitstatus_to_exitcode(status)
        return usage.ru_maxrss * 1024

    def _resident(self) -> int:
        """Resident bytes of the whole tree now."""
        total = 0
        with suppress(psutil.Error):
            guard = psutil.Process(self._process.pid)
            for process in (guard, *guard.children(recursive=True)):
                with suppress(psutil.Error):
                    total += process.memory_info().rss
        self._peak = max(self._peak, total)
        return total

    def _beyond_limits(self) -> ResourceError | None:
        limits = self._limits
        if time.monotonic() - self._started > limits.seconds:
            message = f"the task ran longer than its limit of {limits.seconds:g} s"
            return ResourceError(message, code="timeout", where=self._key)
        if limits.resident_bytes > 0 and self._resident() > limits.resident_bytes:
            limit = f"{limits.resident_bytes / 2**20:.0f} MiB"
            return ResourceError(f"the task used more memory than its limit of {limit}", code="oom", where=self._key)
        return None

    def _error(self) -> BladeAtlasError | None:
        if "error" in self._last:
            return error_from_dict(self._last["error"])
        if "done" in self._last:
            return None
        number = int(self._last.get("signal", -min(0, self._process.returncode)))
        if number == signal.SIGKILL and _kernel_oom_kills() > self._oom_kills:
            return ResourceError("the system killed the task for lack of memory", code="oom", where=self._key)
        if number == signal.SIGABRT and "bad_alloc" in self._last_words():
            return ResourceError(_no_memory(self._of_process), code="oom", where=self._key)
        if number == signal.SIGXCPU:
            message = "the task used more processor time than its limit (task_cpu_seconds)"
            return ResourceError(message, code="timeout", where=self._key)
        how = signal.Signals(number).name if number else f"exit code {self._process.returncode}"
        return ResourceError(f"the task's process died ({how})", code="worker_lost", where=self._key)

    def _last_words(self) -> str:
        """The end of what the task wrote into its log: native code that throws says there what."""
        with suppress(OSError), self._log.open("rb") as stream:
            size = stream.seek(0, os.SEEK_END)
            stream.seek(max(self._log_began, size - _LAST_WORDS))
            return stream.read().decode("utf-8", "replace")
        return ""


def _kernel_oom_kills() -> int:
    """How often the kernel killed something for lack of memory since it started; 0 where it does not say."""
    with suppress(OSError):
        for line in Path("/proc/vmstat").read_text(encoding="ascii").splitlines():
            if line.startswith("oom_kill "):
                return int(line.split()[1])
    return 0


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
    if confine(ProcessLimits(**spec["limits"])) == NetworkGuard.NONE:
        sys.stderr.write("this system cannot keep the task from the network\n")
    die_with(guard, signal.SIGKILL)
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    code = 0
    try:
        channel.send({"done": _run(spec, channel, lambda: bool(stopped))})
    except BaseException as error:  # noqa: BLE001 - this is the border of the process: everything becomes a message
        code = 1
        traceback.print_exc()
        channel.send({"error": describe(error, str(spec["key"]), Path(spec["out"]), spec["limits"])})
    sys.stdout.flush()
    sys.stderr.flush()
    # No interpreter shutdown: destructors of native libraries may hang or crash after the work is safe.
    os._exit(code)


def _run(spec: dict[str, Any], channel: Channel, cancelled: Callable[[], bool]) -> dict[str, Any]:
    started = time.monotonic()
    module, _, function = str(spec["entry"]).partition(":")
    run: Callable[[StageTask], Product] = getattr(importlib.import_module(module), function)
    out = Path(spec["out"])
    task = StageTask(
        key=spec["key"],
        args=spec["args"],
        settings=only_declared(Settings.model_validate(spec["settings"]), spec["declared"]),
        inputs={key: Path(path) for key, path in spec["inputs"].items()},
        facts=spec["facts"],
        recordings=[Recording.from_dict(fields) for fields in spec["recordings"]],
        out=out,
        threads=spec["threads"],
        max_frame_pixels=spec["max_frame_pixels"],
        progress=channel.progress,
        cancelled=cancelled,
    )
    product = run(task)
    facts = json.loads(json.dumps(product.facts, allow_nan=False))
    read_product(type(product), facts, task.key)  # what cannot be read again is told here, not by a later task
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


def _no_memory(limits: Mapping[str, int]) -> str:
    """What to say of a task that got no memory."""
    most = limits["address_bytes"]
    why = f"; a process of it may have {most / 2**20:.0f} MiB of addresses (task_address_bytes)" if most else ""
    return f"not enough memory for this task{why}"


def describe(error: BaseException, key: str, out: Path, limits: Mapping[str, int]) -> dict[str, Any]:
    """An error as JSON: expected ones as they are, the others by what they mean for the runner."""
    if out.is_dir() and disk_is_full(out):
        return DiskFull("no space left on the disk of the output folder", where=key).to_dict()
    if isinstance(error, BladeAtlasError):
        return error.to_dict()
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, MemoryError) or any(words in str(cause) for words in _OUT_OF_MEMORY):
            return ResourceError(_no_memory(limits), code="oom", where=key).to_dict()
        if isinstance(cause, OSError) and cause.errno == errno.EFBIG:
            message = "the task wrote a file larger than one may be (task_file_bytes)"
            return StageFailed(message, code="file_too_large", where=key).to_dict()
        if isinstance(cause, OSError) and cause.errno in NO_SPACE:
            reason = os.strerror(cause.errno or 0).lower()
            return DiskFull(f"the output folder cannot be written: {reason}", where=key).to_dict()
        cause = cause.__cause__ or cause.__context__
    message = f"{type(error).__name__}: {error}".strip()[:2000]
    kind = ProgrammingError if isinstance(error, _MISTAKES) else BladeAtlasError
    return kind(message, where=key).to_dict()


if __name__ == "__main__":
    main()
