"""A server of the measurement's own, and curl as everybody's client."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import httpx
import psutil

from bench.soak.servers import free_port, wait_for_port
from core.errors import BadInput

READY_S = 60.0
TUS = {"Tus-Resumable": "1.0.0"}


@dataclass(frozen=True)
class Server:
    """A running process that answers on `url`."""

    url: str
    folder: Path
    process: subprocess.Popen[bytes]

    def memory_bytes(self) -> int:
        """Resident memory of the process that answers, without its children."""
        return int(psutil.Process(self.process.pid).memory_info().rss)


@contextmanager
def serving(folder: Path, environment: Mapping[str, str]) -> Iterator[Server]:
    """`bladeatlas serve` over an empty data folder."""
    port = free_port()
    folder.mkdir(parents=True, exist_ok=True)
    settings = {**os.environ, "BLADEATLAS_DATA_DIR": str(folder), **environment}
    with running([sys.executable, "-m", "cli.main", "serve", "--port", str(port)], port, folder, settings) as server:
        _wait_until_ready(server)
        yield server


@contextmanager
def running(command: list[str], port: int, folder: Path, environment: Mapping[str, str]) -> Iterator[Server]:
    """A server process, ended with the block."""
    with (folder / "server.log").open("wb") as log:
        process = subprocess.Popen(command, env=dict(environment), stdout=log, stderr=log)
    try:
        wait_for_port(port)
        yield Server(f"http://127.0.0.1:{port}", folder, process)
    finally:
        process.terminate()
        process.wait()


def _wait_until_ready(server: Server) -> None:
    deadline = time.monotonic() + READY_S
    while True:
        try:
            httpx.get(f"{server.url}/readyz").raise_for_status()
            return
        except httpx.HTTPError:
            if time.monotonic() > deadline:
                raise TimeoutError("the server does not get ready") from None
            time.sleep(0.1)


def curl(*arguments: str) -> str:
    """Run curl and return what it printed; fails on an error status."""
    program = shutil.which("curl")
    if program is None:
        raise BadInput("curl is not installed on this machine", where="service")
    done = subprocess.run([program, "-sSf", *arguments], capture_output=True, text=True, check=True)
    return done.stdout


def begin_upload(server: Server, size: int) -> str:
    """A new tus upload; where to send its bytes."""
    made = httpx.post(f"{server.url}/v1/uploads", headers={**TUS, "Upload-Length": str(size)}).raise_for_status()
    return f"{server.url}{made.headers['Location']}"


def upload_arguments(location: str, file: Path, offset: int = 0) -> list[str]:
    """How curl sends a whole file to an upload in one PATCH, streamed, as what follows `offset`."""
    headers = {**TUS, "Upload-Offset": str(offset), "Content-Type": "application/offset+octet-stream"}
    return [
        *(word for name, value in headers.items() for word in ("-H", f"{name}: {value}")),
        *("-H", "Expect:", "-X", "PATCH", "-T", str(file), location),
    ]
