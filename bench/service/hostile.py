"""An honest client of a server that others try to keep from answering; see `bench.service.attackers` for what they do.

The server is the one of `bladeatlas serve` with its runners and its own limits, on stages that take a moment. The
client submits inspections, polls and downloads, first alone and then under attack.
"""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import psutil
from sqlalchemy import insert

from bench.service.attackers import Attack, make_slow_video
from bench.service.deployment import Server, serving
from bench.service.transfers import MemoryWatch, publish, random_file
from bench.speed.timing import Row, Table
from core.errors import StageFailed
from core.scene.detection import Outcome
from core.states import InspectionState
from store.accounts import Accounts
from store.db import open_sqlite
from store.keys import Keys
from store.models import ACTIVE_INSPECTION, DetectionRow

SECONDS = 600.0
UPLOADS = 10_000
"""Tried in ten minutes; in a shorter time as many fewer."""
_HONEST, _VIDEOS, _UPLOADS = "honest", "hostile-videos", "hostile-uploads"
_ROWS, _FILE_BYTES = 60_000, 16 << 20
_POLL_S = 0.05
_PATIENCE_S = 120.0
_QUIET_SHARE, _QUIET_LEAST_S = 0.1, 4.0
"""The client is alone for so much of the time before."""
_SAMPLES = Path("samples")
_SETTINGS = {"GRAPH": "bench.soak.toy:GRAPH", "WORKERS": "2", "RESERVE_BYTES": "0"}


@dataclass
class Seen:
    """What the honest client saw in one phase; seconds."""

    polls: list[float] = field(default_factory=list)
    submits: list[float] = field(default_factory=list)
    jobs: list[float] = field(default_factory=list)
    """From accepted to published."""
    downloads: list[float] = field(default_factory=list)
    """All files of an inspection."""
    states: Counter[str] = field(default_factory=Counter)
    """How its inspections ended."""
    wrong: int = 0
    """Files whose hash is not the one that was told."""
    refused: Counter[str] = field(default_factory=Counter)
    """Its requests that were not answered with 2xx: by status, or by what broke."""


class HonestClient:
    """Submits, polls and downloads until a time is over; polls all the while in a thread of its own."""

    def __init__(self, url: str, key: str) -> None:
        headers = {"Authorization": f"Bearer {key}"}
        self._http = httpx.Client(base_url=url, headers=headers, timeout=_PATIENCE_S)
        self._polling = httpx.Client(base_url=url, headers=headers, timeout=_PATIENCE_S)
        self._path = "/v1/inspections?limit=1"
        self._state: str = InspectionState.QUEUED
        self._jobs = 0

    def phase(self, seconds: float) -> Seen:
        """Inspections one after the other for so long, the last one to its end."""
        seen, over = Seen(), threading.Event()
        poller = threading.Thread(target=self._poll, args=(seen, over))
        poller.start()
        end = time.monotonic() + seconds
        try:
            while time.monotonic() < end:
                self._job(seen)
        finally:
            over.set()
            poller.join()
        return seen

    def _poll(self, seen: Seen, over: threading.Event) -> None:
        while not over.wait(_POLL_S):
            path, began = self._path, time.perf_counter()
            try:
                answer = self._polling.get(path)
            except httpx.TransportError as error:
                seen.refused[f"poll: {type(error).__name__}"] += 1
                continue
            seen.polls.append(time.perf_counter() - began)
            if not answer.is_success:
                seen.refused[f"poll: {answer.status_code}"] += 1
            elif path == self._path:
                self._state = answer.json().get("state", InspectionState.QUEUED)

    def _job(self, seen: Seen) -> None:
        began = time.perf_counter()
        answer = self._submit()
        if not answer.is_success:
            seen.refused[f"submit: {answer.status_code}"] += 1
            time.sleep(float(answer.headers.get("Retry-After", 1)))
            return
        accepted = time.perf_counter()
        seen.submits.append(accepted - began)
        self._state, self._path = InspectionState.QUEUED, f"/v1/inspections/{answer.json()['id']}"
        deadline = time.monotonic() + _PATIENCE_S
        while self._state in ACTIVE_INSPECTION and time.monotonic() < deadline:
            time.sleep(_POLL_S)
        seen.states[self._state] += 1
        published = time.perf_counter()
        seen.jobs.append(published - accepted)
        seen.wrong += self._download(seen)
        seen.downloads.append(time.perf_counter() - published)

    def _submit(self) -> httpx.Response:
        self._jobs += 1  # no two share a result
        parameters = {"options": {"frames.jpeg_quality": 100 - self._jobs % 50, "seed": self._jobs}}
        with (_SAMPLES / "turbine.mp4").open("rb") as video, (_SAMPLES / "turbine.json").open("rb") as notes:
            files: dict[str, Any] = {"video": video, "annotations": notes}
            return self._http.post("/v1/inspections", files=files, data={"parameters": json.dumps(parameters)})

    def _download(self, seen: Seen) -> int:
        """Fetch every artifact; how many have another hash than was told."""
        wrong = 0
        for item in self._http.get(f"{self._path}/artifacts").json().get("artifacts", ()):
            answer = self._http.get(item["link"])
            if not answer.is_success:
                seen.refused[f"download: {answer.status_code}"] += 1
            wrong += hashlib.sha256(answer.content).hexdigest() != item["sha256"]
        return wrong


def hostile(folder: Path, seconds: float = SECONDS) -> Table:
    """An honest client alone for a tenth of the time, then for `seconds` under attack by two other accounts."""
    data = folder / "data"
    data.mkdir()
    source = random_file(folder / "large.bin", _FILE_BYTES)
    keys, large = _prepare(data, source)
    video = folder / "slow.mp4"
    make_slow_video(video)
    with serving(data, {f"BLADEATLAS_{name}": value for name, value in _SETTINGS.items()}) as server:
        watch = MemoryWatch(server)
        client = HonestClient(server.url, keys[_HONEST])
        quiet = client.phase(max(_QUIET_LEAST_S, _QUIET_SHARE * seconds))
        paths = [f"{large}/detections", f"{large}/detections?format=csv", f"{large}/artifacts/large.bin"]
        port = httpx.URL(server.url).port or 0
        uploads = max(1, round(UPLOADS * seconds / SECONDS))
        attack = Attack(port, str(video), keys[_VIDEOS], keys[_UPLOADS], paths, uploads, UPLOADS / SECONDS)
        process = psutil.Process(server.process.pid)
        with _attacking(attack) as tally:
            used, began = _processor_s(process), time.monotonic()
            under = client.phase(seconds)
            share = (_processor_s(process) - used) / (time.monotonic() - began)
            descriptors = process.num_fds()
        memory, log_bytes = watch.stop(), (data / "server.log").stat().st_size
    rows = _rows(quiet, under, tally) + _of_server(server, memory, share, descriptors, log_bytes)
    title = f"an honest client, {seconds:g} s beside 100 silent readers, 1,100 half-open connections, two accounts"
    return Table("hostile", title, tuple(rows))


def _prepare(data: Path, source: Path) -> tuple[dict[str, str], str]:
    """Accounts with a key each, and the path of an inspection with a large table and a large file."""
    database = open_sqlite(data / "bladeatlas.db")
    keys = {}
    for name in (_HONEST, _VIDEOS, _UPLOADS):
        Accounts(database).create(name)
        keys[name] = Keys(database).create(name, name)[1]
    large = publish(data, source, _VIDEOS)
    row = {"inspection_id": large, "task_key": "", "key": "key", "label": "dent", "outcome": Outcome.MAPPED}
    box = {"box_x1": 0.25, "box_y1": 0.25, "box_x2": 0.5, "box_y2": 0.75}
    with database.write() as session:
        session.execute(insert(DetectionRow), [{**row, **box, "id": i, "time_s": float(i)} for i in range(_ROWS)])
    database.close()
    return keys, f"/v1/inspections/{large}"


@contextmanager
def _attacking(attack: Attack) -> Iterator[dict[str, Any]]:
    """The attackers' process for the block; afterwards the dictionary holds what they counted."""
    tally: dict[str, Any] = {}
    command = [sys.executable, "-m", "bench.service.attackers"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdin is not None  # pipes were asked for
        assert process.stdout is not None
        process.stdin.write(json.dumps(asdict(attack)) + "\n")
        process.stdin.flush()
        if process.stdout.readline().strip() != "ready":
            raise StageFailed("the attackers could not begin", where="service")
        try:
            yield tally
        finally:
            said = process.communicate()[0]
    tally.update(json.loads(said))


def _rows(quiet: Seen, under: Seen, tally: dict[str, Any]) -> list[Row]:
    found = []
    for name, seen, within in (("alone", quiet, ""), ("attacked", under, "under 500")):
        times = np.array(seen.polls or [np.nan]) * 1e3
        jobs = seen.states.total()
        found += [
            Row(f"{name}: polls", len(seen.polls)),
            Row(f"{name}: poll, median", float(np.median(times)), "ms"),
            Row(f"{name}: poll, 99 %", float(np.percentile(times, 99)), "ms", within),
            Row(f"{name}: poll, slowest", float(times.max()), "ms"),
            Row(f"{name}: inspections that succeeded", seen.states[InspectionState.SUCCEEDED], f"of {jobs}", "all"),
            Row(f"{name}: submit, median", _median(seen.submits), "s"),
            Row(f"{name}: submit, slowest", max(seen.submits, default=None), "s"),
            Row(f"{name}: inspection, median", _median(seen.jobs), "s"),
            Row(f"{name}: download of its files, median", _median(seen.downloads), "s"),
            Row(f"{name}: files whose hash is wrong", seen.wrong, "", "0"),
            Row(f"{name}: requests refused or broken", seen.refused.total(), _counts(seen.refused), "0"),
        ]
    return [
        *found,
        Row("silent readers held", tally["silent_held"], f"(opened {tally['silent_opened']})", "100"),
        Row("half-open connections held", tally["half_open_held"], f"(opened {tally['half_open_opened']})"),
        Row("slow videos answered", sum(tally["videos"].values()), _counts(tally["videos"]), "no 202"),
        Row("uploads tried", sum(tally["uploads"].values()), _counts(tally["uploads"]), "at most 100 open"),
    ]


def _processor_s(process: psutil.Process) -> float:
    """Seconds of processor that a process has used, without its children."""
    times = process.cpu_times()
    return float(times.user + times.system)


def _of_server(server: Server, memory: int, share: float, descriptors: int, log_bytes: int) -> list[Row]:
    return [
        Row("server: largest memory", memory / (1 << 20), "MiB", "under 300"),
        Row("server: its own share of a core under attack", share * 100, "%"),
        Row("server: open descriptors under attack", descriptors),
        Row("server: bytes of log", log_bytes),
        Row("server: exit code", server.process.returncode, "", "0"),
    ]


def _median(values: list[float]) -> float | None:
    return float(np.median(values)) if values else None


def _counts(counts: dict[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in sorted(counts.items()))
