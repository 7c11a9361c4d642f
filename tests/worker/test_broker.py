"""Workers fed by a real broker and a real database: whatever dies, every task counts once and every job ends."""

from __future__ import annotations

import json
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from redis import Redis
from sqlalchemy import select

from store.announcing import Announcements
from store.files import ArtifactStore
from store.models import Inspection
from store.monitoring import WorkerRegistry
from store.plan import Plan
from tests.databases import database
from tests.store.object_store import new_bucket, options
from tests.waiting import wait_for
from tests.worker.deployment import Deployment
from tests.worker.fake_stages import GRAPH
from worker.broker import TaskQueue

ALL = ["join", "last", "part/000", "part/001", "split"]
pytestmark = [pytest.mark.deployment, pytest.mark.service("redis"), pytest.mark.service("postgresql")]


@pytest.fixture
def broker(redis_url: str) -> Iterator[Redis]:
    with Redis.from_url(redis_url) as client:
        client.flushdb()
        yield client
        client.flushdb()


@pytest.fixture
def place(tmp_path: Path, broker: Redis, redis_url: str) -> Iterator[Deployment]:
    with database("postgresql", tmp_path) as db:
        environment = {
            "BLADEATLAS_DATABASE_URL": db.engine.url.render_as_string(hide_password=False),
            "BLADEATLAS_BROKER_URL": redis_url,
        }
        made = Deployment(tmp_path, db, environment)
        yield made
        made.stop()


def workers(place: Deployment, count: int = 1) -> None:
    for _ in range(count):
        place.start("worker", "--workers", "1")


def test_jobs_of_two_workers_end_and_are_published(place: Deployment) -> None:
    workers(place, 2)
    for name in ("one", "two"):
        place.create(name)
    place.wait("one", "two")
    for name in ("one", "two"):
        assert place.accepted_once(name)
        assert sorted(place.started(name)) == ALL
        assert {"summary.json", "cases.json"} <= set(place.artifacts(name))
    assert place.start("worker", "--check").wait(30) == 0
    for process in place.processes[:2]:
        process.send_signal(signal.SIGTERM)
    assert [process.wait(15) for process in place.processes[:2]] == [0, 0]
    assert "worker_stopped" in place.said()
    assert place.start("worker", "--check").wait(30) == 1


def test_every_message_twice_and_a_broker_without_memory_change_nothing(place: Deployment, broker: Redis) -> None:
    place.create("one", all={"sleep_s": 0.5})
    WorkerRegistry(place.db).seen("one that is gone soon", ["cpu"], 1)
    queue, announcements = TaskQueue(place.environment["BLADEATLAS_BROKER_URL"], 3600), Announcements(place.db)
    assert queue.announce(announcements) == 1
    assert queue.announce(announcements) == 0
    waiting = broker.lrange("bladeatlas.cpu", 0, -1)
    broker.rpush("bladeatlas.cpu", *waiting, *waiting)
    workers(place, 2)
    wait_for(lambda: place.started("one")["split"] == 1)
    broker.flushdb()
    place.wait("one")
    assert place.accepted_once("one")
    assert set(place.started("one").values()) == {1}


def test_killing_every_worker_in_the_middle_of_a_task_loses_nothing(place: Deployment) -> None:
    place.create("one", part__000={"sleep_s": 30, "times": 1}, part__001={"sleep_s": 30, "times": 1})
    workers(place, 2)
    wait_for(lambda: place.started("one")["part/000"] == place.started("one")["part/001"] == 1)
    for process in place.processes:
        process.kill()
    began = time.monotonic()
    workers(place, 1)
    place.wait("one")
    assert time.monotonic() - began < 30.0
    assert place.accepted_once("one")
    assert place.outcomes()[("one", "part/000", "expired")] == 1
    assert place.started("one")["split"] == 1


def test_a_worker_that_freezes_past_its_lease_is_refused(place: Deployment) -> None:
    place.create("one", split={"sleep_s": 3, "deaf": True, "times": 1})
    workers(place)
    wait_for(lambda: place.started("one")["split"] == 1)
    place.processes[0].send_signal(signal.SIGSTOP)
    workers(place)
    place.wait("one")
    before = place.artifacts("one")
    place.processes[0].send_signal(signal.SIGCONT)
    time.sleep(3.0)
    assert place.accepted_once("one")
    assert place.artifacts("one") == before
    # The one that was frozen works on, for others.
    place.create("two")
    place.wait("two")


def test_a_task_that_kills_its_worker_three_times_is_done_without(place: Deployment) -> None:
    place.create("one", part__001={"sleep_s": 60})
    for attempt in range(1, 4):
        workers(place)
        wait_for(lambda expected=attempt: place.started("one")["part/001"] == expected)  # type: ignore[misc]
        place.processes[-1].kill()
    workers(place)
    place.wait("one")
    task = next(task for task in place.inspections.tasks("one") if task.key == "part/001")
    assert task.state == "failed"
    assert task.error is not None
    assert task.error["code"] == "worker_lost"


def test_cancel_ends_the_processes_of_a_job_within_ten_seconds(place: Deployment) -> None:
    place.create("one", split={"sleep_s": 60, "deaf": True, "helper": True})
    workers(place)
    wait_for(lambda: place.started("one")["split"] == 1)
    began = time.monotonic()
    Plan(place.db, GRAPH).cancel("one")
    place.wait("one", state="cancelled")
    assert time.monotonic() - began < 10.0
    assert "summary.json" in place.artifacts("one")


def test_machines_share_nothing_but_an_object_store(place: Deployment, s3: str) -> None:
    url = new_bucket(s3)
    place.remote = ArtifactStore(url, **options(s3))
    place.environment |= {"BLADEATLAS_ARTIFACTS_URL": url, "BLADEATLAS_ARTIFACTS_OPTIONS": json.dumps(options(s3))}
    for name in ("one", "two"):
        place.create(name)
    for machine in ("first", "second"):
        place.start("worker", "--workers", "1", data_dir=machine)
    place.wait("one", "two")
    assert place.accepted_once("one")
    stored = place.remote.list()
    assert {f"inspections/one/1/{path}" for path in place.artifacts("one")} <= set(stored)
    assert "logs/one/part__001.log" in stored
    results = [place.root / machine / "results" for machine in ("first", "second")]
    wait_for(lambda: not any(list(folder.glob("*/*/result.json")) for folder in results))
    with place.db.write() as session:
        for row in session.scalars(select(Inspection)):
            row.deleted_at = place.db.now(session)
    wait_for(lambda: place.store.list() == [])


@pytest.mark.service("rabbitmq")
def test_another_broker_does_as_well(place: Deployment) -> None:
    place.environment["BLADEATLAS_BROKER_URL"] = "amqp://guest:guest@127.0.0.1:5672//"
    place.create("one")
    workers(place)
    place.wait("one")
    assert place.accepted_once("one")


@pytest.mark.long  # it waits for the time itself
def test_a_task_longer_than_the_visibility_timeout_runs_once(place: Deployment, broker: Redis) -> None:
    place.environment["BLADEATLAS_VISIBILITY_TIMEOUT_S"] = "1"
    place.create("one", split={"sleep_s": 16})
    workers(place, 2)
    wait_for(lambda: broker.zcard("unacked_index") == 1)
    # The broker takes the message for lost and hands it to the other worker, for whom the plan has nothing.
    wait_for(lambda: broker.zcard("unacked_index") == 0)
    assert place.inspections.get("one").state == "running"
    place.wait("one")
    assert place.accepted_once("one")
    assert set(place.started("one").values()) == {1}
