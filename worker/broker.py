"""All of Celery: a worker of a distributed system, fed by the broker, or asking the database when there is none.

A message says that a queue of the plan has work for one worker, and no more. The database is the truth. Whoever takes
a message leases whatever task is next in the plan, so a message that comes twice finds nothing or other work, and one
that was lost is replaced: `top_up` compares how many tasks could start with how many messages wait. Every waiting
message is taken after that, so no task is left out.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from celery import Celery, signals
from kombu import Connection, Exchange
from kombu import Queue as BrokerQueue

from core.states import Queue
from store.db import Database
from store.factory import open_artifacts
from store.graph import load_graph
from store.json_log import logger
from store.plan import Plan
from store.retry import retried_until
from store.settings import DeploymentSettings
from worker.loop import ConcurrencyLimit, PollingRunners, WorkerService, unique_name
from worker.periodic import Periodic
from worker.runner import Heartbeat

_TASK = "bladeatlas.run"
_CONNECT_S = 4.0
_log = logger("bladeatlas.worker")


class TaskQueue:
    """The broker as senders and workers see it."""

    def __init__(self, broker_url: str, visibility_timeout_s: float) -> None:
        self._app = Celery("bladeatlas", broker=broker_url, set_as_current=False)
        # The nameless exchange needs no bindings: a broker that lost its memory delivers at once again.
        self._queues = {
            name: BrokerQueue(f"bladeatlas.{name}", Exchange(""), routing_key=f"bladeatlas.{name}") for name in Queue
        }
        self._app.conf.update(
            broker_connection_retry_on_startup=True,
            broker_connection_max_retries=None,
            broker_connection_timeout=_CONNECT_S,
            broker_transport_options=_transport_options(broker_url, visibility_timeout_s),
            task_acks_late=True,
            task_create_missing_queues=False,
            task_default_queue=self._queues[Queue.CPU].name,
            task_ignore_result=True,
            task_queues=list(self._queues.values()),
            worker_enable_remote_control=False,
            worker_hijack_root_logger=False,
            worker_prefetch_multiplier=1,
            worker_redirect_stdouts=False,
        )

    def top_up(self, plan: Plan) -> int:
        """Send a message for every task that could start and has none; returns how many.

        Messages are counted before tasks: one that is taken in between has its task leased, or is one too many.
        """
        with self._app.connection_for_write() as connection:
            connection.ensure_connection(max_retries=1, timeout=_CONNECT_S)
            waiting = {name: self._waiting(connection, queue) for name, queue in self._queues.items()}
            missing = {name: count - waiting[name] for name, count in plan.runnable().items() if name in waiting}
            for name, count in missing.items():
                for _ in range(count):
                    self._app.send_task(
                        _TASK, args=(name,), queue=self._queues[name], connection=connection, retry=False
                    )
        return sum(max(0, count) for count in missing.values())

    def work(
        self,
        run: Callable[[str], object],
        name: str,
        queues: Sequence[str],
        workers: int,
        on_stop: Callable[[], None],
    ) -> int:
        """Take messages until the process is told to stop; returns its exit code.

        Args:
            run: called with the queue's name, in one of `workers` threads.
            name: of this worker, for the broker.
            on_stop: called when SIGTERM or SIGINT came: what runs should come to an end now.
        """
        self._app.task(run, name=_TASK)
        # Celery leaves the logs alone when somebody listens to this.
        signals.setup_logging.connect(_leave_logging, weak=False)
        signals.worker_shutting_down.connect(lambda **_: on_stop(), weak=False)
        worker = self._app.Worker(
            # Threads: they only wait for child processes, and a signal reaches the main thread at once.
            pool="threads",
            concurrency=workers,
            queues=[self._queues[Queue(name)].name for name in queues],
            hostname=name,
            quiet=True,
            without_gossip=True,
            without_heartbeat=True,
            without_mingle=True,
        )
        worker.start()
        return int(worker.exitcode or 0)

    @staticmethod
    def _waiting(connection: Connection, queue: BrokerQueue) -> int:
        """Messages that nobody has taken yet; makes the queue when there is none."""
        with connection.channel() as channel:
            return int(queue(channel).queue_declare().message_count)


def _leave_logging(**_more: object) -> None:
    """Logs are set up already."""


def _transport_options(broker_url: str, visibility_timeout_s: float) -> dict[str, Any]:
    if not broker_url.startswith("redis"):
        return {}
    return {
        "visibility_timeout": visibility_timeout_s,
        # Look for messages past it at every turn of ten seconds; by default Kombu does at every tenth turn only.
        "unacked_restore_throttle": 1,
        "socket_connect_timeout": _CONNECT_S,
        "socket_keepalive": True,
    }


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
    heartbeat = Heartbeat(runner, settings.heartbeat_s)

    def run_next(queues: Sequence[str]) -> bool:
        lease = retried_until(runner.interrupted, plan.db, lambda: plan.lease(service.name, queues=queues))
        if lease is not None:
            runner.run(lease)
        return lease is not None

    limit = ConcurrencyLimit(workers, run_next, runner.interrupted, quiet_s=settings.sweep_s)
    # A broker that stops delivering to this worker costs time, not the job.
    helpers = [
        Periodic("without_message", partial(limit.without_message, service.queues), settings.sweep_s)
        for _ in range(workers)
    ]

    def keep() -> None:
        try:
            heartbeat.run()
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
        return queue.work(limit.on_message, service.name, service.queues, workers, runner.interrupted.set)
    finally:
        runner.interrupted.set()
        for helper in helpers:
            helper.stop()
        sender.nudge()
        sender.stop()
        heartbeat.stopped.set()
        thread.join()
        service.stop()
