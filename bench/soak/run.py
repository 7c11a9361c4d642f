"""One deployment, its jobs, and what comes of them: once undisturbed, once with faults; and what is counted at the end.

Every task counts once in the database, and the store holds no file that belongs to nothing.
"""

from __future__ import annotations

import json
import random
import shutil
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sqlalchemy import select

from bench.soak.client import SoakClient
from bench.soak.compare import differences
from bench.soak.faults import Duplicates, Faults
from bench.soak.fleet import Fleet
from bench.soak.servers import PostgresServer, RedisServer
from core.states import AttemptOutcome, InspectionState, TaskState
from store.db import Database
from store.models import Artifact, Attempt, FurtherVideo, Inspection, Result, Task
from store.publishing import uncompressed_key
from worker.results import MANIFEST

_TRANSFERS = 2
"""Uploads, and as many downloads, in the middle of which the API is killed."""
_CORE, _TOY = "store.graph:CORE_GRAPH", "bench.soak.toy:GRAPH"
_CLEANING_S = 90.0


@dataclass(frozen=True)
class SoakSettings:
    """What a soak does; everything that its result depends on."""

    video: Path
    annotations: Path
    jobs: int = 10
    faults: int = 50
    workers: int = 2
    pause_s: float = 8.0
    """Mean time between two faults."""
    preset: str = "draft"
    seed: int = 0
    toy: bool = False
    lease_s: float = 5.0
    job_s: float = 3600.0
    """A job that takes longer is lost."""
    options: dict[str, Any] = field(default_factory=dict)
    """Of every job, over the preset."""

    def environment(self, redis: RedisServer, postgres: PostgresServer) -> dict[str, str]:
        """Of every process under test."""
        values = {
            "BROKER_URL": redis.url,
            "DATABASE_URL": postgres.url,
            "GRAPH": _TOY if self.toy else _CORE,
            "HEARTBEAT_S": str(self.lease_s / 4),
            "LEASE_S": str(self.lease_s),
            # Faults fall on the same task more often here than a task that is at fault itself would need.
            "MAX_ATTEMPTS": "100",
            "MAX_ACTIVE": str(self.jobs + 10),
            "MAX_ACTIVE_PER_OWNER": str(self.jobs + 10),
            "STALE_S": "5",
            "SWEEP_S": "1",
        }
        return {f"BLADEATLAS_{name}": value for name, value in values.items()}

    def parameters(self, job: int) -> dict[str, Any]:
        """Of one job; no two share a result, so every job is computed."""
        own = {"frames.jpeg_quality": 100 - job % 40, "compute.threads": 1, "seed": 0}
        options = {**self.options, **own}
        return {"preset": self.preset, "options": options, "label": "soak"}


@dataclass
class Outcome:
    """What one deployment came to."""

    states: dict[str, str] = field(default_factory=dict)
    seconds: float = 0.0
    faults: list[str] = field(default_factory=list)
    duplicates: int = 0
    attempts: dict[str, int] = field(default_factory=dict)
    wrong: list[str] = field(default_factory=list)
    """Everything that is not as it must be; empty when the soak is passed."""


def undisturbed(settings: SoakSettings, folder: Path) -> Outcome:
    """Run all jobs without a fault; an earlier run of the same is taken as it is."""
    done = folder / "outcome.json"
    if done.is_file():
        return Outcome(**json.loads(done.read_text(encoding="utf-8")))
    outcome = _run(settings, folder, harm=False)
    done.write_text(json.dumps(asdict(outcome), indent=1), encoding="utf-8")
    return outcome


def disturbed(settings: SoakSettings, folder: Path, reference: Path) -> Outcome:
    """Run the same jobs with faults, and compare."""
    outcome = _run(settings, folder, harm=True)
    for job in range(settings.jobs):
        found = differences(reference / "files" / _name(job), folder / "files" / _name(job))
        outcome.wrong += [f"{_name(job)}: {difference}" for difference in found]
    return outcome


def _run(settings: SoakSettings, folder: Path, *, harm: bool) -> Outcome:
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "files").mkdir(parents=True)
    outcome, over = Outcome(), threading.Event()
    with _servers() as (redis, postgres):
        fleet = Fleet(folder / "data", settings.environment(redis, postgres), settings.workers)
        fleet.start()
        cut = _TRANSFERS if harm else 0
        faults = Faults(fleet, redis, postgres, settings.lease_s, random.Random(settings.seed), cut)
        began = time.monotonic()
        breaker = threading.Thread(target=_disturb, args=(settings, faults, outcome, over))
        if harm:
            breaker.start()
        try:
            with ThreadPoolExecutor(settings.jobs) as clients:
                jobs = [clients.submit(_job, settings, faults, folder, job, over) for job in range(settings.jobs)]
                results = [job.result() for job in jobs]
        finally:
            over.set()
            if harm:
                breaker.join()
        outcome.seconds = round(time.monotonic() - began, 1)
        for job, (state, wrong) in enumerate(results):
            outcome.states[_name(job)] = state
            outcome.wrong += wrong
        _audit(outcome, postgres, fleet)
    return outcome


@contextmanager
def _servers() -> Iterator[tuple[RedisServer, PostgresServer]]:
    # PostgreSQL runs as another user when this one is root, and must be able to reach its folder.
    with tempfile.TemporaryDirectory(prefix="bladeatlas-soak-") as place:
        Path(place).chmod(0o755)
        redis, postgres = RedisServer(), PostgresServer(Path(place) / "postgres")
        redis.start()
        try:
            postgres.start()
            yield redis, postgres
        finally:
            redis.kill()
            postgres.kill()


def _disturb(settings: SoakSettings, faults: Faults, outcome: Outcome, over: threading.Event) -> None:
    duplicates = Duplicates(faults.redis.url)
    duplicates.start()
    while len(faults.done) < settings.faults and not over.wait(faults.rng.uniform(0.5, 1.5) * settings.pause_s):
        faults.any()
    over.wait()
    duplicates.stop()
    outcome.faults, outcome.duplicates = faults.done, duplicates.sent


def _job(
    settings: SoakSettings, faults: Faults, folder: Path, job: int, over: threading.Event
) -> tuple[str, list[str]]:
    """Submit, wait, download; the clients begin one after the other."""
    over.wait(job * settings.pause_s / 4)
    client = SoakClient(faults.fleet.url, faults.in_transfer)
    inspection_id = client.submit(_name(job), settings.video, settings.annotations, settings.parameters(job))
    found = client.wait(inspection_id, settings.job_s)
    wrong = [
        f"{_name(job)}: {path} was damaged on its way"
        for path in client.download(inspection_id, folder / "files" / _name(job))
    ]
    if found["state"] != InspectionState.SUCCEEDED:
        wrong.append(f"{_name(job)}: {found['state']} {found['error']}")
    return str(found["state"]), wrong


def _audit(outcome: Outcome, postgres: PostgresServer, fleet: Fleet) -> None:
    database = Database(postgres.url)
    outcome.attempts = attempts(database)
    outcome.wrong += [f"{task}: not exactly one accepted attempt" for task in wrong_attempts(database)]
    outcome.wrong += [f"{path}: belongs to nothing" for path in orphans(database, fleet.folder)]
    outcome.wrong += [f"{process}: did not end" for process in fleet.stop()]
    database.close()


def _name(job: int) -> str:
    return f"job-{job:02d}"


def wrong_attempts(database: Database) -> list[str]:
    """Tasks without exactly one accepted attempt, unless a finished result was taken up instead."""
    with database.read() as session:
        accepted = Counter(session.scalars(select(Attempt.task_id).where(Attempt.outcome == AttemptOutcome.SUCCEEDED)))
        tasks = session.scalars(select(Task).where(Task.state == TaskState.SUCCEEDED)).all()
    expected = {task.id: 0 if task.reused else 1 for task in tasks}
    return [f"{task.inspection_id} {task.key}" for task in tasks if accepted[task.id] != expected[task.id]]


def attempts(database: Database) -> dict[str, int]:
    """How many attempts ended in which way."""
    with database.read() as session:
        return dict(sorted(Counter(session.scalars(select(Attempt.outcome))).items()))


def orphans(database: Database, data: Path) -> list[str]:
    """Files of the store that nothing names, once the cleaner had time to remove them."""
    deadline = time.monotonic() + _CLEANING_S
    while (found := unknown_files(database, data / "artifacts")) and time.monotonic() < deadline:
        time.sleep(1.0)
    return found


def unknown_files(database: Database, store: Path) -> list[str]:
    """Files of a store that nothing in the database names, and results that it names and the store lacks."""
    with database.read() as session:
        known = set(session.scalars(select(Artifact.key)))
        inputs = {
            path
            for table in (Inspection, FurtherVideo)
            for row in session.execute(select(table.video_path, table.annotations_path))
            for path in row
            if path
        }
        logs = {f"logs/{name}" for name in session.scalars(select(Inspection.id))}
        results = {f"results/{path}" for path in session.scalars(select(Result.path))}
    unknown = []
    for path in sorted(path for path in store.rglob("*") if path.is_file()):
        name = path.relative_to(store).as_posix()
        parents = {parent.relative_to(store).as_posix() for parent in path.parents if parent.is_relative_to(store)}
        if uncompressed_key(name) not in known | inputs and not parents & (logs | results):
            unknown.append(name)
    return unknown + [name for name in sorted(results) if not (store / name / MANIFEST).is_file()]
