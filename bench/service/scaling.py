"""What a second worker brings to the window search, and what the machine lets two processes bring at all."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from statistics import median

from sqlalchemy import select

from bench.service.deployment import serving
from bench.service.overhead import attempts, covered, submitted
from bench.speed.timing import Row, Table
from core.errors import StageFailed
from core.states import AttemptOutcome
from store.db import Database, open_sqlite
from store.models import Attempt

SEARCH = ("coarse", "section", "refine")
SEARCH_LIMIT_S = 900.0
MANY_WINDOWS = {
    "camera.fov_deg": 85.0,
    "windows.mode": "search",
    "windows.coarse_length": 40,
    "windows.coarse_step": 5,
    "windows.refine_length": 48,
    "windows.refine_margin": 24,
    "windows.refine_min": 32,
    "windows.refine_step": 5,
    "windows.anchor_step": 15,
}
"""The sample is shorter than one window of the presets; these cut it into about twenty, a third from scratch."""
BARE_WINDOWS = ((0, 40), (20, 60))
BARE_CASE = """
import sys
from pathlib import Path
from core.settings import make_settings
from core.sparse.cases import Case, run_case
start, end = int(sys.argv[2]), int(sys.argv[3])
if run_case(Case(Path(sys.argv[1]), start, end, make_settings().mapper, 0)).model is None:
    sys.exit("the window has no model")
"""


def scaling(folder: Path, repeat: int, preset: str) -> Table:
    """The window search with one worker and with two, in turn, beside two windows mapped by bare processes."""
    spans: dict[int, list[float]] = {1: [], 2: []}
    bare: dict[int, list[float]] = {1: [], 2: []}
    for number in range(repeat):
        for workers in spans:
            with _searched(folder / f"scaling-{number}-{workers}", preset, workers) as (database, graph):
                spans[workers].append(covered(attempts(database, SEARCH)))
        for together in bare:
            bare[together].append(bare_seconds(graph, together))
    ratio, ceiling = (median(side[1]) / median(side[2]) for side in (spans, bare))
    return Table(
        "scaling",
        f"twenty windows over the sample, preset {preset}, one thread each, median of {repeat}",
        (
            Row("one worker", median(spans[1]), "s"),
            Row("two workers", median(spans[2]), "s"),
            Row("ratio", ratio, "x", "at least 1.8"),
            Row("two windows by bare processes: one after the other over side by side", ceiling, "x"),
            Row("of what the machine gives", 100 * ratio / ceiling, "%"),
        ),
    )


def bare_seconds(graph: Path, together: int) -> float:
    """Wall seconds of `BARE_WINDOWS` in processes of their own, `together` at a time: nothing of the service in it."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    began = time.perf_counter()
    for first in range(0, len(BARE_WINDOWS), together):
        running = [
            subprocess.Popen(
                [sys.executable, "-c", BARE_CASE, str(graph), str(start), str(end)],
                env=environment,
                stderr=subprocess.DEVNULL,
            )
            for start, end in BARE_WINDOWS[first : first + together]
        ]
        if any(process.wait() for process in running):
            raise StageFailed("a bare window ended without a model", where="scaling")
    return time.perf_counter() - began


@contextmanager
def _searched(folder: Path, preset: str, workers: int) -> Iterator[tuple[Database, Path]]:
    """The database and the pair graph of a job of the sample whose search has ended; the server is stopped by then."""
    data = folder / "data"
    with serving(data, {"BLADEATLAS_WORKERS": str(workers)}) as server:
        submitted(server, preset, MANY_WINDOWS)
        database = open_sqlite(data / "bladeatlas.db")
        limit = time.monotonic() + SEARCH_LIMIT_S
        while not _search_ended(database):
            if time.monotonic() > limit:
                raise StageFailed(f"the search has not ended after {SEARCH_LIMIT_S:.0f} s", where="scaling")
            time.sleep(0.5)
    try:
        yield database, next(data.rglob("graph.npz")).parent
    finally:
        database.close()


def _search_ended(database: Database) -> bool:
    with database.read() as session:
        ended = select(Attempt.key).where(Attempt.key == "reduce_refine", Attempt.outcome == AttemptOutcome.SUCCEEDED)
        return session.scalar(ended) is not None
