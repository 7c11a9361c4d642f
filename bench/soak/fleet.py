"""The processes under test: one API and some workers, started again whenever they are gone, as compose does."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import psutil

from bench.soak.servers import free_port

_RESTART_S = 0.5


class Fleet:
    """Processes of one deployment by name: ``api``, ``worker-0`` and so on."""

    def __init__(self, folder: Path, environment: Mapping[str, str], workers: int) -> None:
        self.folder = folder
        self.port = free_port()
        self._environment = {**os.environ, **environment, "BLADEATLAS_DATA_DIR": str(folder)}
        self._commands = {"api": ["serve", "--port", str(self.port)]}
        self._commands |= {f"worker-{i}": ["worker", "--workers", "1"] for i in range(workers)}
        self._processes: dict[str, subprocess.Popen[bytes]] = {}
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._keep, daemon=True)

    @property
    def url(self) -> str:
        """Address of the API."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def workers(self) -> list[str]:
        """Names of the workers."""
        return [name for name in self._commands if name != "api"]

    def start(self) -> None:
        """Start everything, and keep it started."""
        self.folder.mkdir(parents=True, exist_ok=True)
        self._thread.start()

    def signal(self, name: str, number: signal.Signals) -> None:
        """Send a signal to one process; nothing happens while it is down."""
        process = self._processes.get(name)
        if process is not None and process.poll() is None:
            process.send_signal(number)

    def stop(self) -> list[str]:
        """End everything by SIGTERM; returns what did not end, or lived on behind it."""
        self._stopped.set()
        self._thread.join()
        seen = []
        for process in self._processes.values():
            with suppress(psutil.Error):
                seen += psutil.Process(process.pid).children(recursive=True)
            process.send_signal(signal.SIGTERM)
        late = [name for name, process in self._processes.items() if not _ends(process)]
        return late + [" ".join(child.cmdline()[:4]) for child in seen if _lives(child)]

    def _keep(self) -> None:
        while not self._stopped.is_set():
            for name, arguments in self._commands.items():
                process = self._processes.get(name)
                if process is None or process.poll() is not None:
                    self._processes[name] = self._start(name, arguments)
            self._stopped.wait(_RESTART_S)

    def _start(self, name: str, arguments: list[str]) -> subprocess.Popen[bytes]:
        command = [sys.executable, "-m", "cli.main", *arguments]
        with (self.folder / f"{name}.log").open("ab") as log:
            return subprocess.Popen(command, env=self._environment, stdout=log, stderr=log)


def _ends(process: subprocess.Popen[bytes], seconds: float = 20.0) -> bool:
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()
        return False
    return True


def _lives(process: psutil.Process) -> bool:
    with suppress(psutil.Error):
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    return False
