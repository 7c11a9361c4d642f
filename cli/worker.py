"""`bladeatlas worker`: runs tasks of a distributed system."""

from __future__ import annotations

import argparse

from core.errors import BadInput
from store import json_log
from store.opening import open_database
from store.settings import DeploymentSettings
from worker.distributed import run_worker

_QUEUES = ("cpu", "gpu")


def command(parsed: argparse.Namespace) -> int:
    """Run tasks until the process is told to stop; returns its exit code."""
    settings = DeploymentSettings()
    queues = [name.strip() for name in parsed.queues.split(",")]
    if not set(queues) <= set(_QUEUES):
        raise BadInput(f"queues '{parsed.queues}'; known: {', '.join(_QUEUES)}", where="--queues")
    if parsed.workers is not None and parsed.workers < 1:
        raise BadInput(f"{parsed.workers} workers; at least 1", where="--workers")
    json_log.configure()
    database = open_database(settings)
    try:
        return run_worker(settings, database, queues, parsed.workers or settings.worker_count())
    finally:
        database.close()
