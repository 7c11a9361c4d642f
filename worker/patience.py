"""Waiting for a database server that went away: what was done meanwhile only lacks its commit."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event
from typing import TypeVar

from sqlalchemy.exc import InterfaceError, OperationalError

from store.db import Database

T = TypeVar("T")
_RECONNECT_S = 0.5


def patiently(database: Database, call: Callable[[], T], stopped: Event) -> T:
    """Call until the server answers or `stopped` is set.

    A commit whose answer was lost is repeated and then refused by its fence: it counts once. A SQLite file
    waits by itself; what it still refuses will not get better.
    """
    while True:
        try:
            return call()
        except (OperationalError, InterfaceError):
            if database.is_sqlite or stopped.wait(_RECONNECT_S):
                raise
