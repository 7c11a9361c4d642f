"""Many clients at once: how long a status poll takes while others upload."""

from __future__ import annotations

import asyncio
import re
import subprocess
import time
from collections import Counter
from pathlib import Path

import httpx
import numpy as np

from bench.service.deployment import Server, begin_upload, curl, serving, upload_arguments
from bench.service.transfers import MemoryWatch
from bench.soak.servers import RedisServer
from bench.speed.timing import Row, Table

POLLERS, UPLOADERS = 200, 20
SECONDS, PERIOD_S = 60.0, 1.0
UPLOAD_BYTES = 32 << 20
SAMPLES = Path("samples")
_CONTENT_LENGTH = re.compile(rb"(?i)\r\ncontent-length: *(\d+)")


def load(folder: Path) -> Table:
    """200 clients that poll every second and 20 that upload one file after the other, for a minute.

    The inspection that is polled waits in the queue of a broker that nobody works for, so the processor belongs to
    the API, to the database and to the clients.
    """
    source = folder / "upload.bin"
    source.write_bytes(b"\0" * UPLOAD_BYTES)
    redis = RedisServer()
    redis.start()
    try:
        with serving(folder / "data", {"BLADEATLAS_BROKER_URL": redis.url}) as server:
            resource = _submit(server)
            watch = MemoryWatch(server)
            times, statuses, uploaded = asyncio.run(_all(server, resource, source))
            memory = watch.stop()
    finally:
        redis.kill()
    failed = sum(count for status, count in statuses.items() if status >= httpx.codes.INTERNAL_SERVER_ERROR)
    return Table(
        "load",
        f"{POLLERS} pollers and {UPLOADERS} uploaders of {UPLOAD_BYTES >> 20} MiB files for {SECONDS:g} s",
        (
            Row("polls", len(times)),
            Row("poll, median", float(np.median(times)) * 1e3, "ms"),
            Row("poll, 99 %", float(np.percentile(times, 99)) * 1e3, "ms", "under 250"),
            Row("uploads finished", uploaded),
            Row("answers 5xx", failed, "", "0"),
            Row("largest memory of the API", memory / (1 << 20), "MiB", "under 300"),
        ),
    )


def _submit(server: Server) -> str:
    video, annotations = SAMPLES / "turbine.mp4", SAMPLES / "turbine.json"
    curl("-F", f"video=@{video}", "-F", f"annotations=@{annotations}", f"{server.url}/v1/inspections")
    listed = httpx.get(f"{server.url}/v1/inspections").raise_for_status().json()["inspections"]
    return f"/v1/inspections/{listed[0]['id']}"


async def _all(server: Server, resource: str, source: Path) -> tuple[list[float], Counter[int], int]:
    end = time.monotonic() + SECONDS
    times: list[float] = []
    statuses: Counter[int] = Counter()
    pollers = [_poll(server, resource, end, PERIOD_S * i / POLLERS, times, statuses) for i in range(POLLERS)]
    uploads = [asyncio.to_thread(_upload, server, source, end) for _ in range(UPLOADERS)]
    done = await asyncio.gather(*pollers, *uploads)
    return times, statuses, sum(count for count in done if count is not None)


async def _poll(
    server: Server, resource: str, end: float, delay: float, times: list[float], statuses: Counter[int]
) -> None:
    """One client on one connection; bare HTTP, since 200 clients of httpx wait for each other in one process."""
    await asyncio.sleep(delay)
    address = httpx.URL(server.url)
    reader, writer = await asyncio.open_connection(address.host, address.port)
    request = f"GET {resource} HTTP/1.1\r\nHost: {address.host}\r\n\r\n".encode()
    while time.monotonic() < end:
        began = time.perf_counter()
        writer.write(request)
        head = await reader.readuntil(b"\r\n\r\n")
        await reader.readexactly(int(_CONTENT_LENGTH.findall(head)[0]))
        took = time.perf_counter() - began
        times.append(took)
        statuses[int(head.split(b" ", 2)[1])] += 1
        await asyncio.sleep(max(0.0, PERIOD_S - took))
    writer.close()


def _upload(server: Server, source: Path, end: float) -> int:
    finished = 0
    while time.monotonic() < end:
        try:
            location = begin_upload(server, UPLOAD_BYTES)
            curl(*upload_arguments(location, source))
            curl("-X", "DELETE", "-H", "Tus-Resumable: 1.0.0", location)
        except (httpx.HTTPStatusError, subprocess.CalledProcessError):
            continue
        finished += 1
    return finished
