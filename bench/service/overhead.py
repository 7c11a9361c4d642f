"""What the service costs beside the stages, read from the plan's own rows."""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime, timedelta
from pathlib import Path
from statistics import median
from typing import Any

import httpx
from sqlalchemy import select

from bench.service.deployment import Server, curl, serving
from bench.speed.timing import Row, Table
from core.errors import StageFailed
from core.states import AttemptOutcome, InspectionState
from core.task_key import stage_of
from store.db import Database, open_sqlite
from store.models import ACTIVE_INSPECTION as ACTIVE
from store.models import Attempt

SAMPLES = Path("samples")
Interval = tuple[datetime, datetime]


def overhead(folder: Path, repeat: int, preset: str) -> Table:
    """The sample through the service, from the answer 202 until its files can be fetched."""
    walls, inside = [], []
    for number in range(repeat):
        with _finished(folder / f"overhead-{number}", preset, {}, workers=2) as (database, wall):
            walls.append(wall)
            inside.append(covered(attempts(database)))
    shares = [1.0 - stages / wall for stages, wall in zip(inside, walls, strict=True)]
    return Table(
        "overhead",
        f"the sample, preset {preset}, two tasks side by side, median of {repeat}",
        (
            Row("job, from accepted to published", median(walls), "s"),
            Row("of it no task was running", median(w - i for w, i in zip(walls, inside, strict=True)), "s"),
            Row("overhead", median(shares) * 100, "%", "under 5"),
        ),
    )


def covered(intervals: Iterable[Interval]) -> float:
    """Seconds in which at least one of the intervals runs."""
    total, end = 0.0, None
    for begin, stop in sorted(intervals):
        start = begin if end is None else max(begin, end)
        total += max(0.0, (stop - start).total_seconds())
        end = stop if end is None else max(end, stop)
    return total


def attempts(database: Database, stages: tuple[str, ...] = ()) -> list[Interval]:
    """When stages (empty = all) were running: not the start of their processes, not what is done with their files."""
    with database.read() as session:
        rows = session.scalars(select(Attempt).where(Attempt.outcome == AttemptOutcome.SUCCEEDED)).all()
    return [
        (row.ended_at - timedelta(seconds=row.seconds), row.ended_at)
        for row in rows
        if (not stages or stage_of(row.key) in stages) and row.ended_at is not None and row.seconds is not None
    ]


def submitted(server: Server, preset: str, options: Mapping[str, Any]) -> str:
    """Upload the sample; the address of its inspection."""
    form = {"video": "turbine.mp4", "annotations": "turbine.json"}
    files = [word for name, file in form.items() for word in ("-F", f"{name}=@{SAMPLES / file}")]
    parameters = json.dumps({"preset": preset, "options": dict(options)})
    made = curl(*files, "-F", f"parameters={parameters}", f"{server.url}/v1/inspections")
    return f"{server.url}/v1/inspections/{json.loads(made)['id']}"


@contextmanager
def _finished(
    folder: Path, preset: str, options: Mapping[str, Any], *, workers: int
) -> Iterator[tuple[Database, float]]:
    """A server of its own after one job of the sample: its database, and the job's wall seconds."""
    data = folder / "data"
    with serving(data, {"BLADEATLAS_WORKERS": str(workers)}) as server:
        began = time.perf_counter()
        link = submitted(server, preset, options)
        while (found := httpx.get(link, params={"wait": 30}, timeout=60).raise_for_status().json())["state"] in ACTIVE:
            pass
        wall = time.perf_counter() - began
        if found["state"] != InspectionState.SUCCEEDED:
            raise StageFailed(f"the sample ended {found['state']}: {found['error']}", where="service")
        database = open_sqlite(data / "bladeatlas.db")
        try:
            yield database, wall
        finally:
            database.close()
