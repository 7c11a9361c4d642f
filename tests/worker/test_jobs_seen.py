"""What a broker and its monitors show: jobs by name, in the order of turns, and how each ended."""

from __future__ import annotations

import base64
import json
import threading
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from celery import Celery
from celery.events.state import State
from kombu import Exchange
from kombu import Queue as BrokerQueue
from redis import Redis

from core.settings import make_settings
from store.accounts import Accounts
from store.announcing import Announcements
from store.db import Database
from store.inspections import Inspections
from store.models import Worker
from store.monitoring import WorkerRegistry
from store.records import InputFiles
from tests.conftest import service_url
from tests.databases import database
from tests.waiting import wait_for
from tests.worker.deployment import Deployment
from tests.worker.fake_stages import GRAPH, SMALL
from worker.broker import TaskQueue

BROKERS = [pytest.param(name, marks=pytest.mark.service(name)) for name in ("redis", "rabbitmq")]
pytestmark = [pytest.mark.deployment, pytest.mark.service("redis"), pytest.mark.service("postgresql")]


@pytest.fixture
def db(tmp_path: Path) -> Iterator[Database]:
    with database("postgresql", tmp_path) as made:
        yield made


@pytest.fixture
def redis(redis_url: str) -> Iterator[Redis]:
    with Redis.from_url(redis_url) as client:
        client.flushdb()
        yield client
        client.flushdb()


def waiting(redis: Redis) -> list[tuple[str, list[Any], dict[str, Any]]]:
    """Jobs in the broker's queue by name and arguments, first the one that is taken first."""
    messages = [json.loads(message) for message in redis.lrange("bladeatlas.cpu", 0, -1)][::-1]
    bodies = [json.loads(base64.b64decode(message["body"])) for message in messages]
    return [(message["headers"]["task"], *body[:2]) for message, body in zip(messages, bodies, strict=True)]


def test_messages_name_their_tasks_come_in_turn_and_again_when_lost(db: Database, redis: Redis, redis_url: str) -> None:
    for account in ("many", "one"):
        Accounts(db).create(account)
    with db.write() as session:
        for name, owner in (("many 0", "many"), ("many 1", "many"), ("single", "one")):
            files = [InputFiles("/v.mp4", name.replace(" ", "") * 8, None, None)]
            Inspections(db, GRAPH).create_in(session, name, files, make_settings(options=SMALL), "", owner=owner)
    WorkerRegistry(db).seen("worker", ["cpu", "gpu"], 1)
    queue, announcements = TaskQueue(redis_url, 3600), Announcements(db)
    assert queue.announce(announcements) == 2
    expected: list[tuple[str, list[str], dict[str, Any]]] = [
        ("bladeatlas.split", ["many 0"], {}),
        ("bladeatlas.split", ["single"], {}),
    ]
    assert waiting(redis) == expected
    redis.flushdb()
    assert queue.announce(announcements) == 0
    assert queue.announce(announcements, overdue_s=60) == 0
    assert queue.announce(announcements, overdue_s=0) == 2
    assert waiting(redis) == expected


def test_a_broker_that_is_away_leaves_nothing_noted_as_announced(db: Database) -> None:
    Inspections(db, GRAPH).create("one", [InputFiles("/v.mp4", "0" * 64, None, None)], make_settings(), "")
    WorkerRegistry(db).seen("worker", ["cpu"], 1)
    with pytest.raises(Exception, match="refused"):
        TaskQueue("redis://127.0.0.1:1/0", 3600).announce(Announcements(db))
    assert len(Announcements(db).choose()) == 1


@contextmanager
def listening(app: Celery) -> Iterator[State]:
    """The state of all jobs as monitors know it: from events alone."""
    state, ready, over = State(), threading.Event(), threading.Event()

    def listen() -> None:
        with app.connection_for_read() as connection:
            receiver = app.events.Receiver(connection, handlers={"*": state.event})
            with receiver.consumer_context(wakeup=False) as (own, _channel, _consumers):
                ready.set()
                while not over.is_set():
                    try:
                        own.drain_events(timeout=0.2)
                    except TimeoutError:
                        continue

    thread = threading.Thread(target=listen)
    thread.start()
    assert ready.wait(10)
    try:
        yield state
    finally:
        over.set()
        thread.join()


@pytest.mark.parametrize("broker", BROKERS)
def test_monitors_see_each_job_by_name_with_its_worker_and_its_end(broker: str, tmp_path: Path, db: Database) -> None:
    url, name = service_url(broker), f"inspection-{uuid.uuid4().hex[:8]}"
    environment = {
        "BLADEATLAS_DATABASE_URL": db.engine.url.render_as_string(hide_password=False),
        "BLADEATLAS_BROKER_URL": url,
        # A worker that looks by itself twice a second would now and then be earlier than the message.
        "BLADEATLAS_SWEEP_S": "5",
    }
    place, app = Deployment(tmp_path, db, environment), Celery(broker=url, set_as_current=False)
    with listening(app) as state:
        place.start("worker", "--workers", "1")
        try:
            place.create(name, part__000={"sleep_s": 12}, part__001={"raise": "stage"})
            wait_for(lambda: place.started(name)["part/000"] == 1)
            with db.read() as session:
                worker = f"celery@{session.query(Worker).one().name}"
            shown: dict[str, Any] = {}

            def answers() -> bool:
                # A busy machine may take longer than an inspection waits.
                shown.update(app.control.inspect([worker], timeout=5).active() or {})
                return worker in shown

            wait_for(answers)
            assert [(job["name"], job["args"]) for job in shown[worker]] == [("bladeatlas.part", [name, "000"])]
            place.wait(name)
            assert place.accepted_once(name) is False, "one part failed"
            # A doubled message: its task is over.
            to = BrokerQueue("bladeatlas.cpu", Exchange(""), routing_key="bladeatlas.cpu")
            app.send_task("bladeatlas.split", (name,), queue=to)
            wait_for(lambda: (("split",), "IGNORED") in ends(state, name))
        finally:
            place.stop()
    assert sorted(ends(state, name)) == [
        (("join",), "SUCCESS"),
        (("last",), "SUCCESS"),
        (("part", "000"), "SUCCESS"),
        (("part", "001"), "FAILURE"),
        (("split",), "IGNORED"),
        (("split",), "SUCCESS"),
    ]
    own = jobs(state, name)
    failed = next(job for job in own if job.state == "FAILURE")
    assert "stage_failed: no surface" in failed.exception
    assert {job.worker.hostname for job in own} == {worker}
    assert place.started(name)["split"] == 1


def jobs(state: State, inspection: str) -> list[Any]:
    """Those of an inspection; of others that began before anybody listened the arguments are not known."""
    return [job for job in list(state.tasks.values()) if job.args and inspection in job.args]


def ends(state: State, inspection: str) -> list[tuple[tuple[str, ...], str]]:
    """Stage and part of an inspection's jobs with their states."""
    parts = ("000", "001")
    return [
        ((job.name.removeprefix("bladeatlas."), *(part for part in parts if f"'{part}'" in job.args)), job.state)
        for job in jobs(state, inspection)
    ]
