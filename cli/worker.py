"""`bladeatlas worker`: runs tasks of a distributed system."""

from __future__ import annotations

import argparse

from cli.terminal import say
from core.errors import BadInput
from core.states import Queue
from store import json_log
from store.db import Database
from store.environment import deployment_settings
from store.factory import open_database
from store.monitoring import WorkerRegistry
from store.settings import DeploymentSettings
from worker.broker import run_worker
from worker.loop import say_confinement

_LATE = 3
"""Heartbeats after which a worker counts as gone."""


def command(parsed: argparse.Namespace) -> int:
    """Run tasks until the process is told to stop; returns its exit code."""
    settings = deployment_settings()
    queues = [name.strip() for name in parsed.queues.split(",")]
    if not set(queues) <= set(Queue):
        raise BadInput(f"queues '{parsed.queues}'; known: {', '.join(Queue)}", where="--queues")
    if parsed.workers is not None and parsed.workers < 1:
        raise BadInput(f"{parsed.workers} workers; at least 1", where="--workers")
    if parsed.check:
        return _check(settings)
    json_log.configure()
    say_confinement()
    database = open_database(settings)
    try:
        return run_worker(settings, database, queues, parsed.workers or settings.worker_count())
    finally:
        database.close()


def _check(settings: DeploymentSettings) -> int:
    """0 when a worker of this host has reported itself lately, else 1."""
    database = Database(settings.database())
    try:
        alive = WorkerRegistry(database).alive(within_s=_LATE * settings.heartbeat_s)
    finally:
        database.close()
    say(", ".join(alive) or "no worker of this host has reported itself")
    return 0 if alive else 1
