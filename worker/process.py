"""A task's process tree as the runner sees it: start, listen, stop, and know how it ended."""

from __future__ import annotations

import json
import math
import os
import select
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import psutil

from core.child_environment import child_environment
from core.errors import BladeAtlasError, ResourceError, error_from_dict

_POLL_S = 0.2
_GRACE_S = 2.0
"""Between the request to stop and the kill: nothing of an unfinished task is worth waiting longer for."""

StopReason = Literal["", "interrupted", "cancelled", "lost"]


@dataclass(frozen=True)
class Ended:
    """How a task's process ended."""

    error: BladeAtlasError | None
    """None when the stage finished and its folder is sealed."""
    stopped: StopReason
    """Why it was stopped, when it was."""
    seconds: float
    peak_rss_bytes: int


class TaskProcess:
    """One run of `worker.child`."""

    def __init__(
        self, spec: Mapping[str, Any], log: Path, memory_limit_bytes: int = 0, limit_s: float = math.inf
    ) -> None:
        self._key = str(spec["key"])
        self._limit = memory_limit_bytes
        self._limit_s = limit_s
        self._oom_kills = _kernel_oom_kills()
        self._last: dict[str, Any] = {}
        self._buffer = b""
        self._peak = 0
        self._started = time.monotonic()
        self._read, write = os.pipe()
        try:
            with log.open("ab") as log_stream:
                self._process = subprocess.Popen(
                    [sys.executable, "-m", "worker.child", str(os.getpid())],
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

    def wait(self, on_progress: Callable[[float, str], None], stop: Callable[[], StopReason]) -> Ended:
        """Listen until the tree has ended; asks `stop` a few times a second whether to end it early."""
        reason: StopReason = ""
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
        if not select.select([self._read], [], [], wait_s)[0]:
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
        while select.select([self._read], [], [], 0)[0] and self._listen(on_progress, 0):
            pass

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
        if time.monotonic() - self._started > self._limit_s:
            message = f"the task ran longer than its limit of {self._limit_s:g} s"
            return ResourceError(message, code="timeout", where=self._key)
        if self._limit > 0 and self._resident() > self._limit:
            limit = f"{self._limit / 2**20:.0f} MiB"
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
        how = signal.Signals(number).name if number else f"exit code {self._process.returncode}"
        return ResourceError(f"the task's process died ({how})", code="worker_lost", where=self._key)


def _kernel_oom_kills() -> int:
    """How often the kernel killed something for lack of memory since it started; 0 where it does not say."""
    with suppress(OSError):
        for line in Path("/proc/vmstat").read_text(encoding="ascii").splitlines():
            if line.startswith("oom_kill "):
                return int(line.split()[1])
    return 0
