"""What a broker and its monitors show: jobs by name, in the order of turns, and how each ended."""

from __future__ import annotations

import base64
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from celery import Celery
from celery.events.state import State
from redis import Redis

from core.settings import make_settings
from store.accounts import Accounts
from store.announcing import Announcements
from store.db import Database
from store.inspections import Inspections
from store.monitoring import WorkerRegistry
from store.records import InputFiles
from tests.databases import database
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
    assert queue.announce(announcements, unheard_s=60) == 0
    assert queue.announce(announcements, unheard_s=0) == 2
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
            with receiver.consumer_context(wakeup=False):
                ready.set()
                while not over.is_set():
                    try:
                        connection.drain_events(timeout=0.2)
                    except TimeoutError:
                        continue

    thread = threading.Thread(target=listen)
    thread.start()
    assert ready.wait(10)
    yield state
    over.set()
    thread.join()


def ends(state: State, inspection: str) -> list[tuple[tuple[str, ...], str]]:
    """Stage and part of an inspection's jobs with their states."""
    found = [job for job in list(state.tasks.values()) if job.args and inspection in job.args]
    parts = {"000", "001"}
    return [
        (
            (job.name.removeprefix("bladeatlas."), *(part for part in sorted(parts) if f"'{part}'" in job.args)),
            job.state,
        )
        for job in found
    ]
