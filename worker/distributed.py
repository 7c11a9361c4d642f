"""A worker of a distributed system: fed by the broker, or asking the database when there is none."""

from __future__ import annotations

import signal
import threading
from collections.abc import Sequence
from functools import partial

from store.db import Database
from store.graph import load_graph
from store.json_log import logger
from store.opening import open_artifacts
from store.retry import retried_until
from store.settings import DeploymentSettings
from worker.keeper import LeaseKeeper
from worker.periodic import Periodic
from worker.polling import PollingRunners
from worker.queue import TaskQueue
from worker.service import WorkerService, unique_name
from worker.slots import Slots

_log = logger("bladeatlas.worker")


def run_worker(settings: DeploymentSettings, database: Database, queues: Sequence[str], workers: int) -> int:
    """Run tasks until SIGTERM or SIGINT; returns the exit code.

    Args:
        queues: of ``cpu`` and ``gpu``.
        workers: tasks side by side.
    """
    service = WorkerService(
        settings, database, open_artifacts(settings), load_graph(settings.graph), unique_name(), tuple(queues)
    )
    _log.info(
        "worker_started", name=service.name, queues=list(queues), workers=workers, broker=bool(settings.broker_url)
    )
    run = _fed_by_broker if settings.broker_url else _asking
    code = run(service, workers)
    _log.info("worker_stopped", name=service.name)
    return code


def _asking(service: WorkerService, workers: int) -> int:
    stopped = threading.Event()
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: stopped.set())
    runners = PollingRunners(service, workers)
    service.start()
    runners.start()
    stopped.wait()
    runners.stop()
    service.stop()
    return 0


def _fed_by_broker(service: WorkerService, workers: int) -> int:
    settings, plan = service.settings, service.plan
    queue = TaskQueue(settings.broker_url, settings.visibility_timeout_s)
    sender = Periodic("queue", partial(queue.top_up, plan), settings.sweep_s)
    service.on_end = sender.nudge
    runner = service.runner()
    keeper = LeaseKeeper(runner, settings.heartbeat_s)

    def run_next(queues: Sequence[str]) -> bool:
        lease = retried_until(runner.interrupted, plan.db, lambda: plan.lease(service.name, queues=queues))
        if lease is not None:
            runner.run(lease)
        return lease is not None

    slots = Slots(workers, run_next, runner.interrupted, quiet_s=settings.sweep_s)
    # A broker that stops delivering to this worker costs time, not the job.
    helpers = [
        Periodic("without_message", partial(slots.without_message, service.queues), settings.sweep_s)
        for _ in range(workers)
    ]

    def keep() -> None:
        try:
            keeper.run()
        except Exception:  # noqa: BLE001 - the border of a thread: logged, and what follows is said below
            # Without heartbeats every lease is lost: better no worker than one that works for nothing.
            _log.exception("heartbeat_failed")
            runner.interrupted.set()
            signal.raise_signal(signal.SIGTERM)

    thread = threading.Thread(target=keep, name="heartbeat", daemon=True)
    for part in (thread, service, sender):
        part.start()
    for helper in helpers:
        helper.start()
    try:
        return queue.work(slots.on_message, service.name, service.queues, workers, runner.interrupted.set)
    finally:
        runner.interrupted.set()
        for helper in helpers:
            helper.stop()
        sender.nudge()
        sender.stop()
        keeper.stopped.set()
        thread.join()
        service.stop()
