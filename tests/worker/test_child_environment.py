"""A stage reads a stranger's video: no credential of the worker is within its reach, nor in what it is told."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from store.db import Database, upgrade
from store.plan import Plan
from tests.databases import database_url
from tests.worker.conftest import Workplace
from tests.worker.fake_stages import GRAPH
from tests.worker.test_local import Notes, Server
from worker.logs import TaskLogs
from worker.results import ResultFolders
from worker.runner import TaskRunner

MARK = "marked-credential"
VARIABLES = ("BLADEATLAS_DATABASE_URL", "BLADEATLAS_BROKER_URL", "AWS_SECRET_ACCESS_KEY", "PGPASSWORD", "OTHER_THING")


@pytest.fixture
def server(place: Workplace, tmp_path: Path) -> Iterator[Server]:
    """A worker whose database is reached with a password (which the tests' PostgreSQL does not look at)."""
    with database_url("postgresql", tmp_path) as url:
        upgrade(url)
        db = Database(url.set(password=MARK))
        yield Server(place, db)
        db.close()


def test_a_stage_reaches_nobody(place: Workplace) -> None:
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen()
        port = listening.getsockname()[1]
        with socket.create_connection(("127.0.0.1", port), timeout=5):
            pass  # it can be reached
        place.control(split={"reach": port})
        assert place.run().state == "succeeded"
    assert (place.video.parent / "reached.txt").read_text() == "PermissionError"


@pytest.mark.service("postgresql")
def test_a_stage_has_no_credential(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in VARIABLES:
        monkeypatch.setenv(name, MARK)
    server.place.control(split={"tell": True})
    server.create("one")
    plan = Plan(server.db, GRAPH)
    lease = plan.lease("worker:1/0", inspection_id="one")
    assert lease is not None
    hidden = server.place.out / ".bladeatlas"
    runner = TaskRunner(
        plan, ResultFolders(hidden / "results"), TaskLogs(hidden / "logs"), Notes(), max_frame_pixels=12345
    )
    assert runner.run(lease).outcome == "succeeded"
    told = json.loads((server.place.video.parent / "told.json").read_text())
    assert told["environment"]["PATH"], "it does see what is allowed"
    assert told["document"]["max_frame_pixels"] == 12345
    for place, content in told.items():
        assert content, place
        assert MARK not in json.dumps(content), place
