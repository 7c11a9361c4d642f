"""`bladeatlas-bench simulate`: a day of inspections on many workers, and how well a simulation meets a real run."""

from __future__ import annotations

import argparse
import json
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import httpx
import numpy as np
from sqlalchemy import URL, select

from bench.service.deployment import curl, serving
from bench.service.recording import Recording, read_recording, record
from bench.service.simulation import Simulated, Workload, simulate
from bench.soak.servers import PostgresServer
from bench.speed.timing import Row, Table
from core.errors import BadInput, StageFailed
from core.states import InspectionState
from store.db import open_sqlite, sqlite_url, upgrade
from store.graph import load_graph
from store.models import ACTIVE_INSPECTION, Inspection

RECORDED = Path(__file__).with_name("recorded-default.json")
TOY, CORE = "bench.soak.toy:GRAPH", "store.graph:CORE_GRAPH"
_DAY_S = 86_400.0
_SAMPLES = Path("samples")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `simulate`."""
    parser.add_argument("recording", nargs="?", type=Path, default=RECORDED, metavar="FILE", help="(the sample's)")
    parser.add_argument("--record", type=Path, metavar="DB", help="write FILE from a finished SQLite database, and end")
    parser.add_argument("--per-day", type=float, default=1000.0, metavar="N", help="inspections a day (1000)")
    parser.add_argument("--hours", type=float, default=24.0, metavar="N", help="for so long (24)")
    parser.add_argument("--workers", type=int, default=64, metavar="N", help="tasks side by side (64)")
    parser.add_argument("--accounts", type=int, default=10, metavar="N", help="whose they are, in turn (10)")
    parser.add_argument("--stretch", type=float, default=1.0, metavar="N", help="times the recorded seconds (1)")
    parser.add_argument("--sqlite", action="store_true", help="in SQLite instead of a PostgreSQL of its own")
    parser.add_argument("--calibrate", choices=("toy", "draft"), help="hold a real run of two workers against it")
    parser.add_argument("--jobs", type=int, default=6, metavar="N", help="inspections of that run (6)")


def command(arguments: argparse.Namespace) -> None:
    """Record, calibrate or simulate; prints a table."""
    with tempfile.TemporaryDirectory(prefix="bladeatlas-simulate-") as name:
        folder = Path(name)
        if arguments.record is not None:
            with closing(open_sqlite(arguments.record)) as db:
                found = record(db)
            if not found:
                raise BadInput(f"no inspection in '{arguments.record}' has succeeded", where="--record")
            found[0].write(arguments.recording)
        elif arguments.calibrate:
            print(calibration(folder, arguments.calibrate, arguments.jobs).text())
        else:
            hours = arguments.hours
            number = max(1, round(arguments.per_day * hours / 24))
            load = Workload(number, hours * 3600, arguments.workers, arguments.accounts, arguments.stretch)
            recording = read_recording(arguments.recording)
            print(_simulated(folder, recording, load, arguments.sqlite).text())


def _simulated(folder: Path, recording: Recording, load: Workload, in_sqlite: bool) -> Table:
    if in_sqlite:
        return day(_sqlite(folder / "plan.db"), recording, load)
    # Another user runs the server.
    folder.chmod(0o755)
    server = PostgresServer(folder / "cluster")
    server.start()
    try:
        upgrade(server.url)
        return day(server.url, recording, load)
    finally:
        server.kill()


def _sqlite(path: Path) -> URL:
    url = sqlite_url(path)
    upgrade(url)
    return url


def day(url: str | URL, recording: Recording, load: Workload) -> Table:
    """What a workload comes to, and where its limits are."""
    began = time.perf_counter()
    found = simulate(url, load_graph(CORE), [recording], load)
    took = time.perf_counter() - began
    slot_s = found.busy_s / load.inspections + recording.handover_s * len(recording.tasks)
    database_s = found.database_s() / load.inspections
    return Table(
        "simulation",
        f"{load.inspections} in {load.span_s / 3600:g} h on {load.workers} workers, stages x {load.stretch:g}",
        (
            Row("tasks of an inspection", len(recording.tasks)),
            Row("stages that the recording does not know", ", ".join(sorted(found.unknown)) or "none"),
            Row("seconds of a slot for an inspection", slot_s, "s"),
            Row("queue time, median", median(found.queue_s), "s"),
            Row("queue time, 95 %", float(np.percentile(found.queue_s, 95)), "s"),
            Row("from arrival to end, median", median(found.whole_s), "s"),
            Row("from arrival to end, 95 %", float(np.percentile(found.whole_s, 95)), "s"),
            Row("inspections that waited, at most", found.most_waiting),
            Row("slots in use", 100 * found.busy_s / (load.workers * max(load.span_s, found.end_s)), "%"),
            *_costs(found),
            Row("the plan's calls for an inspection", database_s, "s"),
            Row("slots would be full at", load.workers * _DAY_S / slot_s, "inspections a day"),
            Row("one connection would be full at", _DAY_S / database_s, "inspections a day"),
            Row("the simulation took", took, "s"),
        ),
    )


def _costs(found: Simulated) -> Sequence[Row]:
    rows = []
    for name, what in (("create", "to make a plan"), ("lease", "to lease a task"), ("complete", "to end a task")):
        values = found.costs_s[name]
        rows.append(Row(f"{what}, median", median(values) * 1e3, "ms"))
        rows.append(Row(f"{what}, 95 %", float(np.percentile(values, 95)) * 1e3, "ms"))
    return rows


@dataclass(frozen=True)
class RealRun:
    """Jobs of a server with two workers."""

    recordings: Sequence[Recording]
    arrivals_s: Sequence[float]
    """Of each, from the first one's arrival."""
    ends_s: Sequence[float]
    """The same of their ends."""


def calibration(folder: Path, kind: str, jobs: int) -> Table:
    """Jobs on two real workers beside what simulations say of them.

    One simulation replays what each of their tasks took: it says whether turns, leases and gaps are as in a real run.
    The other knows two jobs only, each of which ran alone, one before and one after: it is a prediction.
    """
    graph = TOY if kind == "toy" else CORE
    before = _real(folder / "before", graph, [0])
    real = _real(folder / "real", graph, range(jobs))
    after = _real(folder / "after", graph, [0])
    known = {"replayed": real.recordings, "predicted": [*before.recordings, *after.recordings]}
    rows = [Row("tasks of a job", len(real.recordings[0].tasks))]
    rows += [Row(f"a slot for a job, {name}", _mean([one.slot_s for one in used]), "s") for name, used in known.items()]
    measured = {"the last end": max(real.ends_s), "mean time of a job": _mean(_times(real.arrivals_s, real.ends_s))}
    rows += [Row(f"{what}, real", value, "s") for what, value in measured.items()]
    for name, recordings in known.items():
        load = Workload(jobs, 0.0, 2, arrivals_s=real.arrivals_s)
        found = simulate(_sqlite(folder / f"{name}.db"), load_graph(graph), recordings, load)
        for what, value in {"the last end": found.end_s, "mean time of a job": _mean(found.whole_s)}.items():
            rows.append(Row(f"{what}, {name}", value, "s"))
            rows.append(Row(f"{what}, {name}: off by", 100 * (value / measured[what] - 1), "%", "within 15"))
    return Table("calibration", f"{jobs} jobs ({kind}) at once on two workers", tuple(rows))


def _mean(values: Sequence[float]) -> float:
    return float(np.mean(values))


def _times(begins: Sequence[float], ends: Sequence[float]) -> Sequence[float]:
    return [end - begin for begin, end in zip(begins, ends, strict=True)]


def _real(folder: Path, graph: str, jobs: Iterable[int]) -> RealRun:
    """Run jobs on a server of their own."""
    data = folder / "data"
    settings = {"BLADEATLAS_WORKERS": "2", "BLADEATLAS_GRAPH": graph, "BLADEATLAS_RESERVE_BYTES": "0"}
    with serving(data, settings) as server:
        links = [f"{server.url}/v1/inspections/{_submit(server.url, number)}" for number in jobs]
        _until(lambda: all(_state(link) not in ACTIVE_INSPECTION for link in links))
        states = {_state(link) for link in links}
    if states != {InspectionState.SUCCEEDED}:
        raise StageFailed(f"jobs ended {sorted(states)}", where="calibration")
    with closing(open_sqlite(data / "bladeatlas.db")) as db:
        with db.read() as session:
            rows = session.scalars(select(Inspection).order_by(Inspection.created_at)).all()
        first = rows[0].created_at
        ends = [(row.ended_at - first).total_seconds() for row in rows if row.ended_at is not None]
        return RealRun(record(db), [(row.created_at - first).total_seconds() for row in rows], ends)


def _submit(url: str, number: int) -> str:
    """One of several jobs of which no two share a result."""
    parameters = {
        "preset": "draft",
        "options": {"frames.jpeg_quality": 100 - number % 40, "compute.threads": 1, "seed": 0},
    }
    files = [word for name in ("video", "annotations") for word in ("-F", f"{name}=@{_file(name)}")]
    made = curl(*files, "-F", f"parameters={json.dumps(parameters)}", f"{url}/v1/inspections")
    return str(json.loads(made)["id"])


def _file(name: str) -> Path:
    return _SAMPLES / {"video": "turbine.mp4", "annotations": "turbine.json"}[name]


def _state(link: str) -> str:
    return str(httpx.get(link).raise_for_status().json()["state"])


def _until(over: Callable[[], bool], limit_s: float = 3600.0) -> None:
    deadline = time.monotonic() + limit_s
    while not over():
        if time.monotonic() > deadline:
            raise StageFailed(f"not over after {limit_s:.0f} s", where="calibration")
        time.sleep(0.5)
