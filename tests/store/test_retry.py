"""What is tried again while a database server is away, and what is not."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from threading import Event, Timer

import pytest
from sqlalchemy import text
from sqlalchemy.exc import InterfaceError, OperationalError

from store import retry
from store.db import Database, sqlite_url

NOWHERE = "postgresql://nobody@127.0.0.1:1/nothing"


@pytest.fixture(autouse=True)
def short_pauses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(retry, "_PAUSE_S", 0.01)


def failing(times: int, kind: type[Exception]) -> tuple[Callable[[], int], list[int]]:
    """A call that ends well after some failures, and a list with an entry for every call."""
    calls: list[int] = []

    def call() -> int:
        calls.append(1)
        if len(calls) <= times:
            raise kind("SELECT 1", None, Exception("away"))
        return 7

    return call, calls


@pytest.mark.parametrize("kind", [OperationalError, InterfaceError])
def test_a_server_that_comes_back_is_asked_again(kind: type[Exception]) -> None:
    call, calls = failing(3, kind)
    assert retry.retried_until(Event(), Database(NOWHERE), call) == 7
    assert len(calls) == 4
    call, calls = failing(3, kind)
    assert retry.retried_for(5.0, call) == 7
    assert len(calls) == 4


def test_other_errors_are_raised_at_once() -> None:
    call, calls = failing(3, ValueError)
    with pytest.raises(ValueError, match="away"):
        retry.retried_until(Event(), Database(NOWHERE), call)
    assert len(calls) == 1


def test_a_file_is_not_asked_again(tmp_path: Path) -> None:
    call, calls = failing(3, OperationalError)
    with pytest.raises(OperationalError):
        retry.retried_until(Event(), Database(sqlite_url(tmp_path / "plan.db")), call)
    assert len(calls) == 1


def test_whoever_stops_does_not_wait_for_the_server(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(retry, "_PAUSE_S", 60.0)
    database, stopped, began = Database(NOWHERE), Event(), time.monotonic()

    def ask() -> None:
        with database.read() as session:
            session.execute(text("SELECT 1"))

    Timer(0.2, stopped.set).start()
    with pytest.raises(OperationalError):
        retry.retried_until(stopped, database, ask)
    assert time.monotonic() - began < 30.0


def test_the_time_is_limited() -> None:
    call, calls = failing(10**6, OperationalError)
    with pytest.raises(OperationalError):
        retry.retried_for(0.1, call)
    assert len(calls) > 1
