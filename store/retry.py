"""Retry policies for a database server that is away: it restarts, fails over, or is just starting.

A SQLite file waits by itself (`busy_timeout`), so what it refuses will not get better and is never tried again.
"""

from __future__ import annotations

from collections.abc import Callable
from threading import Event
from typing import TypeVar

from sqlalchemy.exc import InterfaceError, OperationalError
from tenacity import (
    Retrying,
    retry_if_exception_type,
    sleep_using_event,
    stop_after_delay,
    stop_when_event_set,
    wait_fixed,
)

from store.db import Database

T = TypeVar("T")
_PAUSE_S = 0.5
_AWAY = retry_if_exception_type((OperationalError, InterfaceError))


def retried_until(stopped: Event, database: Database, call: Callable[[], T]) -> T:
    """Call until the server answers, or `stopped` is set; then the last error is raised.

    A commit whose answer was lost is repeated and then refused by its fence: it counts once.
    """
    if database.is_sqlite:
        return call()
    policy = Retrying(
        retry=_AWAY,
        wait=wait_fixed(_PAUSE_S),
        stop=stop_when_event_set(stopped),
        sleep=sleep_using_event(stopped),
        reraise=True,
    )
    return policy(call)


def retried_for(seconds: float, call: Callable[[], T]) -> T:
    """Call until the server answers, for at most so many seconds; then the last error is raised."""
    return Retrying(retry=_AWAY, wait=wait_fixed(_PAUSE_S), stop=stop_after_delay(seconds), reraise=True)(call)
