"""Local runners as a server uses them: many inspections, cancellation, short leases, a database that goes away."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from sqlalchemy import func, select, text

from core.errors import BladeAtlasError
from core.settings import make_settings
from store.db import Database
from store.inspections import Inspections
from store.models import Attempt
from store.plan import Plan
from store.records import InputFiles, Lease
from tests.databases import BOTH, database
from tests.waiting import wait_for
from tests.worker.conftest import Workplace
from tests.worker.fake_stages import GRAPH, SMALL
from worker.logs import TaskLogs
from worker.loop import LocalRunners
from worker.results import ResultFolders
from worker.runner import TaskRunner

pytestmark = pytest.mark.slow


@dataclass
class Notes:
    """An observer that writes down."""

    begun: list[str] = field(default_factory=list)
    over: list[tuple[str, str]] = field(default_factory=list)

    def started(self, lease: Lease) -> None:
        self.begun.append(lease.key)

    def progressed(self, lease: Lease, fraction: float, message: str) -> None:
        assert 0.0 <= fraction <= 1.0

    def ended(self, lease: Lease, outcome: str, error: BladeAtlasError | None) -> None:
        self.over.append((lease.key, outcome))


@dataclass
class Server:
    """What an embedded server consists of."""

    place: Workplace
    db: Database
    notes: Notes = field(default_factory=Notes)

    def create(self, name: str) -> None:
        sha256 = hashlib.sha256(self.place.video.read_bytes()).hexdigest()
        files = [InputFiles(str(self.place.video), sha256, None, None)]
        self.inspections.create(name, files, make_settings(options=SMALL), str(self.place.out))

    @property
    def inspections(self) -> Inspections:
        return Inspections(self.db, GRAPH)

    def runners(self, lease_s: float = 30.0, heartbeat_s: float = 10.0, workers: int = 2) -> LocalRunners:
        plan = Plan(self.db, GRAPH, lease_s=lease_s)
        runner = TaskRunner(
            plan, ResultFolders(self.place.out / "results"), TaskLogs(self.place.out / "logs"), self.notes
        )
        return LocalRunners(runner, "server", workers, heartbeat_s)

    def states(self) -> list[str]:
        return [view.state for view in self.inspections.find()]

    def over(self) -> bool:
        return not {"queued", "running", "cancelling"} & set(self.states())

    def outcomes(self) -> dict[str, int]:
        with self.db.read() as session:
            rows = session.execute(select(Attempt.outcome, func.count()).group_by(Attempt.outcome)).all()
        return {str(outcome): int(count) for outcome, count in rows}


@pytest.fixture(params=BOTH)
def server(request: pytest.FixtureRequest, place: Workplace, tmp_path: Path) -> Iterator[Server]:
    with database(request.param, tmp_path) as db:
        yield Server(place, db)


def test_inspections_of_the_same_input_share_their_results(server: Server) -> None:
    for name in ("one", "two"):
        server.create(name)
    # One at a time: two that run at once may both make what neither has finished.
    runners = server.runners(workers=1)
    runners.start()
    runners.join(server.over)
    assert runners.failure is None
    assert server.states() == ["succeeded", "succeeded"]
    assert set(server.outcomes()) == {"succeeded"}
    digests = [[task.digest for task in server.inspections.tasks(name)] for name in ("one", "two")]
    assert digests[0] == digests[1]
    assert server.place.started() == ["join", "last", "part/000", "part/001", "split"]


def test_a_cancelled_inspection_stops_within_seconds_and_the_other_goes_on(server: Server) -> None:
    server.place.control(split={"sleep_s": 60, "deaf": True, "times": 1})
    server.create("one")
    runners = server.runners()
    runners.start()
    wait_for(lambda: server.place.started() == ["split"])
    began = time.monotonic()
    Plan(server.db, GRAPH).cancel("one")
    wait_for(lambda: server.states() == ["cancelled"])
    assert time.monotonic() - began < 10.0
    server.place.control()
    server.create("two")
    runners.join(server.over)
    assert server.states() == ["cancelled", "succeeded"]


def test_heartbeats_carry_a_task_over_many_lease_times(server: Server) -> None:
    server.place.control(split={"sleep_s": 3.0, "deaf": True})
    server.create("one")
    runners = server.runners(lease_s=1.5, heartbeat_s=0.5)
    runners.start()
    runners.join(server.over)
    assert server.states() == ["succeeded"]
    assert server.outcomes() == {"succeeded": 5}


def test_a_stopped_server_gives_its_leases_back(server: Server) -> None:
    server.place.control(split={"sleep_s": 60})
    server.create("one")
    runners = server.runners()
    runners.start()
    wait_for(lambda: bool(server.notes.begun))
    runners.stop()
    assert server.notes.over == [("split", "released")]
    assert [task.state for task in server.inspections.tasks("one")] == ["runnable"]
    assert server.outcomes() == {"released": 1}


@pytest.mark.service("postgresql")
def test_a_database_that_cuts_every_connection_costs_nothing(place: Workplace, tmp_path: Path) -> None:
    place.control(all={"sleep_s": 0.5})
    with database("postgresql", tmp_path) as db, database("postgresql", tmp_path) as other:
        server = Server(place, db)
        server.create("one")
        runners = server.runners(heartbeat_s=0.2)
        runners.start()
        name = db.engine.url.database
        cut = text("SELECT pg_terminate_backend(pid) FROM pg_stat_activity WHERE datname = :name")
        for _ in range(8):
            time.sleep(0.4)
            with other.write() as session:
                session.execute(cut, {"name": name})
        runners.join(lambda: server.over())
        assert runners.failure is None
        assert server.states() == ["succeeded"]
        assert server.outcomes()["succeeded"] == 5
