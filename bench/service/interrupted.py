"""Uploads whose client or server is killed in the middle of a PATCH, and what the file is in the end."""

from __future__ import annotations

import hashlib
import os
import random
import subprocess
import time
from collections import Counter
from pathlib import Path

import httpx

from bench.service.deployment import TUS, Server, begin_upload, curl, serving, upload_arguments
from bench.speed.timing import Row, Table

KILLS = 100
UPLOAD_BYTES = 8 << 20
RATE = 32 << 20
"""Bytes per second that the client sends, so that there is a middle to be killed in."""
_TIMEOUT_S = 20.0


def interrupted(folder: Path, seed: int = 0) -> Table:
    """Kill client and server in turn, at random moments, until `KILLS` of them hit the middle of a PATCH.

    A kill that came before the first byte was on disk, or after the last, is not counted; its file is compared too.
    """
    chance, hits, early, wrong = random.Random(seed), Counter[str](), 0, 0
    waiting: list[tuple[str, Path]] = []
    while sum(hits.values()) < KILLS or waiting:
        with serving(folder / "data", {}) as server:
            for path, source in waiting:
                wrong += not _finish(server, path, source)
            waiting = []
            for who in ("client", "server"):
                if sum(hits.values()) == KILLS:
                    break
                source = folder / "upload.bin"
                source.write_bytes(os.urandom(UPLOAD_BYTES))
                path = httpx.URL(begin_upload(server, UPLOAD_BYTES)).path
                middle = _kill(server, path, source, who, chance.uniform(0.0, UPLOAD_BYTES / RATE))
                hits[who] += middle
                early += not middle
                if who == "client":
                    wrong += not _finish(server, path, source)
                else:
                    waiting = [(path, source)]
    return Table(
        "interrupted",
        f"{UPLOAD_BYTES >> 20} MiB by tus, killed with SIGKILL at random moments, seed {seed}",
        (
            Row("client killed in the middle of a PATCH", hits["client"]),
            Row("server killed in the middle of a PATCH", hits["server"]),
            Row("killed before the first byte or after the last", early),
            Row("files whose SHA-256 is wrong after going on", wrong, "", "0"),
        ),
    )


def _kill(server: Server, path: str, source: Path, who: str, after_s: float) -> bool:
    """Kill one side of an upload that is under way; whether it was in the middle."""
    arguments = ["curl", "-sS", "--limit-rate", str(RATE), *upload_arguments(f"{server.url}{path}", source)]
    with subprocess.Popen(arguments, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as client:
        time.sleep(after_s)
        victim = client if who == "client" else server.process
        victim.kill()
        victim.wait()
    size = _file(server, path).stat().st_size
    return 0 < size < UPLOAD_BYTES


def _finish(server: Server, path: str, source: Path) -> bool:
    """Go on from where the server is; whether the file is the one that was sent."""
    rest = source.with_suffix(".rest")
    with httpx.Client(base_url=server.url) as http:
        deadline = time.monotonic() + _TIMEOUT_S
        # The server may still be writing what the dead client had sent.
        while not (head := http.head(path, headers=TUS)).is_success and time.monotonic() < deadline:
            time.sleep(0.05)
        offset = int(head.raise_for_status().headers["Upload-Offset"])
    if offset < UPLOAD_BYTES:
        rest.write_bytes(source.read_bytes()[offset:])
        curl("--retry", "5", "--retry-all-errors", *upload_arguments(f"{server.url}{path}", rest, offset))
    return _sha256(_file(server, path)) == _sha256(source)


def _file(server: Server, path: str) -> Path:
    return server.folder / "uploads" / path.rsplit("/", 1)[-1]


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()
